// Estimated cups as text, and the words of data sheets.
#include "snug/cup/estimate_text.hpp"

#include <fmt/printf.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"

namespace snug::cup {
namespace {

using nlohmann::ordered_json;

ordered_json estimate_json(const Estimate& one) {
  return {{"name", one.name}, {"value", one.value}, {"low", one.low},
          {"high", one.high}, {"unit", one.unit},   {"source", one.source}};
}

ordered_json describe_estimate(const CupEstimate& estimate) {
  ordered_json json = {{"pull_off_N", estimate_json(estimate.pull_off)},
                       {"lateral_N", estimate_json(estimate.lateral)},
                       {"parameters", ordered_json::array()}};
  for (const Estimate& one : estimate.estimates) json["parameters"].push_back(estimate_json(one));
  json["uncertainty"] = {{"cup_stiffness", estimate.uncertainty.cup_stiffness},
                         {"cup_length", estimate.uncertainty.cup_length},
                         {"release_push", estimate.uncertainty.release_push}};
  if (estimate.hanging_factor) json["hanging_factor"] = *estimate.hanging_factor;
  if (estimate.side_factor) json["side_factor"] = *estimate.side_factor;
  return json;
}

}  // namespace

double parse_gauge_pressure(const std::string& text, const std::string& option) {
  constexpr const char* kExpected = "a gauge pressure with its unit, such as -60kPa, -600mbar, -0.6bar or -60000Pa";
  std::size_t end = 0;
  double number = 0.0;
  try {
    number = std::stod(text, &end);
  } catch (const std::exception&) {
    throw InputError("command line", option, "'" + text + "'", kExpected);
  }
  while (end < text.size() && text[end] == ' ') ++end;
  const std::string unit = text.substr(end);
  for (const auto& [name, pascal] : {std::pair{"kPa", 1e3}, {"mbar", 1e2}, {"bar", 1e5}, {"Pa", 1.0}})
    if (unit == name && std::isfinite(number)) return number * pascal;
  throw InputError("command line", option, "'" + text + "'", kExpected);
}

CupMaterial cup_material_of(const std::string& name) {
  for (const CupMaterial material :
       {CupMaterial::Silicone, CupMaterial::Nitrile, CupMaterial::Polyurethane, CupMaterial::NaturalRubber})
    if (name == name_of(material)) return material;
  SNUG_CHECK(false, "a material that there is not");
  return CupMaterial::Silicone;
}

std::string format_json(const CupEstimate& estimate) { return describe_estimate(estimate).dump(2) + "\n"; }

std::string format_catalogue_table() {
  std::string text =
      "diameter  folds  lip    pull-off, N          lateral, N           stroke, mm  axial stiffness, N/m\n";
  for (const CupSheet& sheet : cup_catalogue()) {
    const CupEstimate estimate = estimate_cup(sheet);
    text += fmt::sprintf("%5.0f mm  %5.1f  %-5s  %5.1f (%5.1f-%5.1f)  %5.1f (%5.1f-%5.1f)  %10.1f  %20.0f\n",
                         1e3 * sheet.diameter, sheet.bellows, name_of(sheet.lip), estimate.pull_off.value,
                         estimate.pull_off.low, estimate.pull_off.high, estimate.lateral.value, estimate.lateral.low,
                         estimate.lateral.high, 1e3 * (estimate.cup.free_length - estimate.cup.hold_length),
                         estimate.cup.stiffness.axial);
  }
  return text;
}

std::string format_catalogue_json() {
  ordered_json list = ordered_json::array();
  for (const CupSheet& sheet : cup_catalogue()) {
    list.push_back(describe_estimate(estimate_cup(sheet)));
    list.back()["diameter_mm"] = 1e3 * sheet.diameter;
    list.back()["bellows"] = sheet.bellows;
    list.back()["lip"] = name_of(sheet.lip);
  }
  return list.dump(2) + "\n";
}

}  // namespace snug::cup
