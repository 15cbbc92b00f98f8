// Instances: problems of loading a container, read from the public text form and from orders.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "snug/model/items_file.hpp"
#include "snug/packing/loading.hpp"

namespace snug::packing {

/// Reads the text form of the OR-Library's thpack files (Bischoff and Ratcliff 1995): the number of problems; for each
/// its number and seed, the container's edges, the number of box types, and for each type its number, three times edge
/// and whether it may stand upright (0, 1), and how many there are. Throws InputError with file and line.
[[nodiscard]] std::vector<LoadProblem> load_instances(const std::filesystem::path& path);
[[nodiscard]] std::vector<LoadProblem> parse_instances(std::string_view text, const std::string& name);

/// One problem for each order, in whole millimetres (boxes rounded up, the container down): equal boxes become one
/// type. `container` in m. Throws InputError for boxes with limits of load, which loading does not look at.
[[nodiscard]] std::vector<LoadProblem> problems_of(const std::vector<model::OrderLine>& lines,
                                                   const Vector3& container);

/// Takes the limits of load out of orders; how many boxes had some.
int drop_load_limits(std::vector<model::OrderLine>& lines);

}  // namespace snug::packing
