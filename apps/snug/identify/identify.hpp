// identify: numbers of the cup from measurements, with how well the data fix them.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"
#include "snug/identification/static_poses.hpp"

namespace snug::app {

/// What the parts of the verb share.
struct IdentifyOptions {
  std::optional<std::string> scenario;  ///< whose cup is the first guess; the default cup without
  std::optional<std::string> output;    ///< block for a scenario
  std::optional<double> position_noise, rotation_noise, force_noise, torque_noise;  ///< m, rad, N, Nm
  bool json = false;
};

/// The cup of --scenario, or the default one.
[[nodiscard]] model::CupParams cup_of(const IdentifyOptions& options);
/// What was said on the command line goes before what the file says.
void apply(const IdentifyOptions& options, identification::MeasurementNoise& noise, bool& is_given);

void add_identify_scenario(const Verb& part, IdentifyOptions& options);
void add_pose_noise(const Verb& part, IdentifyOptions& options);
void add_identify_result(const Verb& part, IdentifyOptions& options);

/// The parts of the verb.
void add_identify_stiffness(const Verb& verb);
void add_identify_damping(const Verb& verb);
void add_identify_pluck(const Verb& verb);
void add_identify_payload(const Verb& verb);
void add_identify_release(const Verb& verb);
void add_identify_poses(const Verb& verb);
void add_identify_scene(const Verb& verb);

}  // namespace snug::app
