// Escape: text from outside as the inside of an element or of an attribute of HTML, XML and SVG.
#include "snug/report/escape.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "snug/core/text.hpp"

namespace snug::report {
namespace {

void append_markup(std::string_view shown, std::string& out) {
  for (const char c : shown) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
}

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t end = std::min(text.size(), text.find_first_of("\n\t\r"));
    const std::string_view part = text.substr(0, end);
    if (is_printable(part)) {
      append_markup(part, out);
    } else {
      append_markup(printable(part, part.size()), out);
    }
    if (end == text.size()) break;
    out += text[end] == '\n' ? '\n' : ' ';
    text.remove_prefix(end + 1);
  }
  return out;
}

std::string url_of_path(std::string_view path) {
  std::string url;
  for (const char c : path) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          std::string_view("/.-_").find(c) != std::string_view::npos;
    url += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

}  // namespace snug::report
