// estimate_cup: scaling from one measured cup, ring relations, and pressure times area.
#include "snug/cup/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/input_error.hpp"

namespace snug::cup {
namespace {

constexpr double kEstimateGravity = 9.81;

/// The one cup with a measured stiffness: 70 mm, static extension of ten masses 6.81 kN/m, growth of 30 mm, from
/// recorded releases (docs/decisions/0067).
constexpr double kMeasuredDiameter = 0.070, kMeasuredStiffness = 6.8e3, kMeasuredOpenRatio = 0.11;

/// By folds: shares of the diameter.
struct FoldKind {
  double folds;
  double area_low, area, area_high;        // effective over lip diameter
  double stroke_low, stroke, stroke_high;  // over lip diameter
  double free_length;                      // over lip diameter
  double stiffness;                        // of the measured one, at its size
};
constexpr FoldKind kFoldKinds[] = {
    {0.0, 0.80, 0.88, 1.00, 0.02, 0.05, 0.10, 0.45, 3.0},
    {1.5, 0.70, 0.80, 1.00, 0.15, 0.25, 0.35, 0.70, 1.5},
    {2.5, 0.70, 0.80, 1.00, 0.30, 0.42, 0.50, 1.05, 1.0},
};

const FoldKind& fold_kind(double folds) {
  for (const FoldKind& kind : kFoldKinds)
    if (kind.folds == folds) return kind;
  throw InputError("cup estimate", "bellows", fmt::format("{:g}", folds), "0 (flat), 1.5 or 2.5 folds");
}

/// Stiffness over that of silicone of the same shape, assumed by hardness (Shore A 50 to 60, polyurethane 60 to 70).
double hardness(CupMaterial material) {
  switch (material) {
    case CupMaterial::Silicone:
      return 1.0;
    case CupMaterial::NaturalRubber:
      return 0.9;
    case CupMaterial::Nitrile:
      return 1.2;
    case CupMaterial::Polyurethane:
      return 1.6;
  }
  return 1.0;
}

void check_sheet(const CupSheet& sheet) {
  constexpr const char* kWhere = "cup estimate";
  require_number(sheet.diameter >= 0.005 && sheet.diameter <= 0.3, kWhere, "diameter", 1e3 * sheet.diameter,
                 "5 to 300 mm");
  require_number(sheet.pressure_gauge < -1e3 && sheet.pressure_gauge > -1.01e5, kWhere, "vacuum", sheet.pressure_gauge,
                 "a gauge pressure between -101 and -1 kPa");
  if (sheet.stroke)
    require_number(*sheet.stroke >= 0.0 && *sheet.stroke <= sheet.diameter, kWhere, "stroke", 1e3 * *sheet.stroke,
                   "0 mm up to the diameter");
  if (sheet.mass_max)
    require_number(*sheet.mass_max > 0.0 && *sheet.mass_max <= 1e3, kWhere, "mass-max", *sheet.mass_max,
                   "a mass in kg, above 0");
}

Estimate times(std::string name, std::string unit, double value, double factor, std::string source) {
  return {std::move(name), std::move(unit), value / factor, value, value * factor, std::move(source)};
}

/// Lengths, areas and what the vacuum holds.
void estimate_sizes(const CupSheet& sheet, const FoldKind& kind, CupEstimate& estimate) {
  model::CupParams& cup = estimate.cup;
  const double d = sheet.diameter, foam = sheet.lip == LipKind::Foam ? 0.08 * d : 0.0;
  const Estimate stroke =
      sheet.stroke ? Estimate{"stroke", "m", 0.8 * *sheet.stroke, *sheet.stroke, 1.2 * *sheet.stroke, "as given"}
                   : Estimate{"stroke",
                              "m",
                              kind.stroke_low * d,
                              kind.stroke * d + 0.5 * foam,
                              kind.stroke_high * d + foam,
                              "assumed for this many folds"};
  cup.free_length = std::max(kind.free_length * d + foam, stroke.value + 0.1 * d);
  cup.hold_length = cup.free_length - stroke.value;
  cup.centre_from_lip = 0.5 * cup.hold_length;
  cup.lip_radius = 0.5 * d;
  cup.effective_diameter = kind.area * d;
  cup.lip_friction = 0.5;
  cup.vacuum.pressure_gauge_hold = sheet.pressure_gauge;
  cup.vacuum.pressure_gauge_collapse = std::max(-1.2e4, sheet.pressure_gauge);
  cup.release.pressure_gauge_start = std::max(cup.release.pressure_gauge_start, sheet.pressure_gauge);
  cup.vacuum.bellows_area = 0.25 * std::numbers::pi * std::pow(kind.area * d, 2);
  cup.seal.reach = 0.1 * d;
  cup.seal.max_overhang = sheet.lip == LipKind::Foam ? 0.2 * d : 0.05 * d;
  const std::string maker = "assumed: from the inner rim of the lip to the whole lip";
  const auto force = [&](double share) {
    return -sheet.pressure_gauge * 0.25 * std::numbers::pi * std::pow(share * d, 2);
  };
  const Estimate friction{"lip_friction", "-", 0.4, 0.5, 0.7, "assumed of dry cardboard"};
  estimate.pull_off = {"pull_off",       "N", force(kind.area_low), force(kind.area), force(kind.area_high),
                       "pressure x area"};
  estimate.lateral = {"lateral",
                      "N",
                      friction.low * estimate.pull_off.low,
                      friction.value * estimate.pull_off.value,
                      friction.high * estimate.pull_off.high,
                      "friction x pull-off"};
  estimate.estimates = {{"free_length", "m", 0.8 * cup.free_length, cup.free_length, 1.2 * cup.free_length,
                         "assumed for this many folds"},
                        stroke,
                        {"effective_diameter", "m", kind.area_low * d, kind.area * d, kind.area_high * d, maker},
                        friction};
}

void estimate_stiffness(const CupSheet& sheet, const FoldKind& kind, CupEstimate& estimate) {
  model::CupParams& cup = estimate.cup;
  const double radius = 0.4 * sheet.diameter, size = sheet.diameter / kMeasuredDiameter;
  const double axial =
      kMeasuredStiffness * size * kind.stiffness * hardness(sheet.material) * (sheet.lip == LipKind::Foam ? 1.0 : 1.2);
  const double lateral = 0.4 * axial;
  // Rings of this radius: bend = axial R^2 / 2, torsion = lateral R^2.
  cup.stiffness = {lateral, axial, 0.5 * axial * radius * radius, lateral * radius * radius, 0.0};
  // Damping of the measured cup, in proportion to stiffness: the same time constants.
  const double share = axial / kMeasuredStiffness;
  cup.damping = {10.0 * share, 16.0 * share, 0.04 * share * size * size, 0.025 * share * size * size, 0.0};
  cup.free_stiffness_ratio = kMeasuredOpenRatio;
  cup.release_push = 1.0;
  const std::string scaled = "one measured cup of 70 mm, by size, folds and hardness", ring = "ring relation";
  estimate.estimates.push_back(times("stiffness.axial", "N/m", axial, 2.5, scaled));
  estimate.estimates.push_back(times("stiffness.lateral", "N/m", lateral, 3.0, "0.4 of the axial one"));
  estimate.estimates.push_back(times("stiffness.bend", "Nm/rad", cup.stiffness.bend, 3.0, ring));
  estimate.estimates.push_back(times("stiffness.torsion", "Nm/rad", cup.stiffness.torsion, 3.0, ring));
  estimate.estimates.push_back(times("damping.axial", "Ns/m", cup.damping.axial, 3.0, scaled));
  estimate.estimates.push_back(times("free_stiffness_ratio", "-", cup.free_stiffness_ratio, 3.0, scaled));
}

}  // namespace

const char* name_of(CupMaterial material) {
  switch (material) {
    case CupMaterial::Silicone:
      return "silicone";
    case CupMaterial::Nitrile:
      return "nitrile";
    case CupMaterial::Polyurethane:
      return "polyurethane";
    case CupMaterial::NaturalRubber:
      return "natural-rubber";
  }
  return "";
}

const char* name_of(LipKind lip) { return lip == LipKind::Foam ? "foam" : "plain"; }

CupEstimate estimate_cup(const CupSheet& sheet) {
  check_sheet(sheet);
  const FoldKind& kind = fold_kind(sheet.bellows);
  CupEstimate estimate;
  estimate_sizes(sheet, kind, estimate);
  estimate_stiffness(sheet, kind, estimate);
  // Draws are uniform and a share: from 0.4 to 1.6 of the value, the most of a factor of 2.5 that they can be.
  estimate.uncertainty.cup_stiffness = 0.6;
  estimate.uncertainty.cup_length = 0.2 * estimate.cup.hold_length;
  estimate.uncertainty.release_push = 1.0;
  if (sheet.mass_max) {
    const double weight = *sheet.mass_max * kEstimateGravity;
    estimate.hanging_factor = estimate.pull_off.low / weight;
    estimate.side_factor = estimate.lateral.low / weight;
  }
  return estimate;
}

std::string format_estimate(const CupSheet& sheet, const CupEstimate& estimate) {
  const model::CupParams& cup = estimate.cup;
  std::string text = fmt::format(
      "# A starting cup: {:g} mm, {:g} folds, {}, {} lip, {:g} kPa. Estimated, not measured: measure what matters "
      "first\n"
      "# (docs/identification.md). Filling hardly depends on these numbers; holding, tilt and cycle do.\n",
      1e3 * sheet.diameter, sheet.bellows, name_of(sheet.material), name_of(sheet.lip), 1e-3 * sheet.pressure_gauge);
  for (const Estimate* force : {&estimate.pull_off, &estimate.lateral})
    text += fmt::format("# {}: {:.3g} N, {:.3g} to {:.3g} ({})\n", force == &estimate.pull_off ? "Pull-off" : "Lateral",
                        force->value, force->low, force->high, force->source);
  if (estimate.hanging_factor)
    text += fmt::format(
        "# {:g} kg: the low end holds {:.2g} times its weight hanging, {:.2g} times on its side (usual "
        "safety factors: 2 and 4)\n",
        *sheet.mass_max, *estimate.hanging_factor, *estimate.side_factor);
  for (const Estimate& one : estimate.estimates)
    text += fmt::format("#   {:<21} {:>9.4g} {:<7} {:.3g} to {:.3g}: {}\n", one.name, one.value, one.unit, one.low,
                        one.high, one.source);
  const auto elasticity = [](const model::CupElasticity& e) {
    return fmt::format("{{lateral: {:.4g}, axial: {:.4g}, bend: {:.4g}, torsion: {:.4g}, coupling: 0.0}}", e.lateral,
                       e.axial, e.bend, e.torsion);
  };
  text += fmt::format(
      "cup:\n  stiffness: {}\n  damping: {}\n  hold_length: {:.4g}\n  free_length: {:.4g}\n  centre_from_lip: {:.4g}\n"
      "  free_stiffness_ratio: {:.4g}\n  release_push: {:.4g}\n  lip_radius: {:.4g}\n  effective_diameter: {:.4g}\n"
      "  lip_friction: {:.4g}\n",
      elasticity(cup.stiffness), elasticity(cup.damping), cup.hold_length, cup.free_length, cup.centre_from_lip,
      cup.free_stiffness_ratio, cup.release_push, cup.lip_radius, cup.effective_diameter, cup.lip_friction);
  text += fmt::format(
      "  vacuum: {{pressure_gauge_hold: {:.6g}, pressure_gauge_collapse: {:.6g}, bellows_area: {:.4g}}}\n"
      "  seal: {{reach: {:.4g}, max_overhang: {:.4g}}}\n",
      cup.vacuum.pressure_gauge_hold, cup.vacuum.pressure_gauge_collapse, cup.vacuum.bellows_area, cup.seal.reach,
      cup.seal.max_overhang);
  return text + fmt::format("uncertainty: {{cup_stiffness: {:.3g}, cup_length: {:.3g}, release_push: {:.3g}}}\n",
                            estimate.uncertainty.cup_stiffness, estimate.uncertainty.cup_length,
                            estimate.uncertainty.release_push);
}

std::vector<CupSheet> cup_catalogue() {
  std::vector<CupSheet> cups;
  for (const LipKind lip : {LipKind::Plain, LipKind::Foam})
    for (const FoldKind& kind : kFoldKinds)
      for (const double diameter : {0.02, 0.03, 0.04, 0.05, 0.06, 0.08})
        cups.push_back({.diameter = diameter, .bellows = kind.folds, .lip = lip});
  return cups;
}

}  // namespace snug::cup
