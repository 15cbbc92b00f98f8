// ItemsFile: boxes and the orders in which they come, from files of other people, added to a scenario.
#include "snug/model/items_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

#include "snug/core/csv_fields.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"
#include "snug/model/internal/orders_json.hpp"
#include "snug/model/internal/parse.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/internal/scenario_text.hpp"
#include "snug/model/mass_properties.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace {

using internal::kHeaviest;
using internal::kLightest;
using internal::kLongestMm;
using internal::kMostBoxes;
using internal::kShortestMm;

const std::vector<std::string> kColumns{"order",   "article", "length_mm",    "width_mm", "height_mm",
                                        "mass_kg", "count",   "upright_only", "no_stack", "max_load_kg"};
/// Boxes that orders add to a scenario with a text: there they are up to 30 values each, within kMostYamlValues and 100
/// MB.
constexpr std::size_t kMostWritten = 3000;

std::string read_text(const std::filesystem::path& path) {
  return read_file(path, "orders (.csv, .json) or items (.yaml)");
}

/// One line of a CSV under its header.
class Row {
 public:
  Row(const std::vector<std::string>& header, std::vector<std::string> fields, std::string where)
      : header_(header), fields_(std::move(fields)), where_(std::move(where)) {
    if (fields_.size() != header_.size()) {
      throw InputError(where_, "", std::to_string(fields_.size()) + " fields",
                       std::to_string(header_.size()) + ", as the header has");
    }
  }
  [[nodiscard]] std::string_view text(const std::string& key) const {
    const auto found = std::find(header_.begin(), header_.end(), key);
    if (found == header_.end()) return {};
    return fields_[static_cast<std::size_t>(found - header_.begin())];
  }
  [[nodiscard]] double number(const std::string& key, double low, double high, double otherwise) const {
    const std::string_view field = text(key);
    if (field.empty() && std::isfinite(otherwise)) return otherwise;
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size() || !(value >= low && value <= high)) {
      throw InputError(where_, key, "'" + std::string(field) + "'",
                       "a number from " + internal::to_text(low) + " to " + internal::to_text(high));
    }
    return value;
  }
  [[nodiscard]] int whole(const std::string& key, int low, int high, int otherwise) const {
    const double value = number(key, low, high, otherwise);
    if (value != std::floor(value)) {
      throw InputError(where_, key, "'" + std::string(text(key)) + "'", "a whole number");
    }
    return static_cast<int>(value);
  }
  [[nodiscard]] bool flag(const std::string& key) const { return whole(key, 0, 1, 0) != 0; }

 private:
  const std::vector<std::string>& header_;
  std::vector<std::string> fields_;
  std::string where_;
};

OrderLine read_row(const Row& row, const std::string& name, int line) {
  const double required = std::nan("");
  OrderLine entry;
  entry.order = row.text("order").empty() ? name : std::string(row.text("order"));
  entry.article = std::string(row.text("article"));
  entry.size = kMillimetre * Vector3(row.number("length_mm", kShortestMm, kLongestMm, required),
                                     row.number("width_mm", kShortestMm, kLongestMm, required),
                                     row.number("height_mm", kShortestMm, kLongestMm, required));
  entry.mass = row.number("mass_kg", kLightest, kHeaviest, required);
  entry.count = row.whole("count", 1, 5000, 1);
  entry.handling = {row.flag("upright_only"), row.flag("no_stack"), std::nullopt};
  if (!row.text("max_load_kg").empty()) entry.handling.max_load = row.number("max_load_kg", 0.0, 1e6, required);
  entry.line = line;
  return entry;
}

std::vector<std::string> read_header(std::string_view text, const std::string& name) {
  std::vector<std::string> header;
  refuse_semicolons(text, name + ":1");
  for (std::string& key : split_csv(text, name + ":1")) {
    if (std::find(kColumns.begin(), kColumns.end(), key) == kColumns.end()) {
      std::string known;
      for (const std::string& column : kColumns) known += (known.empty() ? "" : ", ") + column;
      throw InputError(name + ":1", key, "an unknown column", known + internal::nearest_hint(key, kColumns));
    }
    if (std::find(header.begin(), header.end(), key) != header.end()) {
      throw InputError(name + ":1", key, "a second time", "each column once");
    }
    header.push_back(std::move(key));
  }
  for (const char* key : {"length_mm", "width_mm", "height_mm", "mass_kg"}) {
    if (std::find(header.begin(), header.end(), key) == header.end()) {
      throw InputError(name + ":1", key, "nothing", "this column");
    }
  }
  return header;
}

std::string where_of(const std::string& name, const OrderLine& line) {
  return line.line > 0 ? name + ":" + std::to_string(line.line) : name;
}

/// What a scenario could not say of a box, an order cannot ask for either.
void check_line(const Scenario& scenario, const OrderLine& line, const std::string& name) {
  const auto check_name = [&](const char* key, const std::string& text) {
    if (text.size() > 100 || !is_printable(text)) {
      throw InputError(where_of(name, line), key, internal::quote(text), "at most 100 printable characters");
    }
  };
  check_name("order", line.order);
  check_name("article", line.article);
  const double least = line.size.minCoeff();
  if (!(least - scenario.parcel_clearance >= internal::kSmallestSize)) {
    throw InputError(where_of(name, line), "", "an edge of " + internal::to_text(1e3 * least) + " mm",
                     "edges larger than the scenario's parcel_clearance of " +
                         internal::to_text(1e3 * scenario.parcel_clearance) + " mm");
  }
}

/// Everything from these positions on is written behind the scenario's text. Boxes of orders may be too large for the
/// container: that is for packing to say.
void write_down(Scenario& scenario, std::size_t types, std::size_t parcels, std::size_t sequences,
                const std::string& name) {
  for (Container& container : scenario.containers) {
    if (container.name != scenario.target || !container.holds_all) continue;
    container.holds_all = false;
    if (!scenario.source_text.empty())
      scenario.source_text = internal::text_with_target(scenario.source_text, container, "--items " + name);
  }
  if (scenario.source_text.empty()) return;
  internal::NewEntries entries;
  for (std::size_t i = types; i < scenario.parcel_types.size(); ++i)
    entries["parcel_types"].push_back(internal::entry_of(scenario.parcel_types[i]));
  for (std::size_t i = parcels; i < scenario.parcels.size(); ++i)
    entries["parcels"].push_back(internal::entry_of(scenario, scenario.parcels[i]));
  for (std::size_t i = sequences; i < scenario.sequences.size(); ++i)
    entries["sequences"].push_back(internal::entry_of(scenario.sequences[i]));
  scenario.source_text = internal::text_with_entries(scenario.source_text, entries, "--items " + name);
}

/// The types of boxes: by article, with a number behind it where other boxes have that name.
class TypeNames {
 public:
  explicit TypeNames(Scenario& scenario) : scenario_(scenario) {
    for (const ParcelType& type : scenario.parcel_types) known_.emplace(type.name, Boxes(type));
  }
  const std::string& name_for(const OrderLine& line) {
    const std::string article = line.article.empty() ? "box" : line.article;
    const Boxes boxes(line);
    if (const auto named = named_.find({article, boxes}); named != named_.end()) return named->second;
    // Numbers that were tried for this article belong to boxes in named_.
    for (int& i = tried_[article];;) {
      const std::string name = ++i == 1 ? article : article + "-" + std::to_string(i);
      const auto [type, is_free] = known_.emplace(name, boxes);
      if (is_free) scenario_.parcel_types.push_back({name, line.size, line.mass});
      const auto [named, is_new] = named_.try_emplace({article, type->second}, name);
      if (type->second == boxes) return named->second;
    }
  }

 private:
  /// What boxes of one type have in common.
  struct Boxes : std::array<double, 4> {
    template <class Thing>
    explicit Boxes(const Thing& thing)
        : std::array<double, 4>{thing.size.x(), thing.size.y(), thing.size.z(), thing.mass} {}
  };
  Scenario& scenario_;
  std::map<std::string, Boxes> known_;
  std::map<std::pair<std::string, Boxes>, std::string> named_;
  std::map<std::string, int> tried_;
};

}  // namespace

std::vector<OrderLine> parse_orders_csv(std::string_view text, const std::string& name) {
  std::vector<std::string> header;
  std::vector<OrderLine> lines;
  std::size_t boxes = 0;
  check_utf8(text, name);
  text = without_byte_order_mark(text);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (number == 1) {
      header = read_header(line, name);
    } else if (line.find_first_not_of(" \t") != std::string_view::npos) {
      const std::string where = name + ":" + std::to_string(number);
      const Row row(header, split_csv(line, where), where);
      lines.push_back(read_row(row, std::filesystem::path(name).stem().string(), number));
      boxes += static_cast<std::size_t>(lines.back().count);
      if (boxes > kMostBoxes) {
        throw InputError(where, "", "more than " + std::to_string(kMostBoxes) + " boxes", "fewer");
      }
    }
  }
  if (lines.empty()) throw InputError(name, "", "no boxes", "a header and at least one line");
  return lines;
}

std::vector<OrderLine> parse_orders_json(std::string_view text, const std::string& name) {
  check_utf8(text, name);
  return internal::read_orders_json(text, name);
}

std::vector<OrderLine> load_orders(const std::filesystem::path& path) {
  const std::string text = read_text(path), ending = path.extension().string();
  if (ending == ".json") return parse_orders_json(text, path.string());
  if (ending == ".csv") return parse_orders_csv(text, path.string());
  throw InputError(path.string(), "", "ending '" + ending + "'", ".csv or .json");
}

void add_orders(Scenario& scenario, const std::vector<OrderLine>& lines, const std::string& name) {
  if (scenario.parcels.empty()) {
    throw InputError(scenario.source_name, "parcels", "none", "at least one parcel, whose surface others get");
  }
  const MaterialId material = scenario.parcels.front().material;
  const std::size_t known = scenario.sequences.size(), types = scenario.parcel_types.size();
  const std::size_t parcels = scenario.parcels.size();
  std::set<std::string> ids;
  for (const Parcel& parcel : scenario.parcels) ids.insert(parcel.id);
  std::map<std::string, std::size_t> sequence_of;
  for (std::size_t i = 0; i < known; ++i) sequence_of.emplace(scenario.sequences[i].name, i);
  TypeNames type_names(scenario);
  int number = 0;
  for (const OrderLine& line : lines) {
    check_line(scenario, line, name);
    const auto [sequence, is_new] = sequence_of.emplace(line.order, scenario.sequences.size());
    if (is_new) {
      scenario.sequences.push_back({});
      scenario.sequences.back().name = line.order;
    } else if (sequence->second < known) {
      throw InputError(where_of(name, line), "order", "'" + line.order + "'", "a name that is not taken");
    }
    std::vector<Item>& items = scenario.sequences[sequence->second].items;
    const std::string& type = type_names.name_for(line);
    for (int i = 0; i < line.count; ++i) {
      char id[32];
      do {
        std::snprintf(id, sizeof id, "ITEM%06d", ++number);
      } while (!ids.insert(id).second);
      const std::size_t most = scenario.source_text.empty() ? kMostBoxes : kMostWritten;
      if (scenario.parcels.size() - parcels >= most) {
        throw InputError(where_of(name, line), "", "more than " + std::to_string(most) + " boxes",
                         "fewer: the scenario with all its boxes goes into each recording");
      }
      Parcel parcel{id, type, line.size, {}, material, line.handling};
      parcel.inertia = {line.mass, Vector3::Zero(), cuboid_inertia(line.size, line.mass)};
      scenario.parcels.push_back(parcel);
      items.push_back({});
      items.back().parcel = id;
    }
  }
  write_down(scenario, types, parcels, known, name);
}

void add_items_yaml(Scenario& scenario, const std::string& text, const std::string& name) {
  internal::Document document{name, {}};
  Scenario extended = scenario;
  check_yaml(text, name);
  try {
    const YAML::Node items = YAML::Load(text);
    internal::ScenarioReader(internal::Value(items, "", document, 1), extended).read_items();
    if (!scenario.source_text.empty())
      extended.source_text = internal::text_with_items(scenario.source_text, items, "--items " + name);
  } catch (const YAML::Exception& error) {
    throw InputError(name + ":" + std::to_string(error.mark.line + 1), "", error.msg, "YAML that can be parsed");
  }
  scenario = std::move(extended);
}

void add_items(Scenario& scenario, const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".yaml" || ending == ".yml") {
    add_items_yaml(scenario, read_text(path), path.string());
  } else {
    add_orders(scenario, load_orders(path), path.string());
  }
}

}  // namespace snug::model
