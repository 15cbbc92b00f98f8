// Loading: a container filled from a list of boxes known in advance: what fits at best, by geometry alone.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace snug::packing {

/// Equal boxes. Lengths are whole numbers in any unit (mm, cm), the same for all and for the container.
struct CargoType {
  std::string name;
  std::array<int, 3> size{};                              ///< edges
  std::array<bool, 3> may_be_vertical{true, true, true};  ///< which edges may stand upright
  int count = 0;
  bool operator==(const CargoType&) const = default;
};

/// A container and what there is to be loaded into it.
struct LoadProblem {
  std::string name;
  std::array<int, 3> container{};  ///< inner length, width, height (vertical)
  std::vector<CargoType> types;
  bool operator==(const LoadProblem&) const = default;
};

struct LoadSettings {
  double time = 30.0;  ///< s on one core of the reference machine (2.5 GHz): turned into work, so results repeat
  int threads = 1;     ///< results do not depend on it
};

/// One loaded box, edges along the container's; `low` is its corner nearest to the container's origin corner.
struct LoadedBox {
  int type = 0;  ///< index into LoadProblem::types
  std::array<int, 3> low{};
  std::array<int, 3> size{};  ///< as it stands
  bool operator==(const LoadedBox&) const = default;
};

struct LoadResult {
  std::vector<LoadedBox> boxes;
  double percent = 0.0;   ///< of the container's volume
  std::int64_t work = 0;  ///< blocks looked at
  int beam_width = 0;     ///< of the last search that was finished
  bool operator==(const LoadResult&) const = default;
};

/// Beam search over blocks of boxes put into corners of maximal free spaces; every partial load is judged by the load
/// that a greedy completion makes of it (docs/theory/packing.md, loading). No support is asked for: boxes may hang
/// over. Throws InputError for lengths that are not positive or beyond 1e5, a count beyond 0 .. 5000, more than 1000
/// types.
[[nodiscard]] LoadResult load_container(const LoadProblem& problem, const LoadSettings& settings);

/// Problems of a list that a box violates: outside, overlap, more than there are, an edge upright that must not be.
/// Empty: the load is right.
[[nodiscard]] std::vector<std::string> check_load(const LoadProblem& problem, const LoadResult& result);

}  // namespace snug::packing
