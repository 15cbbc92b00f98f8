// Scenario text: the text of a scenario with parts added or changed, so that what runs can be written down whole.
#include "snug/model/internal/scenario_text.hpp"

#include "snug/core/check.hpp"
#include "snug/model/internal/value.hpp"

namespace snug::model::internal {
namespace {

YAML::Node as_yaml(const Vector3& v) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (int i = 0; i < 3; ++i) list.push_back(to_text(v[i]));
  list.SetStyle(YAML::EmitterStyle::Flow);
  return list;
}

YAML::Node as_yaml(bool value) { return YAML::Node(value ? "true" : "false"); }

std::string as_list(const Vector3& v) {
  return "[" + to_text(v[0]) + ", " + to_text(v[1]) + ", " + to_text(v[2]) + "]";
}

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return text + "\"";
}

/// Stands for the new entries of a list until the tree is text: a tree of thousands of entries takes long to write. No
/// name can hold the character.
std::string mark_in_tree(const std::string& key) { return "\x01" + key; }
std::string mark_in_text(const std::string& key) { return "\"\\x01" + key + "\""; }

/// Takes the key away first: a value that is an alias of another would change that too.
void set(YAML::Node map, const char* key, const YAML::Node& value) {
  map.remove(key);
  map[key] = value;
}

YAML::Node container_entry(const YAML::Node& root, const std::string& container) {
  for (const YAML::Node& entry : root["containers"]) {
    if (entry["name"].Scalar() == container) return entry;
  }
  SNUG_CHECK(false, "a container of a loaded scenario stands in its text");
  return {};
}

}  // namespace

std::string text_of(const YAML::Node& root) {
  YAML::Emitter emitter;
  emitter << root;
  SNUG_CHECK(emitter.good(), "a tree that was read can be written");
  return std::string(emitter.c_str()) + "\n";
}

std::string text_of(const YAML::Node& root, const std::string& text, const std::string& why) {
  // The notes of changes before this one are kept.
  std::string notes;
  constexpr std::string_view kMark = "# changed: ";
  for (std::size_t at = 0; text.compare(at, kMark.size(), kMark) == 0;) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) break;
    notes += text.substr(at, end + 1 - at);
    at = end + 1;
  }
  std::string line = std::string(kMark) + why;
  for (char& c : line) c = static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return notes + line + "\n" + text_of(root);
}

std::string text_with_items(const std::string& text, const YAML::Node& items, const std::string& why) {
  YAML::Node root = YAML::Load(text);
  for (const char* key : {"parcel_types", "parcels", "sequences"}) {
    if (!items[key]) continue;
    for (const YAML::Node& entry : items[key]) root[key].push_back(entry);
  }
  return text_of(root, text, why);
}

std::string text_with_entries(const std::string& text, const NewEntries& entries, const std::string& why) {
  YAML::Node root = YAML::Load(text);
  for (const auto& [key, list] : entries) {
    if (!list.empty()) root[key].push_back(mark_in_tree(key));
  }
  std::string changed = text_of(root, text, why);
  for (const auto& [key, list] : entries) {
    if (list.empty()) continue;
    const std::string mark = mark_in_text(key);
    const std::size_t at = changed.find(mark);
    SNUG_CHECK(at != std::string::npos, "what was put into a tree stands in its text");
    const std::size_t line = changed.rfind('\n', at) + 1;
    const std::string before = changed.substr(line, at - line);
    const bool is_block = before.find_first_not_of(" -") == std::string::npos;
    const std::string separator = is_block ? "\n" + before : ", ";
    std::string all;
    for (const std::string& entry : list) all += (all.empty() ? "" : separator) + entry;
    changed.replace(at, mark.size(), all);
  }
  return changed;
}

std::string text_with_target(const std::string& text, const Container& container, const std::string& why) {
  YAML::Node root = YAML::Load(text);
  const YAML::Node entry = container_entry(root, container.name);
  set(entry, "inner_size", as_yaml(container.inner_size));
  set(entry, "walls", as_yaml(container.has_walls));
  set(entry, "holds_all", as_yaml(container.holds_all));
  set(root, "target", YAML::Node(container.name));
  return text_of(root, text, why);
}

std::string entry_of(const ParcelType& type) {
  return "{name: " + quoted(type.name) + ", size: " + as_list(type.size) + ", mass: " + to_text(type.mass) + "}";
}

std::string entry_of(const Scenario& scenario, const Parcel& parcel) {
  std::string entry = "{id: " + quoted(parcel.id) + ", type: " + quoted(parcel.type) + ", material: " +
                      quoted(scenario.materials[static_cast<std::size_t>(parcel.material.index)].name) +
                      ", size: " + as_list(parcel.size) + ", mass: " + to_text(parcel.inertia.mass);
  if (parcel.handling.upright_only) entry += ", upright_only: true";
  if (parcel.handling.no_stack) entry += ", no_stack: true";
  if (parcel.handling.max_load) entry += ", max_load: " + to_text(*parcel.handling.max_load);
  return entry + "}";
}

std::string entry_of(const Sequence& sequence) {
  std::string items;
  for (const Item& item : sequence.items) {
    items += items.empty() ? "" : ", ";
    items += "{parcel: " + quoted(item.parcel) + ", up: " + (item.up_sign < 0 ? "-" : "") +
             "XYZ"[static_cast<int>(item.up)] + "}";
  }
  return "{name: " + quoted(sequence.name) + ", items: [" + items + "]}";
}

}  // namespace snug::model::internal
