// Page: a validation for people and programs: one HTML file, SVG figures, JSON, CSV.
#pragma once

#include <string>
#include <vector>

#include "snug/report/figure.hpp"
#include "snug/validation/validate.hpp"

namespace snug::validation {

/// A figure and the file name (without folder) that it is saved by.
struct NamedFigure {
  std::string file;     ///< "Box016-poses.svg"
  std::string caption;  ///< for people
  report::Figure figure;
};

/// Poses (like the report's Figures 15 and 16) and wrenches (17 and 18) of each window: simulated and measured, all
/// repetitions, with the errors below. One figure of each kind for each box, or for each key moment.
[[nodiscard]] std::vector<NamedFigure> make_figures(const SimulatedRun& run, const Validation& validation,
                                                    bool for_moments);

/// The five tables and the figures of the key moments as one page that needs nothing else.
[[nodiscard]] std::string make_page(const SimulatedRun& run, const Validation& validation);

/// All figures of the validation, docs/formats.md; numbers that were not measured are null.
[[nodiscard]] std::string as_json(const Validation& validation);

/// One row for each box, repetition and form; empty cells for what was not measured.
[[nodiscard]] std::string as_csv(const Validation& validation);

/// The tables as lines of text.
[[nodiscard]] std::string as_text(const Validation& validation);

}  // namespace snug::validation
