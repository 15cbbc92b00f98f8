// calibrate camera: where a camera of the cell is, from poses of what the robot holds before it.
#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "snug/calibration/calibration_text.hpp"
#include "snug/core/write_file.hpp"

namespace snug::app {
namespace {

struct CalibrateCameraOptions {
  std::string input;
  std::optional<std::string> output;  ///< block for a scenario (YAML)
  std::string name = "tote";
  std::string preset = "structured_light";
  bool json = false;
};

int run_calibrate_camera(const CalibrateCameraOptions& options) {
  std::optional<OutputFile> output = reserve({{"the input", options.input}}, options.output);
  const Table table = load_table(options.input, calibration::hand_eye_columns());
  const calibration::HandEye found = calibration::find_hand_eye(table);
  if (output) write_file(std::move(*output), calibration::format_camera_block(found, options.name, options.preset));
  const std::size_t rows = table.rows.size();
  print(options.json ? calibration::format_json(found, rows) : calibration::format_text(found, rows));
  return kSuccess;
}

constexpr const char* kCameraPosesHelp =
    R"(The CSV has a header x,y,z,rx,ry,rz,cx,cy,cz,crx,cry,crz: pose of the tool in the world, and pose in the camera of what the
tool holds: a board, or a box that `snug perceive` measured (m; rotation vectors in rad). Four rows or more, the tool turned about two
axes at least. The pose of the held object in the tool may be unknown: camera finds it too.
Examples:
  snug calibrate camera scenarios/examples/board.csv
  snug calibrate camera scenarios/examples/board.csv --name tote -o camera.yaml --json)";

}  // namespace

void add_calibrate_camera(const Verb& verb) {
  const Verb part = verb.part("camera", "find where a camera of the cell is (hand-eye calibration)", kCameraPosesHelp);
  CalibrateCameraOptions& options = part.runs(run_calibrate_camera);
  part.option("poses", options.input, "FILE.csv", "poses of the tool and of what it holds").required();
  part.option("--name", options.name, "NAME", "name of the camera in the output");
  part.option("--preset", options.preset, "NAME", "kind of camera in the output: its noise and range",
              one_of({"structured_light", "active_stereo", "ideal"}));
  part.option("-o,--output", options.output, "FILE.yaml", "block for a scenario: pose and hand-eye error");
  add_json(part, options.json);
}

}  // namespace snug::app
