// cup estimate, cup catalogue: starting cups from data sheets.
#include <fmt/format.h>
#include <fmt/printf.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/cup/cup.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/estimate.hpp"

namespace snug::app {
namespace {

using nlohmann::ordered_json;

struct CupEstimateOptions {
  double diameter_mm = 0.0;
  double bellows = 1.5;
  std::string material = "silicone", lip = "plain";
  std::string vacuum = "-60kPa";
  std::optional<double> stroke_mm, mass_max;
  std::optional<std::string> output;
  bool json = false;
};

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

struct CatalogueOptions {
  bool json = false;
};

int run_cup_catalogue(const CatalogueOptions& options) {
  const bool json = options.json;
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

constexpr const char* kEstimateHelp =
    R"(Prints `cup` and `uncertainty` of a scenario, with the range of each number and where it comes from: an estimate to start
with. What holds and how the box tilts depends on it, filling hardly. Measure first what `snug identify` says is unknown.
Example:
  snug cup estimate --diameter 40 --bellows 1.5 --material silicone --lip foam --vacuum -60kPa --mass-max 5)";

}  // namespace

void add_cup_estimate(const Verb& verb) {
  const Verb part = verb.part("estimate", "a starting cup from a data sheet", kEstimateHelp);
  CupEstimateOptions& options = part.runs(run_cup_estimate);
  part.option("--diameter", options.diameter_mm, "MM", "of the lip", positive()).required();
  part.option("--bellows", options.bellows, "N", "folds: 0 (flat), 1.5 or 2.5");
  part.option("--material", options.material, "NAME", "of the cup",
              one_of({"silicone", "nitrile", "polyurethane", "natural-rubber"}));
  part.option("--lip", options.lip, "NAME", "what seals", one_of({"plain", "foam"}));
  part.option("--vacuum", options.vacuum, "PRESSURE",
              "gauge pressure of the hold, with its unit: kPa, mbar, bar or Pa");
  part.option("--stroke", options.stroke_mm, "MM", "free length less length under vacuum", finite());
  part.option("--mass-max", options.mass_max, "KG", "of the heaviest box: is it held?", positive());
  part.option("-o,--output", options.output, "FILE.yaml", "also write the block here");
  add_json(part, options.json);
}

void add_cup_catalogue(const Verb& verb) {
  const Verb part = verb.part("catalogue", "generic cups by size, at -60 kPa");
  add_json(part, part.runs(run_cup_catalogue).json);
}

}  // namespace snug::app
