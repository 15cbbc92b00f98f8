// Svg: the elements that drawings are made of, as text; what they say is escaped here.
#pragma once

#include <string>
#include <string_view>

namespace snug::report::internal {

/// `style`: attributes as written, such as class="rule". Places in units of the drawing, y downwards.
[[nodiscard]] std::string svg_line(double x1, double y1, double x2, double y2, std::string_view style);
[[nodiscard]] std::string svg_rect(double x, double y, double width, double height, std::string_view style);
/// `anchor`: start, middle or end; `more`: further attributes, beginning with a space, or empty.
[[nodiscard]] std::string svg_text(double x, double y, std::string_view text, std::string_view anchor,
                                   std::string_view more = "");
/// `about`: shown under the mouse.
[[nodiscard]] std::string svg_dot(double x, double y, double radius, std::string_view style, std::string_view about);
/// A drawing within a page: as wide as said or as there is room. `about`: for those who do not see it.
[[nodiscard]] std::string svg_drawing(double width, double height, std::string_view about, std::string_view content);

}  // namespace snug::report::internal
