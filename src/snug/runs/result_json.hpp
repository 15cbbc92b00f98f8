// Results as JSON: what `snug simulate --json` prints, what recordings keep and what pages read: written and read by
// one list of keys (docs/formats.md, Result).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "snug/runs/result.hpp"

namespace snug::runs {

[[nodiscard]] std::string format_result(const RunResult& result);
/// What format_result has written, also in another version: keys that are not there leave what a RunResult begins with.
/// Nothing for any other text, for more than 4 MB and for what nests deeper than a result does.
[[nodiscard]] std::optional<RunResult> read_result(std::string_view text);

/// The same keys as types of TypeScript: viewer/src/replay/result.ts.
[[nodiscard]] std::string format_result_types();

}  // namespace snug::runs
