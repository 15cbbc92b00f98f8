// Representatives: a few boxes that stand for many real ones, and sequences of them: report sections 3.1.1, 3.1.2.
#include "snug/packing/representatives.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "snug/core/input_error.hpp"

namespace snug::packing {
namespace {

constexpr int kRounds = 10;

/// Equal boxes of all orders together.
struct Kind {
  Vector3 size;  ///< longest edge first
  double mass;
  int boxes;
};

Vector3 sorted(Vector3 size) {
  std::sort(size.data(), size.data() + 3, std::greater<>());
  return size;
}

std::vector<Kind> kinds_of(const std::vector<model::OrderLine>& lines) {
  std::map<std::tuple<double, double, double, double>, int> counts;
  for (const model::OrderLine& line : lines) {
    const Vector3 size = sorted(line.size);
    counts[{size[0], size[1], size[2], line.mass}] += line.count;
  }
  std::vector<Kind> kinds;
  for (const auto& [key, boxes] : counts) {
    kinds.push_back({{std::get<0>(key), std::get<1>(key), std::get<2>(key)}, std::get<3>(key), boxes});
  }
  std::stable_sort(kinds.begin(), kinds.end(), [](const Kind& a, const Kind& b) { return a.boxes > b.boxes; });
  return kinds;
}

/// Largest difference of an edge as a share of the representative's.
double size_difference(const Vector3& size, const Vector3& representative) {
  return ((size - representative).cwiseAbs().cwiseQuotient(representative)).maxCoeff();
}

double difference(const Kind& kind, const Representative& group) {
  return std::max(size_difference(kind.size, group.size), std::abs(kind.mass - group.mass) / group.mass);
}

/// Each kind joins the nearest group within the tolerance; one that has none begins a group.
std::vector<Representative> group(const std::vector<Kind>& kinds, double tolerance,
                                  std::vector<Representative> centres) {
  std::vector<Representative> sums(centres.size());
  for (const Kind& kind : kinds) {
    std::size_t nearest = centres.size();
    double least = tolerance;
    for (std::size_t g = 0; g < centres.size(); ++g) {
      const double d = difference(kind, centres[g]);
      if (d <= least && (nearest == centres.size() || d < least)) {
        nearest = g;
        least = d;
      }
    }
    if (nearest == centres.size()) {
      centres.push_back({kind.size, kind.mass, 0});
      sums.emplace_back();
    }
    sums[nearest].size += kind.boxes * kind.size;
    sums[nearest].mass += kind.boxes * kind.mass;
    sums[nearest].boxes += kind.boxes;
  }
  std::vector<Representative> groups;
  for (const Representative& sum : sums) {
    if (sum.boxes > 0) groups.push_back({sum.size / sum.boxes, sum.mass / sum.boxes, sum.boxes});
  }
  return groups;
}

}  // namespace

Reduction reduce_items(const std::vector<model::OrderLine>& lines, const ReductionSettings& settings) {
  require_number(settings.count >= 1 && settings.count <= 10000, "settings", "count", settings.count, "1 .. 10000");
  require_number(settings.group_tolerance >= 0.0 && settings.group_tolerance < 1.0, "settings", "group tolerance",
                 settings.group_tolerance, "0 .. 1");
  require_number(settings.cover_tolerance >= 0.0 && settings.cover_tolerance < 1.0, "settings", "cover tolerance",
                 settings.cover_tolerance, "0 .. 1");
  const std::vector<Kind> kinds = kinds_of(lines);
  std::vector<Representative> groups;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Representative> next = group(kinds, settings.group_tolerance, groups);
    if (next == groups) break;
    groups = std::move(next);
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Representative& a, const Representative& b) { return a.boxes > b.boxes; });
  Reduction reduction;
  reduction.groups = static_cast<int>(groups.size());
  groups.resize(std::min(groups.size(), static_cast<std::size_t>(settings.count)));
  reduction.representatives = groups;
  int covered = 0;
  for (const Kind& kind : kinds) {
    reduction.boxes += kind.boxes;
    const bool is_covered = std::any_of(groups.begin(), groups.end(), [&](const Representative& representative) {
      return size_difference(kind.size, representative.size) <= settings.cover_tolerance;
    });
    if (is_covered) covered += kind.boxes;
  }
  if (reduction.boxes > 0) reduction.covered_percent = 100.0 * covered / reduction.boxes;
  return reduction;
}

model::Sequence draw_sequence(const model::Scenario& scenario, const std::string& name,
                              const SequenceSettings& settings, Rng rng) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) {
    throw InputError(scenario.source_name, "target", "nothing", "a container that is to be filled");
  }
  require_number(settings.fill_percent > 0.0 && settings.fill_percent <= 1000.0, "settings", "fill",
                 settings.fill_percent, "above 0, at most 1000 percent");
  require_number(settings.repeat >= 0.0 && settings.repeat <= 1.0, "settings", "repeat", settings.repeat,
                 "a probability");
  std::vector<const model::Parcel*> left;
  for (const model::Parcel& parcel : scenario.parcels) left.push_back(&parcel);
  model::Sequence sequence;
  sequence.name = name;
  double volume = 0.0;
  std::string last;
  while (settings.all ? !left.empty() : volume < 0.01 * settings.fill_percent * container->inner_size.prod()) {
    if (left.empty()) {
      throw InputError(scenario.source_name, "fill", std::to_string(settings.fill_percent) + " percent",
                       "at most what all boxes together fill, " +
                           std::to_string(100.0 * volume / container->inner_size.prod()) + " percent");
    }
    std::vector<std::size_t> likely;
    const bool repeats = rng.uniform() < settings.repeat;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (repeats && left[i]->type == last) likely.push_back(i);
    }
    const std::size_t chosen = likely.empty()
                                   ? static_cast<std::size_t>(rng.index(static_cast<int>(left.size())))
                                   : likely[static_cast<std::size_t>(rng.index(static_cast<int>(likely.size())))];
    model::Item item;
    item.parcel = left[chosen]->id;
    if (settings.any_side_up && !left[chosen]->handling.upright_only)
      item.up = static_cast<model::UpAxis>(rng.index(3));
    last = left[chosen]->type;
    volume += left[chosen]->size.prod();
    sequence.items.push_back(item);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
  return sequence;
}

model::Sequence draw_order(const model::Scenario& scenario, const std::string& name, std::uint64_t seed) {
  if (model::find_sequence(scenario, name) != nullptr) {
    throw InputError("command line", "random order", "a scenario with a sequence " + name, "a name of its own");
  }
  SequenceSettings settings;
  settings.repeat = 0.0;
  settings.all = true;
  return draw_sequence(scenario, name, settings, Rng(seed).split("sequence " + name));
}

}  // namespace snug::packing
