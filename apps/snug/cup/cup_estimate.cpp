// cup estimate, cup catalogue: starting cups from data sheets.
#include <fmt/format.h>
#include <fmt/printf.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/cup/cup.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/estimate.hpp"

namespace snug::app {
namespace {

using nlohmann::ordered_json;

/// "-60kPa" in Pa.
double pressure_of(const std::string& text) {
  constexpr const char* kExpected = "a gauge pressure with its unit, such as -60kPa, -600mbar, -0.6bar or -60000Pa";
  std::size_t end = 0;
  double number = 0.0;
  try {
    number = std::stod(text, &end);
  } catch (const std::exception&) {
    throw InputError("command line", "--vacuum", "'" + text + "'", kExpected);
  }
  while (end < text.size() && text[end] == ' ') ++end;
  const std::string unit = text.substr(end);
  for (const auto& [name, pascal] : {std::pair{"kPa", 1e3}, {"mbar", 1e2}, {"bar", 1e5}, {"Pa", 1.0}})
    if (unit == name && std::isfinite(number)) return number * pascal;
  throw InputError("command line", "--vacuum", "'" + text + "'", kExpected);
}

cup::CupSheet sheet_of(const CupEstimateOptions& options) {
  cup::CupSheet sheet;
  sheet.diameter = 1e-3 * options.diameter_mm;
  sheet.bellows = options.bellows;
  for (const cup::CupMaterial material : {cup::CupMaterial::Silicone, cup::CupMaterial::Nitrile,
                                          cup::CupMaterial::Polyurethane, cup::CupMaterial::NaturalRubber})
    if (options.material == cup::name_of(material)) sheet.material = material;
  sheet.lip = options.lip == "foam" ? cup::LipKind::Foam : cup::LipKind::Plain;
  sheet.pressure_gauge = pressure_of(options.vacuum);
  if (options.stroke_mm) sheet.stroke = 1e-3 * *options.stroke_mm;
  sheet.mass_max = options.mass_max;
  return sheet;
}

ordered_json estimate_json(const cup::Estimate& one) {
  return {{"name", one.name}, {"value", one.value}, {"low", one.low},
          {"high", one.high}, {"unit", one.unit},   {"source", one.source}};
}

ordered_json as_json(const cup::CupEstimate& estimate) {
  ordered_json json = {{"pull_off_N", estimate_json(estimate.pull_off)},
                       {"lateral_N", estimate_json(estimate.lateral)},
                       {"parameters", ordered_json::array()}};
  for (const cup::Estimate& one : estimate.estimates) json["parameters"].push_back(estimate_json(one));
  json["uncertainty"] = {{"cup_stiffness", estimate.uncertainty.cup_stiffness},
                         {"cup_length", estimate.uncertainty.cup_length},
                         {"release_push", estimate.uncertainty.release_push}};
  if (estimate.hanging_factor) json["hanging_factor"] = *estimate.hanging_factor;
  if (estimate.side_factor) json["side_factor"] = *estimate.side_factor;
  return json;
}

}  // namespace

int run_cup_estimate(const CupEstimateOptions& options) {
  const cup::CupSheet sheet = sheet_of(options);
  const cup::CupEstimate estimate = cup::estimate_cup(sheet);
  const std::string block = cup::format_estimate(sheet, estimate);
  NamedFiles inputs;
  std::optional<OutputFile> output = reserve(inputs, options.output);
  if (output) write_file(std::move(*output), block);
  print(options.json ? as_json(estimate).dump(2) + "\n" : block);
  return kSuccess;
}

int run_cup_catalogue(bool json) {
  ordered_json list = ordered_json::array();
  if (!json)
    print("diameter  folds  lip    pull-off, N          lateral, N           stroke, mm  axial stiffness, N/m\n");
  for (const cup::CupSheet& sheet : cup::cup_catalogue()) {
    const cup::CupEstimate estimate = cup::estimate_cup(sheet);
    if (json) {
      list.push_back(as_json(estimate));
      list.back()["diameter_mm"] = 1e3 * sheet.diameter;
      list.back()["bellows"] = sheet.bellows;
      list.back()["lip"] = cup::name_of(sheet.lip);
      continue;
    }
    print(fmt::sprintf("%5.0f mm  %5.1f  %-5s  %5.1f (%5.1f-%5.1f)  %5.1f (%5.1f-%5.1f)  %10.1f  %20.0f\n",
                       1e3 * sheet.diameter, sheet.bellows, cup::name_of(sheet.lip), estimate.pull_off.value,
                       estimate.pull_off.low, estimate.pull_off.high, estimate.lateral.value, estimate.lateral.low,
                       estimate.lateral.high, 1e3 * (estimate.cup.free_length - estimate.cup.hold_length),
                       estimate.cup.stiffness.axial));
  }
  if (json) print(list.dump(2) + "\n");
  return kSuccess;
}

}  // namespace snug::app
