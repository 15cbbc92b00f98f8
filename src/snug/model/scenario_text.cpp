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

/// Takes the key away first: a value that is an alias of another would change that too.
void set(YAML::Node map, const char* key, const YAML::Node& value) {
  map.remove(key);
  map[key] = value;
}

YAML::Node entry_of(const YAML::Node& root, const std::string& container) {
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

std::string text_with_target(const std::string& text, const Container& container, const std::string& why) {
  YAML::Node root = YAML::Load(text);
  const YAML::Node entry = entry_of(root, container.name);
  set(entry, "inner_size", as_yaml(container.inner_size));
  set(entry, "walls", as_yaml(container.has_walls));
  set(entry, "holds_all", as_yaml(container.holds_all));
  set(root, "target", YAML::Node(container.name));
  return text_of(root, text, why);
}

YAML::Node as_yaml(const ParcelType& type) {
  YAML::Node node;
  node["name"] = type.name;
  node["size"] = as_yaml(type.size);
  node["mass"] = to_text(type.mass);
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node as_yaml(const Scenario& scenario, const Parcel& parcel) {
  YAML::Node node;
  node["id"] = parcel.id;
  node["type"] = parcel.type;
  node["material"] = scenario.materials[static_cast<std::size_t>(parcel.material.index)].name;
  node["size"] = as_yaml(parcel.size);
  node["mass"] = to_text(parcel.inertia.mass);
  if (parcel.handling.upright_only) node["upright_only"] = as_yaml(true);
  if (parcel.handling.no_stack) node["no_stack"] = as_yaml(true);
  if (parcel.handling.max_load) node["max_load"] = to_text(*parcel.handling.max_load);
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node as_yaml(const Sequence& sequence) {
  YAML::Node node;
  node["name"] = sequence.name;
  for (const Item& item : sequence.items) {
    YAML::Node entry;
    entry["parcel"] = item.parcel;
    entry["up"] = std::string(item.up_sign < 0 ? "-" : "") + "XYZ"[static_cast<int>(item.up)];
    entry.SetStyle(YAML::EmitterStyle::Flow);
    node["items"].push_back(entry);
  }
  return node;
}

}  // namespace snug::model::internal
