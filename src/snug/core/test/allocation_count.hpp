// allocation_count: how often this program has asked for memory, for tests that forbid it.
#pragma once

namespace snug::test {

[[nodiscard]] long allocation_count();

}  // namespace snug::test
