// Scenario block: text with comments, and the proof that a scenario takes it.
#include "snug/identification/scenario_block.hpp"

#include <array>
#include <charconv>
#include <cstdio>

#include "snug/core/check.hpp"
#include "snug/model/scenario.hpp"

namespace snug::identification {
namespace {

constexpr std::array<const char*, 5> kKeys = {"lateral", "axial", "bend", "torsion", "coupling"};

bool is_taken(const BlockEntry& entry) {
  return entry.verdict != Verdict::NotIdentifiable && (entry.value >= 0.0 || entry.key == kKeys[4]);
}

std::string text_of(double value) {
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 9);
  return {buffer, end};
}

std::string section(const char* name, const std::vector<BlockEntry>& entries) {
  if (entries.empty()) return "";
  std::string lines;
  bool has_any = false;
  for (const BlockEntry& entry : entries) {
    char about[120];
    std::snprintf(about, sizeof about, "# +- %.2g %s, %s", entry.standard_error, entry.unit.c_str(),
                  name_of(entry.verdict));
    has_any = has_any || is_taken(entry);
    lines += std::string("    ") + (is_taken(entry) ? "" : "# ") + entry.key + ": " + text_of(entry.value) + "  " +
             about + "\n";
  }
  return std::string("  ") + name + ":" + (has_any ? "\n" : " {}\n") + lines;
}

double value_of(const model::CupElasticity& elasticity, const std::string& key) {
  const std::array<double, 5> values = {elasticity.lateral, elasticity.axial, elasticity.bend, elasticity.torsion,
                                        elasticity.coupling};
  for (std::size_t i = 0; i < kKeys.size(); ++i)
    if (key == kKeys[i]) return values[i];
  SNUG_CHECK(false, "a key of a stiffness or damping");
}

void check_taken(const model::CupElasticity& loaded, const std::vector<BlockEntry>& entries) {
  for (const BlockEntry& entry : entries) {
    if (!is_taken(entry)) continue;
    const std::string text = text_of(entry.value);
    double written = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), written);
    SNUG_CHECK(value_of(loaded, entry.key) == written, "a scenario holds the numbers of the block");
  }
}

}  // namespace

std::vector<BlockEntry> block_entries(const std::vector<Parameter>& parameters, char letter) {
  const std::string prefix = std::string(1, letter) + "_";
  const std::array<std::string, 5> names = {prefix + "lat", prefix + "ax", prefix + "bend", prefix + "tors",
                                            letter == 'k' ? "c" : "d_c"};
  std::vector<BlockEntry> entries;
  for (const Parameter& parameter : parameters) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (parameter.name == names[i])
        entries.push_back({kKeys[i], parameter.value, parameter.standard_error, parameter.unit, parameter.verdict});
  }
  return entries;
}

std::string format_cup_block(const std::vector<BlockEntry>& stiffness, const std::vector<BlockEntry>& damping,
                             const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += "# " + note + "\n";
  text += "cup:\n" + section("stiffness", stiffness) + section("damping", damping);
  const model::Scenario scenario = model::parse_scenario("materials: [{name: any}]\n" + text, "identified cup");
  check_taken(scenario.cup.stiffness, stiffness);
  check_taken(scenario.cup.damping, damping);
  return text;
}

std::vector<BlockEntry> block_entries(const StiffnessFit& fit) {
  if (fit.parameters.size() == 5) return block_entries(fit.parameters, 'k');
  const auto parameter = [&](const char* entry, const char* name, double value) {
    for (const Parameter& one : fit.parameters) {
      if (one.name != entry) continue;
      Parameter renamed = one;
      renamed.name = name;
      renamed.value = value;
      return renamed;
    }
    return Parameter{};
  };
  const model::CupElasticity& five = fit.elasticity;
  return block_entries({parameter("k_x_x", "k_lat", five.lateral), parameter("k_z_z", "k_ax", five.axial),
                        parameter("k_rx_rx", "k_bend", five.bend), parameter("k_rz_rz", "k_tors", five.torsion),
                        parameter("k_x_ry", "c", five.coupling)},
                       'k');
}

}  // namespace snug::identification
