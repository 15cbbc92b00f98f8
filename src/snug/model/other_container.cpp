// Another container: a scenario whose target is another of its containers, a box of other sizes, or a pallet.
#include "snug/model/other_container.hpp"

#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/model/internal/overlap.hpp"
#include "snug/model/internal/scenario_text.hpp"
#include "snug/model/internal/value.hpp"

namespace snug::model {
namespace {

constexpr double kLeastEdge = 0.010, kLargestEdge = 10.0;  ///< m, beyond them a size is taken for a slip
constexpr double kTouching = 1e-6;                         ///< m, less is no overlap
constexpr double kOver = 2.0;                              ///< m above a container that have to be free

[[noreturn]] void refuse(const char* option, const std::string& words, const std::string& why,
                         const std::string& expected) {
  throw InputError("command line", option, "'" + words + "'" + (why.empty() ? "" : ": " + why), expected);
}

/// "400x300x200" in mm as numbers in m; nothing when it is something else.
std::optional<std::vector<double>> parse_sizes(const std::string& words) {
  std::vector<double> sizes;
  const char* at = words.data();
  const char* const end = at + words.size();
  while (true) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{}) return std::nullopt;
    sizes.push_back(kMillimetre * value);
    if (next == end) return sizes;
    if (*next != 'x' && *next != 'X') return std::nullopt;
    at = next + 1;
  }
}

Container target_of(const Scenario& scenario, const char* option, const std::string& words) {
  const Container* target = find_container(scenario, scenario.target);
  if (target == nullptr)
    refuse(option, words, "no container in " + scenario.source_name, "a scenario with a container");
  return *target;
}

struct Solid {
  std::string name;
  std::vector<PlacedShape> shapes;
  Pose X_WB;
};

std::vector<Solid> fixed_solids(const Scenario& scenario) {
  std::vector<Solid> solids;
  for (const Container& container : scenario.containers)
    solids.push_back({container.name, make_walls(container), container.X_WT});
  for (const Body& body : scenario.bodies)
    if (body.kind == BodyKind::Static) solids.push_back({body.name, body.shapes, body.X_WB});
  if (scenario.aligner) solids.push_back({"aligner", scenario.aligner->plates, scenario.aligner->X_WA});
  return solids;
}

/// Name of something that a container, or the space in and over it, would be inside of; empty when it is free.
std::string obstacle_of(const Scenario& scenario, const Container& container) {
  std::vector<PlacedShape> needed = make_walls(container);
  Vector3 free = container.inner_size;
  free.z() += kOver;
  needed.push_back({geometry::Box{0.5 * free}, Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.5 * free.z())}});
  for (const Solid& solid : fixed_solids(scenario)) {
    if (solid.name == container.name) continue;
    for (const PlacedShape& shape : solid.shapes)
      for (const PlacedShape& mine : needed)
        if (internal::overlap_of(shape, solid.X_WB, mine, container.X_WT) > kTouching) return solid.name;
  }
  return {};
}

std::string names_of_containers(const Scenario& scenario) {
  std::string names;
  for (const Container& container : scenario.containers) names += (names.empty() ? "" : ", ") + container.name;
  return names;
}

/// Parses the changed text: what is written down is what runs.
Scenario with_target(const Scenario& scenario, const Container& target, const std::string& why) {
  Scenario changed =
      parse_scenario(internal::text_with_target(scenario.source_text, target, why), scenario.source_name);
  changed.name = scenario.name;
  return changed;
}

Scenario with_sizes(const Scenario& scenario, Container target, std::vector<double> sizes, const char* option,
                    const std::string& words) {
  for (const double size : sizes)
    if (!(size >= kLeastEdge && size <= kLargestEdge)) refuse(option, words, "", "lengths from 10 to 10000 mm");
  const bool is_long_along_x = target.inner_size.x() > target.inner_size.y();
  if (is_long_along_x != (sizes[0] > sizes[1])) std::swap(sizes[0], sizes[1]);
  target.inner_size = Vector3(sizes[0], sizes[1], sizes[2]);
  target.holds_all = false;
  if (const std::string obstacle = obstacle_of(scenario, target); !obstacle.empty())
    refuse(option, words, "'" + obstacle + "' is in its way, or over it",
           "sizes for which there is room where '" + target.name + "' stands");
  return with_target(scenario, target, std::string(option) + " " + words);
}

}  // namespace

Scenario with_container(const Scenario& scenario, const std::string& words) {
  constexpr const char* kOption = "--container";
  Container target = target_of(scenario, kOption, words);
  if (const Container* other = find_container(scenario, words)) {
    if (other->name == scenario.target) return scenario;
    target = *other;
    target.holds_all = false;
    return with_target(scenario, target, std::string(kOption) + " " + words);
  }
  const auto sizes = parse_sizes(words);
  if (!sizes || sizes->size() != 3)
    refuse(kOption, words, "", "LxWxH in mm, or one of " + names_of_containers(scenario));
  target.has_walls = true;
  return with_sizes(scenario, target, *sizes, kOption, words);
}

Scenario with_pallet(const Scenario& scenario, const std::string& words) {
  constexpr const char* kOption = "--pallet";
  Container target = target_of(scenario, kOption, words);
  auto sizes = parse_sizes(words);
  if (!sizes || sizes->size() < 2 || sizes->size() > 3) refuse(kOption, words, "", "LxW or LxWxH in mm");
  if (sizes->size() == 2) sizes->push_back(target.inner_size.z());
  target.has_walls = false;
  return with_sizes(scenario, target, *sizes, kOption, words);
}

}  // namespace snug::model
