// What was found of a cup's release and of laws from many poses as text: JSON for programs, lines for people.
#pragma once

#include <string>

#include "snug/identification/cup_poses.hpp"
#include "snug/identification/release_fit.hpp"

namespace snug::identification {

/// The keys are those of docs/identification.md.
[[nodiscard]] std::string format_json(const ReleaseErrors& errors);
[[nodiscard]] std::string format_json(const CupReleaseFit& fit);
/// `about`: what predicted, "the scenario's cup".
[[nodiscard]] std::string format_text(const ReleaseErrors& errors, const std::string& about);
[[nodiscard]] std::string format_text(const CupReleaseFit& fit);

/// "this law explains these data", or by which components not.
[[nodiscard]] std::string verdict_of(const PoseErrors& errors);
[[nodiscard]] std::string format_json(const PoseErrors& errors);
[[nodiscard]] std::string format_json(const PoseFit& fit);
[[nodiscard]] std::string format_text(const PoseErrors& errors, const std::string& about);
[[nodiscard]] std::string format_text(const PoseFit& fit);

}  // namespace snug::identification
