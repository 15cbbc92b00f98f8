// Markup: a piece of a page. Text becomes markup by being escaped, in no other way: no name can break out of a page.
#include "snug/report/markup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/core/base64.hpp"
#include "snug/report/escape.hpp"
#include "snug/report/internal/raw.hpp"

namespace snug::report {

using internal::element;
using internal::Raw;

Markup Markup::escaped(std::string_view text) { return Raw::of(escape(text)); }

Markup& Markup::operator+=(const Markup& other) {
  html_ += other.html_;
  return *this;
}

Markup heading(int level, const Markup& content) {
  return element(fmt::format("h{}", std::clamp(level, 1, 4)), "", content) + Raw::of("\n");
}
Markup paragraph(const Markup& content) { return element("p", "", content) + Raw::of("\n"); }
Markup bold(const Markup& content) { return element("b", "", content); }
Markup small(const Markup& content) { return element("small", "", content); }
Markup code(std::string_view text) { return element("code", "", text); }
Markup preformatted(std::string_view text) { return element("pre", "", text) + Raw::of("\n"); }
Markup line_break() { return Raw::of("<br>"); }
Markup link(std::string_view path, const Markup& content) {
  return element("a", "href=\"" + url_of_path(path) + "\"", content);
}
Markup details(const Markup& summary, const Markup& content) {
  return element("details", "", element("summary", "", summary) + content);
}
Markup section(const Markup& content) { return element("section", "", content) + Raw::of("\n"); }
Markup figure(const Markup& caption, const Markup& drawing) {
  return element("figure", "", element("figcaption", "", caption) + drawing) + Raw::of("\n");
}
Markup picture(std::string_view alternative, const std::string& svg) {
  return Raw::of(
      fmt::format("<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">", escape(alternative), base64(svg)));
}

Markup side_by_side(const std::vector<Markup>& parts) {
  Markup all;
  for (const Markup& part : parts) all += part;
  return element("div", "class=\"beside\"", all) + Raw::of("\n");
}

Markup cards(const std::vector<Markup>& parts) {
  Markup all;
  for (const Markup& part : parts) all += element("div", "class=\"card\"", part);
  return element("div", "class=\"beside\"", all) + Raw::of("\n");
}

Markup not_available() { return Raw::of("<span class=\"na\">n.a.</span>"); }

Markup number(double value, int decimals) {
  return std::isfinite(value) ? Markup(fmt::format("{:.{}f}", value, decimals)) : not_available();
}

Markup number(double value, double deviation, int decimals) {
  Markup text = number(value, decimals);
  if (std::isfinite(deviation)) text += " " + small(fmt::format("\u00b1 {:.{}f}", deviation, decimals));
  return text;
}

Markup key_figures(const std::vector<KeyFigure>& figures) {
  Markup all;
  for (const KeyFigure& one : figures) {
    Markup value = bold(one.value);
    if (!one.note.empty()) value += small(one.note);
    all += element("div", "", element("dt", "", one.label) + element("dd", "", value));
  }
  return element("dl", "class=\"keys\"", all) + Raw::of("\n");
}

}  // namespace snug::report
