// Estimated cups as text, and the words of data sheets.
#pragma once

#include <string>

#include "snug/cup/estimate.hpp"

namespace snug::cup {

/// "-60kPa" in Pa; kPa, mbar, bar or Pa. Throws InputError with `option` for anything else.
[[nodiscard]] double parse_gauge_pressure(const std::string& text, const std::string& option);
/// Of the name that name_of() has for it (checked).
[[nodiscard]] CupMaterial cup_material_of(const std::string& name);

[[nodiscard]] std::string format_json(const CupEstimate& estimate);
/// Of cup_catalogue(): a line for each cup, or a list.
[[nodiscard]] std::string format_catalogue_table();
[[nodiscard]] std::string format_catalogue_json();

}  // namespace snug::cup
