// identify payload: mass and centre of mass of a held box from one lift.
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/payload_file.hpp"

namespace snug::app {
namespace {

struct IdentifyPayloadOptions : IdentifyOptions {
  std::string input;
  std::optional<double> force_bias, torque_bias;  ///< N, Nm: what taring left
  bool rigid_lip = false;                         ///< the lip does not give
};

int run_identify_payload(const IdentifyPayloadOptions& options) {
  const model::CupParams cup = cup_of(options);
  identification::PayloadSettings settings;
  settings.K = cup::as_matrix(cup.stiffness);
  settings.frames = identification::frames_of(cup);
  bool is_given = false;
  apply(options, settings.noise, is_given);
  if (options.force_bias) settings.force_bias = *options.force_bias;
  if (options.torque_bias) settings.torque_bias = *options.torque_bias;
  std::vector<identification::PayloadSample> lift = identification::load_lift(options.input);
  if (options.rigid_lip) lift = identification::with_rigid_lip(std::move(lift), settings.frames);
  identification::PayloadEstimator estimator(settings);
  for (const identification::PayloadSample& sample : lift) estimator.add(sample);
  const identification::PayloadEstimate estimate = estimator.estimate();
  print(options.json ? identification::format_payload_json(estimate) : identification::format_payload_table(estimate));
  return kSuccess;
}

constexpr const char* kPayloadHelp =
    R"(A lift of 1.5 s determines the mass to 2 % and the centre of mass to 5 mm, if the motion excites it: a lift straight up does
not determine the centre along the weight. Columns of the table: t, x, y, z, qw, qx, qy, qz (the gripper's end in the world),
fx, fy, fz, tx, ty, tz (of the cup on the box, in the gripper's frame about its end: up for a hanging box), perhaps lip_x ..
lip_qz. The stiffness of the cup in --scenario gives the place of the lip under the wrench; with --rigid-lip it is the unloaded place.
Example:
  snug identify payload scenarios/examples/lift.csv --rigid-lip --json)";

}  // namespace

void add_identify_payload(const Verb& verb) {
  const Verb part = verb.part("payload", "estimate mass and centre of mass of a held box from one lift", kPayloadHelp);
  IdentifyPayloadOptions& options = part.runs(run_identify_payload);
  part.option("lift", options.input, "LIFT.csv", "what sensor and joints recorded").required();
  part.option("--scenario", options.scenario, "SCENARIO.yaml",
              "scenario with the cup that holds the box (default: the cup that scenarios have by default)");
  part.flag("--rigid-lip", options.rigid_lip, "the lip is rigid, as of a hard gripper");
  const auto deviation = [&](const char* name, std::optional<double>& field, const char* what, const char* unit) {
    part.option(name, field, unit, what, positive());
  };
  deviation("--force-noise", options.force_noise, "deviation of a force reading; default 0.3", "N");
  deviation("--torque-noise", options.torque_noise, "deviation of a torque reading; default 0.02", "NM");
  deviation("--position-noise", options.position_noise, "deviation of the lip's position; default 0.0002", "M");
  deviation("--rotation-noise", options.rotation_noise, "deviation of the lip's rotation; default 0.004", "RAD");
  deviation("--force-bias", options.force_bias, "deviation of the force bias; default 0.015", "N");
  deviation("--torque-bias", options.torque_bias, "deviation of the torque bias; default 0.001", "NM");
  add_json(part, options.json);
}

}  // namespace snug::app
