// identify: numbers of the cup from measurements, with how well the data fix them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

/// What the parts of the verb share.
struct IdentifyOptions {
  std::optional<std::string> scenario;  ///< whose cup is the first guess; the default cup without
  std::optional<std::string> output;    ///< block for a scenario
  std::optional<double> position_noise, rotation_noise, force_noise, torque_noise;  ///< m, rad, N, Nm
  bool json = false;
};

struct IdentifyStiffnessOptions : IdentifyOptions {
  std::string input;
  std::string method = "compliance";
  std::optional<std::string> wrench;
  std::string parameters = "5";
};

struct IdentifyDampingOptions : IdentifyOptions {
  std::vector<std::string> inputs;
  std::string start = "auto";
  std::optional<std::uint64_t> release;  ///< only this one, from 0
  bool coupling = false;
  bool stiffness = false;
};

struct IdentifyPluckOptions : IdentifyOptions {
  std::string parcel;
  std::string direction = "axial";
  std::optional<double> amplitude;  ///< m or rad
  std::uint64_t repeat = 3;
  std::uint64_t seed = 1;
};

struct IdentifyPayloadOptions : IdentifyOptions {
  std::string input;
  std::optional<double> force_bias, torque_bias;  ///< N, Nm: what taring left
  bool rigid_lip = false;                         ///< the lip does not give
};

struct IdentifyReleaseOptions : IdentifyOptions {
  std::vector<std::string> inputs;
  bool evaluate = false;  ///< only what the cup of the scenario predicts
};

struct IdentifyPosesOptions {
  std::string input;
  std::optional<std::string> cup;     ///< the law that is evaluated
  std::optional<std::string> output;  ///< the law found
  bool evaluate = false;              ///< fit nothing
  bool json = false;
};

struct IdentifySceneOptions {
  std::string task;
  std::vector<std::string> recordings;                        ///< those of the task unless given
  bool floor = false;                                         ///< only the error that noise of the start sets
  bool evaluate = false;                                      ///< only the errors of the task's present values
  std::optional<std::uint64_t> global, local, scatter, seed;  ///< instead of the task's
  std::optional<std::string> log;                             ///< of points tried
  std::optional<std::string> output;                          ///< the task with the values found
  std::optional<std::string> scenario;                        ///< the scenario with the values found
  std::optional<std::string> page;                            ///< what was found and what it improved
  std::optional<int> threads;                                 ///< absent: all cores
  bool profile = false;                                       ///< intervals by the profile of the sum of squares
  bool json = false;
};

void add_identify(CLI::App& app, Action& action);
[[nodiscard]] int run_identify_stiffness(const IdentifyStiffnessOptions& options);
[[nodiscard]] int run_identify_damping(const IdentifyDampingOptions& options);
[[nodiscard]] int run_identify_release(const IdentifyReleaseOptions& options);
[[nodiscard]] int run_identify_poses(const IdentifyPosesOptions& options);
[[nodiscard]] int run_identify_scene(const IdentifySceneOptions& options);
[[nodiscard]] int run_identify_payload(const IdentifyPayloadOptions& options);
[[nodiscard]] int run_identify_pluck(const IdentifyPluckOptions& options);

}  // namespace snug::app
