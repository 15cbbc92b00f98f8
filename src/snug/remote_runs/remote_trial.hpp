// remote_trial: a session in a plant of another program, or through a robot: opened by its address, scored by who looks
// on.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "snug/camera/frame_source.hpp"
#include "snug/study/trial.hpp"

namespace snug::remote_runs {

/// Which plant is packed, and how it is seen, as a person says it.
struct PlantChoice {
  std::string address = "simulated";  ///< or where one is: click://HOST:PORT, click+ipc://PATH, ur://HOST
  std::uint64_t seed = 1;             ///< of noise of its perception
  std::string perception = "exact";
  std::optional<std::string> keys = {};  ///< folder or file, by which this program is known there
  double patience = 10.0;                ///< s, for an answer
  // of --perception frames
  std::optional<std::string> frames = {};         ///< folder or command
  double frames_patience = 30.0;                  ///< s, for the frame of a perception
  std::optional<std::string> frames_camera = {};  ///< file that says what camera they are of
  std::optional<double> frames_unit = {};         ///< m
  // of ur://HOST
  std::optional<std::string> observe = {};  ///< CLICK address of who tells where boxes are
  bool is_dry = false;                      ///< a simulated plant is packed; the robot makes each motion first
  bool is_in_lockstep = false;              ///< a cell that is served, without a clock
  bool may_move = false;                    ///< a robot that is not on this machine
  double part_patience = 600.0;             ///< s, that a box may take to come to the aligner

  [[nodiscard]] bool is_served() const { return address != "simulated"; }
  [[nodiscard]] bool is_robot() const { return address.starts_with("ur://"); }
};

/// Throws InputError for what only a robot at ur://HOST has, of another plant.
void refuse_options_of_a_robot(const PlantChoice& plant);

/// Where frames come from with perception `frames`; empty without. Throws InputError where perception and source do not
/// go together, and where there is no such source.
[[nodiscard]] camera::FrameSource make_frames(const PlantChoice& plant, const model::Scenario& scenario,
                                              const std::function<bool()>& is_interrupted);

/// What is packed there, and who is told of it.
struct RemoteRun {
  const model::Scenario& scenario;
  const std::string& sequence;
  const session::SessionOptions& session;
  const study::TrialProgress& progress;
  const study::TrialFiles& files;
  std::function<void(const std::string&)> tell;  ///< a line of what went on besides
};

/// Packs the plant that is served at an address of CLICK, scored by its object sensors. Throws InputError where it
/// cannot be had.
[[nodiscard]] study::Trial run_served_trial(const PlantChoice& plant, const RemoteRun& run);
/// Packs through a controller of Universal Robots, scored by what its observer says, or makes each motion of a
/// simulated plant (`simulated`) with it first (dry run). Everything is compared before anything moves. As
/// run_served_trial else.
[[nodiscard]] study::Trial run_ur_trial(const PlantChoice& plant, const RemoteRun& run,
                                        const simulated_plant::SimulatedPlantOptions& simulated);

}  // namespace snug::remote_runs
