// Representatives and drawn sequences as text: blocks of a scenario (YAML), JSON, a table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/packing/representatives.hpp"

namespace snug::packing {

/// `parcel_types` of a scenario.
[[nodiscard]] std::string format_yaml(const Reduction& reduction);
[[nodiscard]] std::string format_json(const Reduction& reduction);
/// `cover_percent`: within which a box has a representative.
[[nodiscard]] std::string format_table(const Reduction& reduction, double cover_percent);

/// The scenario with boxes of the parcel types of a file in the place of its own: enough of each to fill so much of the
/// container alone. Throws InputError for a file without types, and a scenario without a container.
[[nodiscard]] model::Scenario with_boxes_of_types(const model::Scenario& scenario, const std::filesystem::path& types,
                                                  double fill_percent);
/// `parcel_types` and those `parcels` that the sequences take, of this material.
[[nodiscard]] std::string format_boxes_yaml(const model::Scenario& drawn_from,
                                            const std::vector<model::Sequence>& sequences, const std::string& material);
/// `sequences` of a scenario.
[[nodiscard]] std::string format_sequences_yaml(const std::vector<model::Sequence>& sequences);

}  // namespace snug::packing
