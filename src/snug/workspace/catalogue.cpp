// Catalogue: containers, pallets and cups by name, to begin a cell with.
#include "snug/workspace/catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/workspace/arm_edit.hpp"

namespace snug::workspace {
namespace {

std::string sheet_key(const cup::CupSheet& sheet) {
  return fmt::format("{:g}-{:g}-{}", 1e3 * sheet.diameter, sheet.bellows, cup::name_of(sheet.lip));
}

}  // namespace

const std::vector<CatalogueContainer>& container_catalogue() {
  static constexpr std::string_view kWalls = "outer size of EN 13199-1, walls of 20 mm and a floor of 15 mm assumed";
  static const std::vector<CatalogueContainer> all = {
      {"Euro container 300 x 200 x 120", kWalls, false, 0.260, 0.160, 0.105},
      {"Euro container 400 x 300 x 120", kWalls, false, 0.360, 0.260, 0.105},
      {"Euro container 400 x 300 x 220", kWalls, false, 0.360, 0.260, 0.205},
      {"Euro container 400 x 300 x 320", kWalls, false, 0.360, 0.260, 0.305},
      {"Euro container 600 x 400 x 120", kWalls, false, 0.560, 0.360, 0.105},
      {"Euro container 600 x 400 x 220", kWalls, false, 0.560, 0.360, 0.205},
      {"Euro container 600 x 400 x 320", kWalls, false, 0.560, 0.360, 0.305},
      {"Euro container 800 x 600 x 320", kWalls, false, 0.760, 0.560, 0.305},
      {"EUR pallet 1200 x 800", "EN 13698-1", true, 1.200, 0.800, 0.0},
      {"Half pallet 800 x 600", "deck of the trade", true, 0.800, 0.600, 0.0},
      {"Quarter pallet 600 x 400", "deck of the trade", true, 0.600, 0.400, 0.0},
      {"Industrial pallet 1200 x 1000", "ISO 6780", true, 1.200, 1.000, 0.0},
  };
  return all;
}

std::string format_catalogue() {
  using Json = nlohmann::ordered_json;
  Json containers = Json::array(), cups = Json::array();
  for (const CatalogueContainer& one : container_catalogue()) {
    containers.push_back({{"name", one.name},
                          {"pallet", one.is_pallet},
                          {"inner_size_mm", {1e3 * one.length, 1e3 * one.width, 1e3 * one.height}},
                          {"source", one.source}});
  }
  for (const cup::CupSheet& sheet : cup::cup_catalogue()) {
    const cup::CupEstimate estimate = cup::estimate_cup(sheet);
    cups.push_back({{"key", sheet_key(sheet)},
                    {"diameter_mm", 1e3 * sheet.diameter},
                    {"bellows", sheet.bellows},
                    {"lip", cup::name_of(sheet.lip)},
                    {"pull_off_N", {estimate.pull_off.low, estimate.pull_off.value, estimate.pull_off.high}},
                    {"command", cup_command(sheet)}});
  }
  return Json{{"containers", std::move(containers)}, {"cups", std::move(cups)}}.dump();
}

cup::CupSheet find_cup(const std::string& key) {
  for (const cup::CupSheet& sheet : cup::cup_catalogue())
    if (sheet_key(sheet) == key) return sheet;
  throw InputError("request", "cup", "'" + printable(key, 60) + "'", "a cup of `snug cup catalogue`");
}

cup::CupSheet read_cup_sheet(double diameter_mm, double bellows, const std::string& material, const std::string& lip,
                             double vacuum_kPa, std::optional<double> stroke_mm) {
  static constexpr std::array kMaterials = {cup::CupMaterial::Silicone, cup::CupMaterial::Nitrile,
                                            cup::CupMaterial::Polyurethane, cup::CupMaterial::NaturalRubber};
  cup::CupSheet sheet;
  const auto* const found = std::ranges::find(kMaterials, material, [](auto one) { return cup::name_of(one); });
  if (found == kMaterials.end())
    throw InputError("request", "material", "'" + printable(material, 40) + "'",
                     "silicone, nitrile, polyurethane or natural-rubber");
  if (lip != "plain" && lip != "foam")
    throw InputError("request", "lip", "'" + printable(lip, 40) + "'", "plain or foam");
  sheet.diameter = 1e-3 * diameter_mm;
  sheet.bellows = bellows;
  sheet.material = *found;
  sheet.lip = lip == "foam" ? cup::LipKind::Foam : cup::LipKind::Plain;
  sheet.pressure_gauge = 1e3 * vacuum_kPa;
  if (stroke_mm) sheet.stroke = 1e-3 * *stroke_mm;
  return sheet;
}

std::string cup_command(const cup::CupSheet& sheet) {
  static const cup::CupSheet usual;
  std::string command =
      fmt::format("snug cup estimate --diameter {:g} --bellows {:g}", 1e3 * sheet.diameter, sheet.bellows);
  if (sheet.material != usual.material) command += fmt::format(" --material {}", cup::name_of(sheet.material));
  command += fmt::format(" --lip {}", cup::name_of(sheet.lip));
  if (sheet.pressure_gauge != usual.pressure_gauge)
    command += fmt::format(" --vacuum {:g}kPa", 1e-3 * sheet.pressure_gauge);
  if (sheet.stroke) command += fmt::format(" --stroke {:g}", 1e3 * *sheet.stroke);
  return command;
}

std::string put_cup(const std::string& text, const std::string& name, const cup::CupSheet& sheet) {
  const std::string block = find_block(cup::format_estimate(sheet, cup::estimate_cup(sheet)), "cup");
  const std::string comment = "  # " + cup_command(sheet) + ": an estimate to begin with\n";
  return replace_block(text, name, "cup", "cup:\n" + comment + block.substr(block.find('\n') + 1));
}

}  // namespace snug::workspace
