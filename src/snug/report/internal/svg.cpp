// Svg: the elements that drawings are made of, as text; what they say is escaped here.
#include "snug/report/internal/svg.hpp"

#include <fmt/format.h>

#include "snug/report/escape.hpp"

namespace snug::report::internal {

std::string svg_line(double x1, double y1, double x2, double y2, std::string_view style) {
  return fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" {}/>\n", x1, y1, x2, y2, style);
}

std::string svg_rect(double x, double y, double width, double height, std::string_view style) {
  return fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" {}/>\n", x, y, width, height,
                     style);
}

std::string svg_text(double x, double y, std::string_view text, std::string_view anchor, std::string_view more) {
  return fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escape(text));
}

std::string svg_dot(double x, double y, double radius, std::string_view style, std::string_view about) {
  return fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:g}\" {}><title>{}</title></circle>\n", x, y, radius,
                     style, escape(about));
}

std::string svg_drawing(double width, double height, std::string_view about, std::string_view content) {
  return fmt::format(
      "<svg width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" role=\"img\" aria-label=\"{2}\">\n"
      "{3}</svg>",
      width, height, escape(about), content);
}

}  // namespace snug::report::internal
