// Escape: text from outside as the inside of an element or of an attribute of HTML, XML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace snug::report {

/// The one function through which text gets into a page. Safe in an element and in an attribute value in single or
/// double quotes: & < > " ' become references. What would be drawn in another order than it is written, or not at all
/// (controls, marks of direction, bytes that are not UTF-8), is shown as \x1b, \u202e, like in messages
/// (snug::printable). Line breaks stay, tabs and carriage returns become spaces: XML 1.0 and HTML take every character
/// of the result.
[[nodiscard]] std::string escape(std::string_view text);

/// A path, relative or absolute, as a URL: bytes other than letters, digits and / . - _ as %XX. Never has a scheme: a
/// path such as "javascript:x" stays one.
[[nodiscard]] std::string url_of_path(std::string_view path);

}  // namespace snug::report
