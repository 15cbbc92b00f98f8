// convert: scenes of other simulators into scenarios.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/write_file.hpp"
#include "snug/scene_import/import_scene.hpp"

namespace snug::app {
namespace {

struct ConvertOptions {
  std::string scene;   ///< MJCF or SDF
  std::string output;  ///< YAML
};

int run_convert(const ConvertOptions& options) {
  OutputFile output = reserve({{"the scene", options.scene}}, options.output);
  const scene_import::Imported imported = scene_import::import_scene(options.scene);
  write_file(std::move(output), imported.yaml);
  for (const scene_import::Remark& remark : imported.remarks)
    std::fprintf(stderr, "snug: note: %s\n", to_text(remark).c_str());
  print(fmt::format("{}: {} bodies that move, {} that do not\n", options.output, imported.dynamic_bodies,
                    imported.static_bodies));
  if (imported.refusal.empty()) return kSuccess;
  std::fprintf(stderr, "snug: the scenario is written, but cannot be used as it is: %s\n", imported.refusal.c_str());
  return kRunFailed;
}

constexpr const char* kConvertHelp =
    R"(Reads MJCF (MuJoCo) and SDF (Gazebo): boxes, balls, capsules, cylinders, ellipsoids, planes and meshes as convex hulls, with mass, centre and
inertia, friction, restitution, gravity and time step. Free bodies move, all others are fixed; joints keep their positions.
convert reports on stderr, with line numbers, what it leaves out or changes (docs/scenes.md). It does not download models.
Exit code 1: the scenario is written, but `snug simulate` refuses it for the printed reason, such as bodies that overlap at the start.
Examples:
  snug convert scenarios/examples/scene.xml -o scene.yaml
  snug simulate scene.yaml -o run.h5
  snug convert scenarios/examples/scene.sdf -o world.yaml)";

}  // namespace

void add_convert(CLI::App& app, Action& action) {
  const Verb verb(app, action, "convert", "convert a scene of MuJoCo or Gazebo into a scenario", kConvertHelp);
  ConvertOptions& options = verb.runs(run_convert);
  verb.option("scene", options.scene, "SCENE.xml|SCENE.sdf", "MJCF or SDF, by its root element").required();
  verb.option("-o,--output", options.output, "FILE.yaml", "the scenario").required();
}

}  // namespace snug::app
