// Page: the frame that all pages made here have: one HTML file without scripts and without anything to load.
#pragma once

#include <string>

#include "snug/report/markup.hpp"

namespace snug::report {

/// The same inks as the page of viewer/ (src/ui/style.css): light or dark as the reader's system is, readable on a
/// phone of 390 px, printable.
[[nodiscard]] std::string make_page(std::string_view title, const Markup& content);

}  // namespace snug::report
