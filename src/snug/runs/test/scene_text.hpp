// Scenes as text for the tests of this module: bodies on a floor, and what becomes of them.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/runs/run.hpp"

namespace snug::runs::test {

inline constexpr double kGravity = 9.81;  ///< m/s^2, of every scene here

/// Writes a file into the folder and says where it is.
inline std::filesystem::path write(const snug::test::ScratchFolder& folder, const std::string& name,
                                   const std::string& text) {
  std::ofstream(folder / name) << text;
  return folder / name;
}

/// Bodies on a floor whose top is z = 0; `more` are further keys of the scenario.
inline std::string scene_text(double duration, const std::string& bodies, const std::string& contact,
                              const std::string& more = "") {
  return fmt::format(R"(
name: test
duration: {}
{}
materials: [{{name: m}}]
contacts: {{default: {}}}
bodies:
- {{name: floor, kind: static, size: [20, 20, 1], material: m, pose: {{position: [0, 0, -0.5]}}}}
{})",
                     duration, more, contact, bodies);
}

inline model::Scenario scene(double duration, const std::string& bodies,
                             const std::string& contact = "{friction: 0.4, restitution: 0}",
                             const std::string& more = "") {
  return model::parse_scenario(scene_text(duration, bodies, contact, more), "test.yaml");
}

inline const BodyResult& body_of(const RunResult& result, const std::string& name) {
  for (const BodyResult& body : result.bodies) {
    if (body.name == name) return body;
  }
  throw std::runtime_error("no body " + name);
}

inline std::string loading_error(const std::string& text, const std::string& name) {
  try {
    (void)model::parse_scenario(text, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// --- belts ---

}  // namespace snug::runs::test
