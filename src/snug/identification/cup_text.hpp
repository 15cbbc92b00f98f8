// What was identified of a cup as text: JSON for programs, a table for people.
#pragma once

#include <string>

#include "snug/identification/damping.hpp"
#include "snug/identification/stiffness.hpp"

namespace snug::identification {

/// `noise_is_given`: with the measurements; else that of the demonstrator's sensors was assumed. Keys:
/// docs/identification.md.
[[nodiscard]] std::string format_json(const StiffnessFit& fit, const HeldBackError& held_back, bool noise_is_given);
[[nodiscard]] std::string format_table(const StiffnessFit& fit, const HeldBackError& held_back, bool noise_is_given);
[[nodiscard]] std::string format_json(const DampingFit& fit, const HeldBackError& held_back, bool noise_is_given);
[[nodiscard]] std::string format_table(const DampingFit& fit, const HeldBackError& held_back, bool noise_is_given);

}  // namespace snug::identification
