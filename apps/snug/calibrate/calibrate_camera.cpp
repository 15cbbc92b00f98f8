// calibrate camera: where a camera of the cell is, from poses of what the robot holds before it.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/command_line/as_list.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "snug/calibration/hand_eye.hpp"
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

using nlohmann::ordered_json;

ordered_json as_json(const Pose& X, const Matrix6& covariance) {
  const Quaternion quat(X.R);
  const Vector6 sd = covariance.diagonal().cwiseSqrt();
  ordered_json rows = ordered_json::array();
  for (int i = 0; i < 6; ++i) {
    rows.push_back(ordered_json::array());
    for (int k = 0; k < 6; ++k) rows.back().push_back(covariance(i, k));
  }
  return {{"position_m", as_list(X.p)},
          {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}},
          {"position_standard_deviation_m", as_list(sd.head<3>())},
          {"rotation_standard_deviation_rad", as_list(sd.tail<3>())},
          {"covariance", rows}};
}

/// The camera as a scenario has it: its pose, and its standard deviations as hand-eye errors.
std::string as_yaml(const calibration::HandEye& found, const CalibrateCameraOptions& options) {
  const Quaternion quat(found.X_WC.R);
  const Vector6 variance = found.covariance.diagonal();
  return fmt::format(
      "cameras:\n  - name: {}\n    preset: {}\n    pose: {{position: [{:.7f}, {:.7f}, {:.7f}], quat_wxyz: [{:.9f}, "
      "{:.9f}, {:.9f}, "
      "{:.9f}]}}\n    hand_eye: {{position: {:.3g}, rotation_deg: {:.3g}}}  # found by least squares: root mean "
      "squares of the axes\n",
      options.name, options.preset, found.X_WC.p.x(), found.X_WC.p.y(), found.X_WC.p.z(), quat.w(), quat.x(), quat.y(),
      quat.z(), std::sqrt(variance.head<3>().mean()), std::sqrt(variance.tail<3>().mean()) * 180.0 / std::numbers::pi);
}

std::string line(const char* what, const Pose& X, const Matrix6& covariance) {
  const Vector6 sd = covariance.diagonal().cwiseSqrt();
  const Vector3 turn = log_rotation(X.R);
  return fmt::format(
      "{}: at ({:.3f}, {:.3f}, {:.3f}) mm +- ({:.3f}, {:.3f}, {:.3f}), turned by ({:.5f}, {:.5f}, {:.5f}) rad +- "
      "({:.5f}, {:.5f}, {:.5f})\n",
      what, 1e3 * X.p.x(), 1e3 * X.p.y(), 1e3 * X.p.z(), 1e3 * sd(0), 1e3 * sd(1), 1e3 * sd(2), turn.x(), turn.y(),
      turn.z(), sd(3), sd(4), sd(5));
}

int run_calibrate_camera(const CalibrateCameraOptions& options) {
  std::optional<OutputFile> output = reserve({{"the input", options.input}}, options.output);
  const Table table = load_table(options.input, calibration::hand_eye_columns());
  const calibration::HandEye found = calibration::find_hand_eye(table);
  if (output) write_file(std::move(*output), as_yaml(found, options));
  if (options.json) {
    const ordered_json json = {{"camera", as_json(found.X_WC, found.covariance)},
                               {"board", as_json(found.X_EB, found.board_covariance)},
                               {"rows", table.rows.size()},
                               {"position_noise_m", found.position_noise},
                               {"angle_noise_rad", found.angle_noise}};
    print(json.dump(2) + "\n");
    return kSuccess;
  }
  print(line("camera in W", found.X_WC, found.covariance) + line("board in E", found.X_EB, found.board_covariance) +
        fmt::format("noise of a measured pose {:.3f} mm, {:.3f} mrad; {} rows\n", 1e3 * found.position_noise,
                    1e3 * found.angle_noise, table.rows.size()));
  return kSuccess;
}

constexpr const char* kCameraPosesHelp =
    R"(The CSV has a header x,y,z,rx,ry,rz,cx,cy,cz,crx,cry,crz: pose of the tool in the world, and pose in the camera of what the
tool holds: a board, or a box that `snug perceive` measured (m; rotation vectors in rad). Four rows or more, the tool turned about two
axes at least. What is held need not be known where it sits: that is found too.
Examples:
  snug calibrate camera scenarios/examples/board.csv
  snug calibrate camera scenarios/examples/board.csv --name tote -o camera.yaml --json)";

}  // namespace

void add_calibrate_camera(const Verb& verb) {
  const Verb part = verb.part("camera", "where a camera is that stands in the cell (hand-eye)", kCameraPosesHelp);
  CalibrateCameraOptions& options = part.runs(run_calibrate_camera);
  part.option("poses", options.input, "FILE.csv", "of the tool, and of what it holds as the camera sees it").required();
  part.option("--name", options.name, "NAME", "of the camera in what is written");
  part.option("--preset", options.preset, "NAME", "kind of camera in what is written: its noise and range",
              one_of({"structured_light", "active_stereo", "ideal"}));
  part.option("-o,--output", options.output, "FILE.yaml", "block for a scenario: pose and hand-eye error");
  add_json(part, options.json);
}

}  // namespace snug::app
