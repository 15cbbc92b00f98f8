// Catalogue: containers, pallets and cups by name, to begin a cell with.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/cup/estimate.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::workspace {

/// A container or pallet of the trade.
struct CatalogueContainer {
  std::string_view name;
  std::string_view source;  ///< where its numbers come from
  bool is_pallet = false;
  double length = 0.0, width = 0.0, height = 0.0;  ///< m, inside; of a pallet height 0: as high as one loads it
};
[[nodiscard]] const std::vector<CatalogueContainer>& container_catalogue();

/// JSON: `containers` and `cups`, as docs/ui-interface.md says.
[[nodiscard]] std::string format_catalogue();

/// The cup of the catalogue that has this key ("40-1.5-foam"). Throws InputError for others.
[[nodiscard]] cup::CupSheet find_cup(const std::string& key);
/// A data sheet in the words that people choose from. Throws InputError for a material or lip that is none.
[[nodiscard]] cup::CupSheet read_cup_sheet(double diameter_mm, double bellows, const std::string& material,
                                           const std::string& lip, double vacuum_kPa, std::optional<double> stroke_mm);
/// `snug cup estimate` of this sheet.
[[nodiscard]] std::string cup_command(const cup::CupSheet& sheet);
/// The cell's text with the cup of this sheet, as `snug cup estimate` has it. Throws InputError for numbers that no cup
/// has.
[[nodiscard]] std::string put_cup(const std::string& text, const std::string& name, const cup::CupSheet& sheet);

}  // namespace snug::workspace
