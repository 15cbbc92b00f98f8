// ItemsFile: boxes and the orders in which they come, from files of other people, added to a scenario.
#include "snug/model/items_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "snug/model/internal/mass_properties.hpp"
#include "snug/model/internal/parse.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/internal/scenario_text.hpp"

namespace snug::model {
namespace {

const std::vector<std::string> kColumns{"order",   "article", "length_mm",    "width_mm", "height_mm",
                                        "mass_kg", "count",   "upright_only", "no_stack", "max_load_kg"};
constexpr double kMillimetre = 1e-3;
constexpr double kLongestMm = 1e5;
constexpr double kHeaviest = 1e5;
constexpr std::size_t kMostBoxes = 100000;

std::string read_text(const std::filesystem::path& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!std::filesystem::is_regular_file(path, error) || !(text << file.rdbuf())) {
    throw InputError(path.string(), "", "no readable file", "orders (.csv, .json) or items (.yaml)");
  }
  return text.str();
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t start = 0;;) {
    const std::size_t comma = line.find(',', start);
    std::string_view field = line.substr(start, comma == std::string_view::npos ? comma : comma - start);
    while (!field.empty() && (field.front() == ' ' || field.front() == '\t')) field.remove_prefix(1);
    while (!field.empty() && (field.back() == ' ' || field.back() == '\t')) field.remove_suffix(1);
    fields.push_back(field);
    if (comma == std::string_view::npos) return fields;
    start = comma + 1;
  }
}

/// One line of a CSV under its header.
class Row {
 public:
  Row(const std::vector<std::string>& header, std::vector<std::string_view> fields, std::string where)
      : header_(header), fields_(std::move(fields)), where_(std::move(where)) {
    if (fields_.size() != header_.size()) {
      throw InputError(where_, "", std::to_string(fields_.size()) + " fields",
                       std::to_string(header_.size()) + ", as the header has");
    }
  }
  [[nodiscard]] std::string_view text(const std::string& key) const {
    const auto found = std::find(header_.begin(), header_.end(), key);
    return found == header_.end() ? std::string_view{} : fields_[static_cast<std::size_t>(found - header_.begin())];
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
  std::vector<std::string_view> fields_;
  std::string where_;
};

OrderLine read_row(const Row& row, const std::string& name, int line) {
  const double required = std::nan("");
  OrderLine entry;
  entry.order = row.text("order").empty() ? name : std::string(row.text("order"));
  entry.article = std::string(row.text("article"));
  entry.size = kMillimetre * Vector3(row.number("length_mm", 1.0, kLongestMm, required),
                                     row.number("width_mm", 1.0, kLongestMm, required),
                                     row.number("height_mm", 1.0, kLongestMm, required));
  entry.mass = row.number("mass_kg", 1e-3, kHeaviest, required);
  entry.count = row.whole("count", 1, 5000, 1);
  entry.handling = {row.flag("upright_only"), row.flag("no_stack"), std::nullopt};
  if (!row.text("max_load_kg").empty()) entry.handling.max_load = row.number("max_load_kg", 0.0, 1e6, required);
  entry.line = line;
  return entry;
}

std::vector<std::string> read_header(std::string_view text, const std::string& name) {
  std::vector<std::string> header;
  for (const std::string_view field : split(text)) {
    std::string key(field);
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

double json_number(const nlohmann::json& item, const char* key, double low, double high, const std::string& where) {
  const auto found = item.find(key);
  if (found == item.end() || !found->is_number() || !(found->get<double>() >= low && found->get<double>() <= high)) {
    throw InputError(where, key, found == item.end() ? "nothing" : found->dump(),
                     "a number from " + internal::to_text(low) + " to " + internal::to_text(high));
  }
  return found->get<double>();
}

OrderLine read_json_item(const nlohmann::json& item, const std::string& order, const std::string& where) {
  if (!item.is_object()) throw InputError(where, "", item.dump().substr(0, 40), "an item");
  OrderLine entry;
  entry.order = order;
  if (const auto id = item.find("id"); id != item.end() && id->is_string()) entry.article = id->get<std::string>();
  entry.size = kMillimetre * Vector3(json_number(item, "length/mm", 1.0, kLongestMm, where),
                                     json_number(item, "width/mm", 1.0, kLongestMm, where),
                                     json_number(item, "height/mm", 1.0, kLongestMm, where));
  entry.mass = json_number(item, "weight/kg", 1e-3, kHeaviest, where);
  return entry;
}

void add_items_text(Scenario& scenario, const std::string& text, const std::string& name) {
  internal::Document document{name, {}};
  Scenario extended = scenario;
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

std::string where_of(const std::string& name, const OrderLine& line) {
  return line.line > 0 ? name + ":" + std::to_string(line.line) : name;
}

/// What a scenario could not say of a box, an order cannot ask for either.
void check_line(const Scenario& scenario, const OrderLine& line, const std::string& name) {
  const auto check_name = [&](const char* key, const std::string& text) {
    const bool is_printable = std::all_of(text.begin(), text.end(),
                                          [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f; });
    if (text.size() > 100 || !is_printable) {
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
  YAML::Node items;
  for (std::size_t i = types; i < scenario.parcel_types.size(); ++i)
    items["parcel_types"].push_back(internal::as_yaml(scenario.parcel_types[i]));
  for (std::size_t i = parcels; i < scenario.parcels.size(); ++i)
    items["parcels"].push_back(internal::as_yaml(scenario, scenario.parcels[i]));
  for (std::size_t i = sequences; i < scenario.sequences.size(); ++i)
    items["sequences"].push_back(internal::as_yaml(scenario.sequences[i]));
  scenario.source_text = internal::text_with_items(scenario.source_text, items, "--items " + name);
}

/// The type of a line's boxes: by article, with a number behind it where other boxes have that name.
std::string type_for(Scenario& scenario, const OrderLine& line) {
  const std::string article = line.article.empty() ? "box" : line.article;
  for (int i = 1;; ++i) {
    const std::string name = i == 1 ? article : article + "-" + std::to_string(i);
    const ParcelType* type = find_parcel_type(scenario, name);
    if (type == nullptr) scenario.parcel_types.push_back({name, line.size, line.mass});
    if (type == nullptr || (type->size == line.size && type->mass == line.mass)) return name;
  }
}

}  // namespace

std::vector<OrderLine> parse_orders_csv(std::string_view text, const std::string& name) {
  std::vector<std::string> header;
  std::vector<OrderLine> lines;
  std::size_t boxes = 0;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (number == 1) {
      header = read_header(line, name);
    } else if (line.find_first_not_of(" \t") != std::string_view::npos) {
      const Row row(header, split(line), name + ":" + std::to_string(number));
      lines.push_back(read_row(row, std::filesystem::path(name).stem().string(), number));
      boxes += static_cast<std::size_t>(lines.back().count);
      if (boxes > kMostBoxes) throw InputError(name, "", "more than 100000 boxes", "fewer");
    }
  }
  if (lines.empty()) throw InputError(name, "", "no boxes", "a header and at least one line");
  return lines;
}

std::vector<OrderLine> parse_orders_json(std::string_view text, const std::string& name) {
  const nlohmann::json root = nlohmann::json::parse(text, nullptr, false);
  if (!root.is_object()) throw InputError(name, "", "something else", "a JSON object of orders (BED-BPP)");
  std::vector<OrderLine> lines;
  for (const auto& [order, content] : root.items()) {
    const auto sequence = content.is_object() ? content.find("item_sequence") : content.end();
    if (!content.is_object() || sequence == content.end() || !sequence->is_object()) {
      throw InputError(name, order, "no item_sequence", "an order with an item_sequence (BED-BPP)");
    }
    std::map<long, OrderLine> by_number;
    for (const auto& [number, item] : sequence->items()) {
      const std::string where = name + ": " + order + ", item " + number;
      long position = 0;
      const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), position);
      if (error != std::errc{} || end != number.data() + number.size()) {
        throw InputError(where, number, "no number", "items counted from 1");
      }
      if (!by_number.emplace(position, read_json_item(item, order, where)).second) {
        throw InputError(where, number, "a second time", "each number once");
      }
    }
    for (auto& [number, line] : by_number) lines.push_back(std::move(line));
    if (lines.size() > kMostBoxes) throw InputError(name, "", "more than 100000 boxes", "fewer");
  }
  if (lines.empty()) throw InputError(name, "", "no items", "at least one");
  return lines;
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
  int number = 0;
  for (const OrderLine& line : lines) {
    check_line(scenario, line, name);
    auto sequence = std::find_if(scenario.sequences.begin(), scenario.sequences.end(),
                                 [&](const Sequence& s) { return s.name == line.order; });
    if (sequence == scenario.sequences.end()) {
      scenario.sequences.push_back({});
      sequence = scenario.sequences.end() - 1;
      sequence->name = line.order;
    } else if (sequence < scenario.sequences.begin() + static_cast<std::ptrdiff_t>(known)) {
      throw InputError(where_of(name, line), "order", "'" + line.order + "'", "a name that is not taken");
    }
    const std::string type = type_for(scenario, line);
    for (int i = 0; i < line.count; ++i) {
      char id[32];
      do {
        std::snprintf(id, sizeof id, "ITEM%06d", ++number);
      } while (!ids.insert(id).second);
      Parcel parcel{id, type, line.size, {}, material, line.handling};
      parcel.inertia = {line.mass, Vector3::Zero(), internal::cuboid_inertia(line.size, line.mass)};
      scenario.parcels.push_back(parcel);
      sequence->items.push_back({});
      sequence->items.back().parcel = id;
    }
  }
  write_down(scenario, types, parcels, known, name);
}

void add_items(Scenario& scenario, const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".yaml" || ending == ".yml") {
    add_items_text(scenario, read_text(path), path.string());
  } else {
    add_orders(scenario, load_orders(path), path.string());
  }
}

}  // namespace snug::model
