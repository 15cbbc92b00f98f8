// Field: how a settings struct lists its keys once, with the range each value must lie in.
#pragma once

namespace snug {

/// What values a number may take; checked when it is loaded and never again.
enum class Range {
  Any,          ///< any finite number
  Positive,     ///< > 0
  NotNegative,  ///< >= 0
  Fraction,     ///< 0 .. 1
};

/// Both ends included; checked when it is loaded and never again.
struct Within {
  double low = 0.0;
  double high = 0.0;
};

/// Marks an angle that is written in degrees (its key ends in `_deg`) and stored in radians.
struct Degrees {
  double& radians;
};

}  // namespace snug
