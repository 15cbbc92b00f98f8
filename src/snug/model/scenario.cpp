// Scenario: loading from file or text, and looking things up by name.
#include "snug/model/scenario.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <system_error>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "snug/model/internal/parse.hpp"
#include "snug/model/internal/scenario_reader.hpp"

namespace snug::model {
namespace internal {
namespace {

std::string where_of(std::string_view name, const YAML::Mark& mark) {
  std::string where(name);
  if (!mark.is_null()) where.append(":").append(std::to_string(mark.line + 1));
  return where;
}

/// Notes where documents start and is deaf to the rest.
class DocumentStarts final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { last_start = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
  YAML::Mark last_start;
};

/// YAML::Load takes the first document and silently drops what follows, be it a second one or the rest after a stray
/// bracket; YAML::LoadAll never returns when it meets a stray comma.
void check_one_document(const std::string& text, std::string_view name) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStarts starts;
  if (!parser.HandleNextDocument(starts)) throw InputError(std::string(name) + ":1", "", "nothing", "a mapping");
  if (parser.HandleNextDocument(starts))
    throw InputError(where_of(name, starts.last_start), "", "something after the end of the YAML document",
                     "one document and nothing else (look for a stray bracket, comma or ---)");
}

}  // namespace

Scenario parse_text(std::string_view text, std::string_view name, std::set<std::string>* known_keys) {
  Document document{std::string(name), {}};
  Scenario scenario;
  scenario.source_name = document.name;
  scenario.source_text = std::string(text);
  scenario.name = document.name;
  try {
    check_one_document(scenario.source_text, name);
    ScenarioReader(Value(YAML::Load(scenario.source_text), "", document, 1), scenario).read();
  } catch (const YAML::Exception& error) {
    throw InputError(where_of(name, error.mark), "", error.msg, "YAML that can be parsed");
  }
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
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw InputError(path.string(), "", "no readable file", "a scenario file (YAML)");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!(text << file.rdbuf()))
    throw InputError(path.string(), "", "a file that is empty or cannot be read", "YAML text");
  Scenario scenario = parse_scenario(text.str(), path.string());
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
