// pack_served: packs a plant that another program serves, scored by what its object sensors say.
#include "apps/snug/pack/pack.hpp"
#include "snug/core/input_error.hpp"
#include "snug/remote_plant/remote_plant.hpp"
#include "snug/study/watched_boxes.hpp"

namespace snug::app {

void expect_options_of_a_served_plant(const PackOptions& options, const session::SessionOptions& session) {
  const auto refuse = [](const char* option, const std::string& got, const char* expected) {
    throw InputError("command line", option, "'" + got + "'", expected);
  };
  if (!options.plant_set.empty()) {
    refuse("--plant-set", options.plant_set.front(), "nothing: a served cell is what `snug serve --set` says");
  }
  if (!options.fault.empty()) refuse("--fault", options.fault, "no faults: they are made in a simulated plant alone");
  if (session.simulation.robot.empty()) refuse("--robot", "none", "the scenario's robot: a served plant has one");
}

study::Trial run_served_trial(const PackOptions& options, const model::Scenario& scenario,
                              const session::SessionOptions& session, const study::TrialProgress& progress,
                              const study::TrialFiles& files) {
  expect_options_of_a_served_plant(options, session);
  const perception::Kind kind = perception::kind_of(options.perception);
  remote_plant::RemotePlant plant(scenario, options.sequence,
                                  {options.plant, options.client.patience, kind, options.plant_seed, session.simulation,
                                   click::find_client_keys(options.client.keys), make_frames(options, scenario)});
  const study::Witness witness =
      study::watch_boxes(scenario, options.sequence,
                         {[&] { return plant.boxes(); }, [&](std::size_t item) { return plant.size_of(item); },
                          [&](std::size_t item) { return plant.was_brought(item); }});
  study::Trial trial = study::run_trial(scenario, options.sequence, session, plant, witness, progress, files);
  trial.is_elsewhere = true;
  trial.plant.perception = kind;
  trial.plant.simulation = session.simulation;
  std::string trouble = plant.finish();
  if (!trial.session.failure && !trouble.empty()) {
    trial.session.failure = {session::SessionFailureKind::PlantLost, std::move(trouble)};
  }
  return trial;
}

}  // namespace snug::app
