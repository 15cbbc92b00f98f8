// Representatives and drawn sequences as text: blocks of a scenario (YAML), JSON, a table.
#include "snug/packing/item_text.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "snug/core/input_error.hpp"

namespace snug::packing {
namespace {

/// YAML takes any text between double quotes that is JSON.
std::string in_quotes(const std::string& text) { return nlohmann::json(text).dump(); }

}  // namespace

std::string format_yaml(const Reduction& reduction) {
  std::string text = "parcel_types:\n";
  for (std::size_t i = 0; i < reduction.representatives.size(); ++i) {
    const Representative& r = reduction.representatives[i];
    text += fmt::format("  - {{name: R{}, size: [{:.4f}, {:.4f}, {:.4f}], mass: {:.3f}}}  # stands for {} boxes\n",
                        i + 1, r.size.x(), r.size.y(), r.size.z(), r.mass, r.boxes);
  }
  return text;
}

std::string format_json(const Reduction& reduction) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Representative& r : reduction.representatives) {
    all.push_back({{"size", {r.size.x(), r.size.y(), r.size.z()}}, {"mass", r.mass}, {"boxes", r.boxes}});
  }
  const nlohmann::ordered_json json{{"representatives", all},
                                    {"groups", reduction.groups},
                                    {"boxes", reduction.boxes},
                                    {"covered_percent", reduction.covered_percent}};
  return json.dump(1) + "\n";
}

std::string format_table(const Reduction& reduction, double cover_percent) {
  std::string text = fmt::sprintf("%-4s %26s %9s %7s %8s\n", "", "size mm", "mass kg", "boxes", "boxes %");
  for (std::size_t i = 0; i < reduction.representatives.size(); ++i) {
    const Representative& r = reduction.representatives[i];
    text += fmt::sprintf("R%-3zu %8.1f %8.1f %8.1f %9.3f %7d %8.1f\n", i + 1, 1e3 * r.size.x(), 1e3 * r.size.y(),
                         1e3 * r.size.z(), r.mass, r.boxes, 100.0 * r.boxes / reduction.boxes);
  }
  return text + fmt::sprintf("%d boxes in %d groups; %.1f %% are within %g %% of a representative's size\n",
                             reduction.boxes, reduction.groups, reduction.covered_percent, cover_percent);
}

model::Scenario with_boxes_of_types(const model::Scenario& scenario, const std::filesystem::path& types,
                                    double fill_percent) {
  model::Scenario changed = scenario;
  changed.parcel_types.clear();
  model::add_items(changed, types);
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr || changed.parcel_types.empty()) {
    throw InputError(types.string(), "parcel_types", "nothing", "types, and a scenario with a container to fill");
  }
  std::vector<model::OrderLine> lines;
  for (const model::ParcelType& type : changed.parcel_types) {
    model::OrderLine line;
    line.order = "new";
    line.article = type.name;
    line.size = type.size;
    line.mass = type.mass;
    line.count = static_cast<int>(
        std::min(5000.0, std::ceil(0.01 * fill_percent * container->inner_size.prod() / type.size.prod())));
    lines.push_back(line);
  }
  changed.sequences.clear();
  changed.source_text.clear();  // nobody reads it
  const std::size_t before = changed.parcels.size();
  model::add_orders(changed, lines, types);
  changed.parcels.erase(changed.parcels.begin(), changed.parcels.begin() + static_cast<std::ptrdiff_t>(before));
  return changed;
}

std::string format_boxes_yaml(const model::Scenario& drawn_from, const std::vector<model::Sequence>& sequences,
                              const std::string& material) {
  std::set<std::string> used;
  for (const model::Sequence& sequence : sequences) {
    for (const model::Item& item : sequence.items) used.insert(item.parcel);
  }
  std::string text = "parcel_types:\n";
  for (const model::ParcelType& type : drawn_from.parcel_types) {
    text += fmt::format("  - {{name: {}, size: [{}, {}, {}], mass: {}}}\n", in_quotes(type.name), type.size.x(),
                        type.size.y(), type.size.z(), type.mass);
  }
  text += "parcels:\n";
  for (const model::Parcel& parcel : drawn_from.parcels) {
    if (used.count(parcel.id) == 0) continue;
    text +=
        fmt::format("  - {{id: {}, type: {}, material: {}}}\n", parcel.id, in_quotes(parcel.type), in_quotes(material));
  }
  return text;
}

std::string format_sequences_yaml(const std::vector<model::Sequence>& sequences) {
  std::string text = "sequences:\n";
  for (const model::Sequence& sequence : sequences) {
    text += "  - name: " + in_quotes(sequence.name) + "\n    items:\n";
    for (const model::Item& item : sequence.items) {
      text += fmt::format("      - {{parcel: {}, up: {}}}\n", in_quotes(item.parcel), "XYZ"[static_cast<int>(item.up)]);
    }
  }
  return text;
}

}  // namespace snug::packing
