// Scenario: loading from file or text, and looking things up by name.
#include "snug/model/scenario.hpp"

#include <algorithm>
#include <cstdlib>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <yaml-cpp/yaml.h>

#include "snug/core/read_file.hpp"
#include "snug/model/internal/parse.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace internal {
namespace {

std::string where_of(std::string_view name, const YAML::Mark& mark) {
  std::string where(name);
  if (!mark.is_null()) where.append(":").append(std::to_string(mark.line + 1));
  return where;
}

/// Gives what reading took back to the system: the tree of a large text takes fifty times as much as the text, and the
/// C library would keep it.
void release_memory([[maybe_unused]] std::size_t text_size) {
#if defined(__GLIBC__)
  constexpr std::size_t kLarge = 64 * 1024;  // characters; smaller texts are not worth the walk over what is free
  if (text_size >= kLarge) (void)::malloc_trim(0);
#endif
}

}  // namespace

Scenario parse_text(std::string_view text, std::string_view name, std::set<std::string>* known_keys) {
  Document document{std::string(name), {}};
  Scenario scenario;
  scenario.source_name = document.name;
  scenario.source_text = std::string(text);
  scenario.name = document.name;
  check_yaml(text, name);
  try {
    ScenarioReader(Value(YAML::Load(scenario.source_text), "", document, 1), scenario).read();
  } catch (const YAML::Exception& error) {
    throw InputError(where_of(name, error.mark), "", error.msg, "YAML that can be parsed");
  }
  release_memory(text.size());
  scenario.side_files = document.side_files;
  scenario.warnings = document.warnings;
  if (known_keys != nullptr) known_keys->insert(document.known_keys.begin(), document.known_keys.end());
  return scenario;
}

}  // namespace internal

namespace {

template <class Thing, class Key>
const Thing* find_named(const std::vector<Thing>& things, Key Thing::*key, std::string_view name) {
  const auto found = std::find_if(things.begin(), things.end(), [&](const Thing& t) { return t.*key == name; });
  return found == things.end() ? nullptr : &*found;
}

}  // namespace

Scenario load_scenario(const std::filesystem::path& path) {
  Scenario scenario = parse_scenario(read_file(path, "a scenario file (YAML)"), path.string());
  if (scenario.name == scenario.source_name) scenario.name = path.stem().string();
  return scenario;
}

Scenario parse_scenario(std::string_view text, std::string_view name) {
  return internal::parse_text(text, name, nullptr);
}

std::optional<ContactParams> find_contact(const Scenario& scenario, MaterialId a, MaterialId b) {
  for (const ContactPair& pair : scenario.contact_pairs)
    if ((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a)) return pair.params;
  return scenario.default_contact;
}

const Parcel* find_parcel(const Scenario& scenario, std::string_view id) {
  return find_named(scenario.parcels, &Parcel::id, id);
}

const ParcelType* find_parcel_type(const Scenario& scenario, std::string_view name) {
  return find_named(scenario.parcel_types, &ParcelType::name, name);
}

const Container* find_container(const Scenario& scenario, std::string_view name) {
  return find_named(scenario.containers, &Container::name, name);
}

const Sequence* find_sequence(const Scenario& scenario, std::string_view name) {
  return find_named(scenario.sequences, &Sequence::name, name);
}

const Body* find_body(const Scenario& scenario, std::string_view name) {
  return find_named(scenario.bodies, &Body::name, name);
}

const CameraParams* find_camera(const Scenario& scenario, std::string_view name) {
  return find_named(scenario.cameras, &CameraParams::name, name);
}

const CorrectionLayer* find_correction_layer(const Scenario& scenario, std::string_view name) {
  return find_named(scenario.controller.correction_layers, &CorrectionLayer::name, name);
}

std::vector<std::string> first_parcels(const Sequence& sequence, int count) {
  std::vector<std::string> ids;
  for (const Item& item : sequence.items) {
    if (static_cast<int>(ids.size()) < count) ids.push_back(item.parcel);
  }
  return ids;
}

double compute_filling_degree_percent(const Scenario& scenario, const Container& container,
                                      const std::vector<std::string>& parcel_ids) {
  double volume = 0.0;
  for (const std::string& id : parcel_ids)
    if (const Parcel* parcel = find_parcel(scenario, id)) volume += parcel->size.prod();
  return 100.0 * volume / compute_volume(container);
}

}  // namespace snug::model
