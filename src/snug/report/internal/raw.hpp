// Raw: the way past the escaping, for the writers of this module alone.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "snug/report/markup.hpp"

namespace snug::report::internal {

class Raw {
 public:
  /// `html` must be whole and well-formed, with all text in it escaped.
  [[nodiscard]] static Markup of(std::string html) {
    Markup markup;
    markup.html_ = std::move(html);
    return markup;
  }
};

/// <tag attributes>content</tag>; `attributes`: as written, or empty.
[[nodiscard]] inline Markup element(std::string_view tag, std::string_view attributes, const Markup& content) {
  std::string html = "<";
  html += tag;
  if (!attributes.empty()) (html += ' ') += attributes;
  ((((html += '>') += content.html()) += "</") += tag) += '>';
  return Raw::of(std::move(html));
}

}  // namespace snug::report::internal
