// What a scene becomes, loaded.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "snug/core/input_error.hpp"
#include "snug/model/scenario.hpp"
#include "snug/scene_import/import_scene.hpp"

namespace snug::scene_import::test {

/// The scenario of a scene, which must be one.
inline model::Scenario load(const std::string& text, Imported* imported = nullptr, const std::string& folder = ".") {
  const Imported scene = parse_scene(text, "scene.xml", folder);
  EXPECT_EQ(scene.refusal, "") << scene.yaml;
  if (imported != nullptr) *imported = scene;
  return model::parse_scenario(scene.yaml, "scene.yaml");
}

inline const model::Body& body(const model::Scenario& scenario, std::string_view name) {
  const model::Body* found = model::find_body(scenario, std::string(name));
  if (found != nullptr) return *found;
  ADD_FAILURE() << "no body " << name;
  return scenario.bodies.front();
}

inline bool has_remark(const Imported& imported, const std::string& part) {
  for (const Remark& remark : imported.remarks)
    if (to_text(remark).find(part) != std::string::npos) return true;
  return false;
}

inline void expect_refusal(const std::string& text, const std::string& part, const std::string& folder = ".") {
  try {
    (void)parse_scene(text, "scene.xml", folder);
    ADD_FAILURE() << "was read, without: " << part;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace snug::scene_import::test
