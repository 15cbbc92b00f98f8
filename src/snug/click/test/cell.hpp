// The demonstrator's cell with its robot, for the tests of this module.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "snug/click/simulator.hpp"

namespace snug::click::test {

inline const cell::Simulation& demonstrator_cell() {
  static const cell::Simulation simulation(
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml"), "1",
      {motion::ControllerKind::Faithful, cup::CupMode::Holding, "ur10"});
  return simulation;
}

inline const std::vector<double> kStill(6, 0.0);  ///< speeds of joints

inline Control control_of(const std::vector<double>& values, const Named<bool>& events = {}) {
  Control control;
  control.objects["ur10"] = {CommandList::Values, values, events};
  return control;
}

/// A simulator as one controller meets it.
struct Talk {
  explicit Talk(SimulatorSettings settings = {}) : simulator(demonstrator_cell(), std::move(settings)) {}
  Message say(const Message& message, const std::string& peer = "a") { return hear(encode(message), peer); }
  Message hear(const std::string& frame, const std::string& peer = "a") {
    const auto answer = simulator.answer(peer, frame);
    if (!answer) return Error{"(no answer)"};
    const auto decoded = decode(*answer);
    EXPECT_TRUE(decoded.has_value());
    return *decoded;
  }
  /// The text of the Error that must come.
  std::string error(const Message& message, const std::string& peer = "a") {
    const Message answer = say(message, peer);
    return std::holds_alternative<Error>(answer) ? std::get<Error>(answer).text
                                                 : "answered by " + std::string(name_of(answer));
  }
  Simulator simulator;
};

}  // namespace snug::click::test
