// identify payload: mass and centre of mass of a held box from one lift.
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/payload_file.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {

int run_identify_payload(const IdentifyPayloadOptions& options) {
  const model::CupParams cup =
      options.scenario ? model::load_scenario(find_scenario(*options.scenario)).cup : model::CupParams{};
  identification::PayloadSettings settings;
  settings.K = cup::as_matrix(cup.stiffness);
  settings.frames = identification::frames_of(cup);
  if (options.position_noise) settings.noise.position = *options.position_noise;
  if (options.rotation_noise) settings.noise.rotation = *options.rotation_noise;
  if (options.force_noise) settings.noise.force = *options.force_noise;
  if (options.torque_noise) settings.noise.torque = *options.torque_noise;
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

}  // namespace snug::app
