// Parameter: a number found from measurements, how well they fix it, and what to record when they do not.
#pragma once

#include <string>
#include <vector>

namespace snug::identification {

enum class Verdict {
  Identified,       ///< standard error below 5 % of the parameter's scale
  Weak,             ///< below 25 %
  NotIdentifiable,  ///< these data hardly know it
};
[[nodiscard]] const char* name_of(Verdict verdict);

struct Parameter {
  std::string name;  ///< k_lat, d_bend, ...
  double value = 0.0;
  double standard_error = 0.0;
  std::string unit;
  Verdict verdict = Verdict::NotIdentifiable;
  std::string advice;  ///< what to record instead; empty when identified
  bool operator==(const Parameter&) const = default;
};

/// chi2 per degree of freedom from which nothing is called identified, and from which nothing is known: the model, with
/// the noise declared, does not explain the data.
inline constexpr double kExplained = 1.5, kMisfit = 4.0;

/// By the standard error relative to `scale`, the size that the parameter matters against.
[[nodiscard]] Verdict judge(double standard_error, double scale);

/// What a fit misses on data that were kept out of it.
struct HeldBackError {
  double relative = 0.0;  ///< root mean square in units of the noise declared: 1 when only noise is left
  double position = 0.0;  ///< m, root mean square of the lip's predicted place
  double rotation = 0.0;  ///< rad, of its orientation
  bool operator==(const HeldBackError&) const = default;
};

}  // namespace snug::identification
