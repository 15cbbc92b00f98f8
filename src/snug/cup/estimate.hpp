// estimate_cup: a starting cup from what a data sheet says, with ranges as wide as what is known.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/model/cup_params.hpp"
#include "snug/model/uncertainty.hpp"

namespace snug::cup {

enum class CupMaterial { Silicone, Nitrile, Polyurethane, NaturalRubber };
[[nodiscard]] const char* name_of(CupMaterial material);
enum class LipKind { Plain, Foam };
[[nodiscard]] const char* name_of(LipKind lip);

/// What a data sheet says.
struct CupSheet {
  double diameter = 0.040;  ///< m, of the lip, 0.005 .. 0.3
  double bellows = 1.5;     ///< folds: 0 (flat), 1.5 or 2.5
  CupMaterial material = CupMaterial::Silicone;
  LipKind lip = LipKind::Plain;
  double pressure_gauge = -6.0e4;                 ///< Pa, negative, of the hold
  std::optional<double> stroke = std::nullopt;    ///< m, free length less length under vacuum
  std::optional<double> mass_max = std::nullopt;  ///< kg, of the heaviest box
};

/// One number with the range in which it is expected, and why.
struct Estimate {
  std::string name;
  std::string unit;
  double low = 0.0, value = 0.0, high = 0.0;
  std::string source;
};

struct CupEstimate {
  model::CupParams cup;
  model::Uncertainty uncertainty;   ///< cup_stiffness, cup_length and release_push from the ranges
  std::vector<Estimate> estimates;  ///< of the numbers of `cup`
  Estimate pull_off, lateral;       ///< N, straight off the face and along it (dry cardboard), no safety factor
  /// Of mass_max: pull-off over its weight, hanging and held on its side; the low end of the range.
  std::optional<double> hanging_factor, side_factor;
};

/// Throws InputError for numbers that no cup has.
[[nodiscard]] CupEstimate estimate_cup(const CupSheet& sheet);

/// `cup` and `uncertainty` of a scenario, ranges and sources as comments.
[[nodiscard]] std::string format_estimate(const CupSheet& sheet, const CupEstimate& estimate);

/// Generic cups, by size: flat, 1.5 and 2.5 folds, silicone, without and with a foam lip.
[[nodiscard]] std::vector<CupSheet> cup_catalogue();

}  // namespace snug::cup
