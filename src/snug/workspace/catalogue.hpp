// Catalogue: containers, pallets and cups by name, to begin a cell with.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

/// JSON: `containers` and `cups`, as docs/ui.md says.
[[nodiscard]] std::string format_catalogue();

/// The cell's text with the cup of the catalogue that has this key ("40-1.5-foam"), as `snug cup estimate` has it.
/// Throws InputError for others.
[[nodiscard]] std::string put_cup(const std::string& text, const std::string& name, const std::string& cup);

}  // namespace snug::workspace
