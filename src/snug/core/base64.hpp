// base64: any bytes as text.
#pragma once

#include <string>
#include <string_view>

namespace snug {

/// RFC 4648, with padding, on one line.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace snug
