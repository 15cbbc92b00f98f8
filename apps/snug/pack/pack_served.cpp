// pack_served: packs a plant that another program serves, scored by what its object sensors say.
#include "apps/snug/pack/pack.hpp"
#include "snug/core/input_error.hpp"
#include "snug/plant/sent_program.hpp"
#include "snug/remote_plant/remote_plant.hpp"
#include "snug/study/witness.hpp"

namespace snug::app {
namespace {

constexpr double kWhereItArrived = 0.05;  ///< m

/// Follows the boxes through what their sensors say: what was never seen away from where it came is waiting.
class Watcher {
 public:
  Watcher(const model::Scenario& scenario, const remote_plant::RemotePlant& plant)
      : container_(*model::find_container(scenario, scenario.target)), plant_(plant) {}

  study::TruePoses poses() {
    const auto boxes = plant_.boxes();
    study::TruePoses poses;
    arrived_.resize(boxes.size());
    has_left_.resize(boxes.size(), false);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      poses.push_back(boxes[i] ? std::optional<Pose>(boxes[i]->X_WP) : std::nullopt);
      if (!boxes[i]) continue;
      if (!arrived_[i]) arrived_[i] = boxes[i]->X_WP.p;
      has_left_[i] = has_left_[i] || (boxes[i]->X_WP.p - *arrived_[i]).norm() > kWhereItArrived;
    }
    return poses;
  }

  std::vector<cell::BoxResult> boxes(const std::vector<std::string>& items) {
    const study::TruePoses now = poses();
    std::vector<cell::BoxResult> results;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (!plant_.was_brought(i)) continue;
      cell::BoxResult box;
      box.id = items[i];
      if (has_left_[i]) box.state = now[i] ? cell::BoxState::Dropped : cell::BoxState::Lost;
      if (now[i]) {
        box.X_TP = container_.X_WT.inverse() * *now[i];
        const cell::ContainerFit fit = cell::fit_in(container_.inner_size, plant_.size_of(i), box.X_TP);
        if (fit.is_in) box.state = cell::BoxState::Packed;
      }
      results.push_back(std::move(box));
    }
    return results;
  }

 private:
  const model::Container& container_;
  const remote_plant::RemotePlant& plant_;
  std::vector<std::optional<Vector3>> arrived_;
  std::vector<bool> has_left_;
};

void expect_options_of_a_served_plant(const PackOptions& options, const session::SessionOptions& session) {
  const auto refuse = [](const char* option, const std::string& got, const char* expected) {
    throw InputError("command line", option, "'" + got + "'", expected);
  };
  if (!options.plant_set.empty()) {
    refuse("--plant-set", options.plant_set.front(), "nothing: a served cell is what `snug serve --set` says");
  }
  if (!options.fault.empty()) refuse("--fault", options.fault, "no faults: they are made in a simulated plant alone");
  if (options.record) refuse("-o", *options.record, "no recording here: `snug serve -o` records what it serves");
  if (session.simulation.robot.empty()) refuse("--robot", "none", "the scenario's robot: a served plant has one");
}

}  // namespace

study::Trial run_served_trial(const PackOptions& options, const model::Scenario& scenario,
                              const session::SessionOptions& session, const study::TrialProgress& progress,
                              OutputFile* program) {
  expect_options_of_a_served_plant(options, session);
  const perception::Kind kind = perception::kind_of(options.perception);
  remote_plant::RemotePlant plant(scenario, options.sequence,
                                  {options.plant, options.patience, kind, options.plant_seed, session.simulation,
                                   click::find_client_keys(options.keys)});
  Watcher watcher(scenario, plant);
  study::Witness witness;
  for (const model::Item& item : model::find_sequence(scenario, options.sequence)->items) {
    witness.items.push_back(item.parcel);
  }
  witness.poses = [&] { return watcher.poses(); };
  witness.size_of = [&](std::size_t item) { return plant.size_of(item); };
  witness.boxes = [&] { return watcher.boxes(witness.items); };
  std::optional<plant::SentProgram> sent;
  if (program != nullptr) sent.emplace(plant, *program, session.simulation.tracking);
  plant::Plant& packed = sent ? static_cast<plant::Plant&>(*sent) : plant;
  study::Trial trial = study::run_trial(scenario, options.sequence, session, packed, witness, progress);
  if (sent) sent->finish();
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
