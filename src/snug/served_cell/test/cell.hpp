// The demonstrator's cell with its robot, for the tests of this module.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "snug/served_cell/simulator.hpp"

namespace snug::served_cell::test {

inline const cell::Simulation& demonstrator_cell() {
  static const cell::Simulation simulation(
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml"), "1",
      {motion::LaggedTracking{}, cup::CupMode::Holding, "ur10"});
  return simulation;
}

inline const std::vector<double> kStill(6, 0.0);  ///< speeds of joints

inline click::Control control_of(const std::vector<double>& values, const click::Named<bool>& events = {}) {
  click::Control control;
  control.objects["ur10"] = {click::CommandList::Values, values, events};
  return control;
}

/// A simulator as one controller meets it.
struct Talk {
  explicit Talk(SimulatorSettings settings = {}) : simulator(demonstrator_cell(), std::move(settings)) {}
  click::Message say(const click::Message& message, const std::string& peer = "a") {
    return hear(click::encode(message), peer);
  }
  click::Message hear(const std::string& frame, const std::string& peer = "a") {
    const auto answer = simulator.answer(peer, frame);
    if (!answer) return click::Error{"(no answer)"};
    const auto decoded = click::decode(*answer);
    EXPECT_TRUE(decoded.has_value());
    return *decoded;
  }
  /// The text of the Error that must come.
  std::string error(const click::Message& message, const std::string& peer = "a") {
    const click::Message answer = say(message, peer);
    return std::holds_alternative<click::Error>(answer) ? std::get<click::Error>(answer).text
                                                        : "answered by " + std::string(name_of(answer));
  }
  Simulator simulator;
};

}  // namespace snug::served_cell::test
