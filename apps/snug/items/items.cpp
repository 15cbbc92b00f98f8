// items: reads orders or a scenario, prints representatives or sequences.
#include "apps/snug/items/items.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/model/items_file.hpp"
#include "snug/packing/representatives.hpp"

namespace snug::app {
namespace {

void print_or_write(const std::string& text, std::optional<OutputFile> output) {
  if (output) {
    write_file(std::move(*output), text);
  } else {
    print(text);
  }
}

std::string as_yaml(const packing::Reduction& reduction) {
  std::string text = "parcel_types:\n";
  for (std::size_t i = 0; i < reduction.representatives.size(); ++i) {
    const packing::Representative& r = reduction.representatives[i];
    text += fmt::format("  - {{name: R{}, size: [{:.4f}, {:.4f}, {:.4f}], mass: {:.3f}}}  # stands for {} boxes\n",
                        i + 1, r.size.x(), r.size.y(), r.size.z(), r.mass, r.boxes);
  }
  return text;
}

std::string as_json(const packing::Reduction& reduction) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const packing::Representative& r : reduction.representatives) {
    all.push_back({{"size", {r.size.x(), r.size.y(), r.size.z()}}, {"mass", r.mass}, {"boxes", r.boxes}});
  }
  const nlohmann::ordered_json json{{"representatives", all},
                                    {"groups", reduction.groups},
                                    {"boxes", reduction.boxes},
                                    {"covered_percent", reduction.covered_percent}};
  return json.dump(1) + "\n";
}

/// YAML takes any text between double quotes that is JSON.
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); }

std::string as_yaml(const model::Sequence& sequence) {
  std::string text = "  - name: " + quoted(sequence.name) + "\n    items:\n";
  for (const model::Item& item : sequence.items) {
    text += fmt::format("      - {{parcel: {}, up: {}}}\n", quoted(item.parcel), "XYZ"[static_cast<int>(item.up)]);
  }
  return text;
}

/// The scenario with boxes of the file's types in place of its own: enough of each to fill the container alone.
model::Scenario with_new_boxes(const model::Scenario& scenario, const ItemsSequenceOptions& options) {
  model::Scenario changed = scenario;
  changed.parcel_types.clear();
  model::add_items(changed, *options.types);
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr || changed.parcel_types.empty()) {
    throw InputError(*options.types, "parcel_types", "nothing", "types, and a scenario with a container to fill");
  }
  std::vector<model::OrderLine> lines;
  for (const model::ParcelType& type : changed.parcel_types) {
    model::OrderLine line;
    line.order = "new";
    line.article = type.name;
    line.size = type.size;
    line.mass = type.mass;
    line.count = static_cast<int>(
        std::min(5000.0, std::ceil(0.01 * options.fill_percent * container->inner_size.prod() / type.size.prod())));
    lines.push_back(line);
  }
  changed.sequences.clear();
  changed.source_text.clear();  // nobody reads it
  const std::size_t before = changed.parcels.size();
  model::add_orders(changed, lines, *options.types);
  changed.parcels.erase(changed.parcels.begin(), changed.parcels.begin() + static_cast<std::ptrdiff_t>(before));
  return changed;
}

/// Types and those parcels that the sequences take.
std::string boxes_as_yaml(const model::Scenario& drawn_from, const std::vector<model::Sequence>& sequences,
                          const std::string& material) {
  std::set<std::string> used;
  for (const model::Sequence& sequence : sequences) {
    for (const model::Item& item : sequence.items) used.insert(item.parcel);
  }
  std::string text = "parcel_types:\n";
  for (const model::ParcelType& type : drawn_from.parcel_types) {
    text += fmt::format("  - {{name: {}, size: [{}, {}, {}], mass: {}}}\n", quoted(type.name), type.size.x(),
                        type.size.y(), type.size.z(), type.mass);
  }
  text += "parcels:\n";
  for (const model::Parcel& parcel : drawn_from.parcels) {
    if (used.count(parcel.id) == 0) continue;
    text += fmt::format("  - {{id: {}, type: {}, material: {}}}\n", parcel.id, quoted(parcel.type), quoted(material));
  }
  return text;
}

}  // namespace

int run_items_draw(const ItemsDrawOptions& options) {
  print_or_write(model::draw_typical_orders(options.wanted), reserve({}, options.output));
  return kSuccess;
}

int run_items_read(const ItemsReadOptions& options) {
  std::optional<OutputFile> output = reserve({{"the sheet", options.sheet}}, options.output);
  const std::string text = read_file(options.sheet, "a table of boxes (CSV)");
  const model::ItemsSheet sheet = model::read_items_sheet(text, options.sheet, options.answers);
  if (!sheet.questions.empty()) {
    const model::SheetQuestion& open = sheet.questions.front();
    const std::string option = open.about == "decimal" ? "--decimal" : "--" + open.about + "-unit";
    std::string choices;
    for (const auto& [answer, meaning] : open.choices)
      choices += fmt::format("{}{} {} ({})", choices.empty() ? "" : ", ", option, answer, meaning);
    throw InputError(options.sheet, open.about, "a sheet that does not say it", choices);
  }
  (void)model::parse_orders_csv(sheet.orders, options.sheet);  // says where a number is none
  print_or_write(sheet.orders, std::move(output));
  return kSuccess;
}

int run_items_reduce(const ItemsReduceOptions& options) {
  std::optional<OutputFile> output = reserve({{"the orders", options.orders}}, options.output);
  const packing::ReductionSettings settings{options.count, 0.01 * options.group_percent, 0.01 * options.cover_percent};
  const packing::Reduction reduction =
      packing::reduce_items(model::load_orders(find_shipped(options.orders)), settings);
  if (output) write_file(std::move(*output), as_yaml(reduction));
  if (options.json) {
    print(as_json(reduction));
    return kSuccess;
  }
  std::printf("%-4s %26s %9s %7s %8s\n", "", "size mm", "mass kg", "boxes", "boxes %");
  for (std::size_t i = 0; i < reduction.representatives.size(); ++i) {
    const packing::Representative& r = reduction.representatives[i];
    std::printf("R%-3zu %8.1f %8.1f %8.1f %9.3f %7d %8.1f\n", i + 1, 1e3 * r.size.x(), 1e3 * r.size.y(),
                1e3 * r.size.z(), r.mass, r.boxes, 100.0 * r.boxes / reduction.boxes);
  }
  std::printf("%d boxes in %d groups; %.1f %% are within %g %% of a representative's size\n", reduction.boxes,
              reduction.groups, reduction.covered_percent, options.cover_percent);
  return kSuccess;
}

int run_items_sequence(const ItemsSequenceOptions& options) {
  const model::Scenario scenario = model::load_scenario(find_scenario(options.scenario));
  NamedFiles inputs = {{"the scenario", find_scenario(options.scenario)}};
  add_file(inputs, "--types", options.types);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  const model::Scenario drawn_from = options.types ? with_new_boxes(scenario, options) : scenario;
  const packing::SequenceSettings settings{options.fill_percent, options.all ? 0.0 : options.repeat,
                                           options.any_side_up, options.all};
  std::vector<model::Sequence> sequences;
  for (int i = 1; i <= options.sequences; ++i) {
    const std::string name = options.name + "-" + std::to_string(i);
    const Rng rng = Rng(options.seed).split("sequence " + name);
    sequences.push_back(packing::draw_sequence(drawn_from, name, settings, rng));
  }
  std::string text = options.all ? fmt::format("# all boxes of {}, seed {}\n", scenario.name, options.seed)
                                 : fmt::format("# boxes of {} to {:g} % of its container, seed {}\n", scenario.name,
                                               options.fill_percent, options.seed);
  if (options.types) {
    const auto material = static_cast<std::size_t>(scenario.parcels.front().material.index);
    text += boxes_as_yaml(drawn_from, sequences, scenario.materials[material].name);
  }
  text += "sequences:\n";
  for (const model::Sequence& sequence : sequences) text += as_yaml(sequence);
  print_or_write(text, std::move(output));
  return kSuccess;
}

}  // namespace snug::app
