// control: a program through the joints of a CLICK simulator, with snug's joint controller.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/program_motion.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct ControlOptions {
  std::string program;
  std::string endpoint = "tcp://127.0.0.1:5555";
  std::string scenario = "scenarios/box-demonstrator.yaml";  ///< arm, limits, gains, boxes
  std::optional<std::string> sequence;                       ///< whose boxes are brought, whose gain is used
  std::optional<std::string> robot;
  MotionWords motion;
  std::string corrections = "none";
  std::string object = {};
  std::string vacuum_event = "vacuum", blow_off_event = "blow_off";
  std::optional<std::string> keys;  ///< folder or file: who this is, and who is expected there
  double patience = 10.0;           ///< s, for an answer
  bool json = false;
};

void add_control(CLI::App& app, Action& action);
[[nodiscard]] int run_control(const ControlOptions& options);

}  // namespace snug::app
