// pack: packs a plant with a sequence, item by item, and says how that went.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/camera/frame_source.hpp"
#include "snug/study/trial.hpp"

namespace snug::app {

/// The words of `snug pack`.
struct PackOptions {
  std::string scenario;
  std::string sequence;
  ScenarioChanges changes;
  std::string agent = "contact-aware";
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> random_seed;  ///< the sequence is drawn: every box of the scenario, in random order
  double agent_patience = 600.0;             ///< s, for an answer of an agent in Python
  std::string plant = "simulated";           ///< or where one is: click://HOST:PORT, click+ipc://PATH, ur://HOST
  std::optional<std::string> observe;        ///< CLICK address of who tells where boxes are, of ur://HOST
  bool is_dry = false;                       ///< of ur://HOST
  bool is_in_lockstep = false;               ///< of ur://HOST: a cell that is served, without a clock
  bool may_move = false;                     ///< a robot that is not on this machine
  double part_patience = 600.0;              ///< s, that a box may take to come to the aligner of ur://HOST
  ClientWords client;
  std::uint64_t plant_seed = 1;
  double decision_time = packing::DecisionRun{}.time;  ///< s
  std::optional<int> threads;                          ///< absent: all cores
  int samples = session::SessionOptions{}.samples;
  std::optional<int> skips;
  std::string controller = "fast";  ///< or lagged
  std::optional<double> tempo;      ///< only with fast; absent: 1
  std::string future = "order";
  std::string perception = "exact";
  std::optional<std::string> frames;         ///< folder or command, of perception frames
  double frames_patience = 30.0;             ///< s, for the frame of a perception
  std::optional<std::string> frames_camera;  ///< file that says what camera they are of
  std::optional<double> frames_unit;         ///< m
  std::vector<std::string> plant_set;        ///< "KEY=VALUE", of the plant's scenario alone
  std::string fault;                         ///< "drop@3,noseal@5"
  std::optional<std::string> robot;          ///< absent: the scenario's, where its file is there; "none"
  std::optional<int> monte_carlo;
  std::optional<std::string> program, plan, record;
  std::optional<std::string> log;            ///< of events
  std::optional<std::string> live;           ///< frames for who watches; with `record`
  std::optional<std::string> resume;         ///< log of the session that is gone on with
  std::optional<std::string> operator_file;  ///< what who operates says; "-": standard input
  std::optional<std::string> save_beliefs;   ///< folder
  bool json = false;
};

/// What `pack` and `compare` have in common.
void add_packing_options(const Verb& verb, PackOptions& options);
/// Every box of the scenario in an order drawn by seed and name. Throws InputError where a sequence has this name.
[[nodiscard]] model::Sequence draw_order(const model::Scenario& scenario, const std::string& name, std::uint64_t seed);
[[nodiscard]] session::SessionOptions make_session_options(const PackOptions& options, const SourcedScenario& loaded);
/// Throws InputError for words that say nothing.
[[nodiscard]] simulated_plant::SimulatedPlantOptions make_plant_options(const PackOptions& options,
                                                                        const session::SessionOptions& session);
/// Packs the plant that is served at `options.plant`, scored by its object sensors. Throws InputError where it cannot
/// be had.
[[nodiscard]] study::Trial run_served_trial(const PackOptions& options, const model::Scenario& scenario,
                                            const session::SessionOptions& session,
                                            const study::TrialProgress& progress, const study::TrialFiles& files);
/// Throws InputError for options that only a simulated plant has.
void expect_options_of_a_served_plant(const PackOptions& options, const session::SessionOptions& session);
/// Packs through the controller of Universal Robots at `options.plant` (ur://HOST), scored by what its observer says,
/// or makes each motion of a simulated plant with it first (dry run). As run_served_trial else.
[[nodiscard]] study::Trial run_ur_trial(const PackOptions& options, const model::Scenario& scenario,
                                        const session::SessionOptions& session,
                                        const simulated_plant::SimulatedPlantOptions& plant,
                                        const study::TrialProgress& progress, const study::TrialFiles& files);
/// Where frames come from with --frames; empty without. Throws InputError where perception and source do not go
/// together, and where there is no such source.
[[nodiscard]] camera::FrameSource make_frames(const PackOptions& options, const model::Scenario& scenario);
/// What the recording of a plant says of how it was made. `address`: of a plant that is elsewhere.
[[nodiscard]] simulated_plant::LiveRecordingOptions recording_of(const simulated_plant::SimulatedPlantOptions& plant,
                                                                 const std::string& agent, OutputFile& file,
                                                                 const std::string& address = {});
/// A line on a terminal that is written over again, or nothing.
[[nodiscard]] study::TrialProgress make_progress_line(const std::string& label);

/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_pack(const PackOptions& options);

}  // namespace snug::app
