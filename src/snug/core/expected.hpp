// Expected: a value or the reason why there is none.
#pragma once

#include <tl/expected.hpp>

namespace snug {

template <class T, class Reason>
using Expected = tl::expected<T, Reason>;

template <class Reason>
using Unexpected = tl::unexpected<Reason>;

}  // namespace snug
