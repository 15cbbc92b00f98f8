// import_scene: scenes of rigid bodies as MJCF (MuJoCo) and SDF (Gazebo), made into a scenario.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snug::scene_import {

/// What was left out, or taken otherwise than the scene says, and where.
struct Remark {
  std::string file;
  std::vector<int> lines;  ///< in order
  std::string what;        ///< such as "motor: left out"
  bool operator==(const Remark&) const = default;
};
/// "scene.xml:12, 15: motor: left out"; of many lines the first ones and how many there are.
[[nodiscard]] std::string to_text(const Remark& remark);

struct Imported {
  std::string yaml;  ///< a scenario (docs/scenario.md)
  std::vector<Remark> remarks;
  int static_bodies = 0;
  int dynamic_bodies = 0;
  std::string refusal;  ///< why load_scenario() will not take it as it is, such as bodies that begin in each other
};

/// Reads a scene, MJCF or SDF by its root element. Free bodies become dynamic ones with the mass, centre and inertia
/// that the other simulator gives them; what hangs on no joint is static. Friction of two surfaces is combined as
/// there: the larger of MuJoCo's, the smaller of Gazebo's. Throws InputError (file:line, element) for what that format
/// does not allow, files that are not there, and scenes without a body.
[[nodiscard]] Imported import_scene(const std::filesystem::path& path);

/// The same from text; `name` stands for the file, `folder` is where other files are looked for.
[[nodiscard]] Imported parse_scene(const std::string& text, const std::string& name,
                                   const std::filesystem::path& folder);

}  // namespace snug::scene_import
