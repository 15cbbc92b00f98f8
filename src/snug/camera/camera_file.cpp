// CameraFile: what a file beside a frame says of the camera that took it: optics, unit, axes, pose.
#include "snug/camera/camera_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::camera {
namespace {

constexpr std::array kAllAxes = {Axes::Optical, Axes::Ros, Axes::OpenGl};
constexpr double kMostPixels = 8192.0;
constexpr double kFarthestCamera = 1e4;        ///< m
constexpr double kUndistorted = 1e-9;          ///< of the coefficients of a lens
constexpr std::size_t kLargestFile = 1 << 20;  ///< bytes

/// Keys of files that other programs write, which say nothing that is needed.
const std::set<std::string>& ignored_keys() {
  static const std::set<std::string> keys = {"header",
                                             "distortion_model",
                                             "rectification_matrix",
                                             "projection_matrix",
                                             "R",
                                             "P",
                                             "r",
                                             "p",
                                             "binning_x",
                                             "binning_y",
                                             "roi",
                                             "model",
                                             "camera_name",
                                             "stream",
                                             "format",
                                             "fps",
                                             "serial",
                                             "stereo_baseline_mm",
                                             "date",
                                             "comment",
                                             "time_s",
                                             "look",
                                             "class_name"};
  return keys;
}

const std::vector<std::string>& known_keys() {
  static const std::vector<std::string> keys = {"name",
                                                "size_px",
                                                "intrinsics_px",
                                                "position_m",
                                                "quat_wxyz",
                                                "working_range_m",
                                                "unit",
                                                "depth_scale",
                                                "axes",
                                                "points_in",
                                                "pose",
                                                "X_WC",
                                                "width",
                                                "height",
                                                "image_width",
                                                "image_height",
                                                "fx",
                                                "fy",
                                                "cx",
                                                "cy",
                                                "ppx",
                                                "ppy",
                                                "intrinsics",
                                                "intrinsic_matrix",
                                                "camera_matrix",
                                                "K",
                                                "k",
                                                "D",
                                                "d",
                                                "coeffs",
                                                "distortion_coefficients"};
  return keys;
}

class CameraReader {
 public:
  CameraReader(const YAML::Node& root, std::string name) : root_(root), name_(std::move(name)) {}

  [[nodiscard]] CameraFile read() const {
    if (!root_.IsMap()) refuse(root_, "", "no mapping", "keys of a camera");
    for (const auto& entry : root_) check_key(entry.first);
    CameraFile file;
    file.name = text("name", "camera_name");
    read_size(file);
    read_optics(root_, file);
    check_lens();
    read_unit(file);
    if (const YAML::Node axes = root_["axes"]) file.axes = axes_of(word(axes, "axes"), where(axes));
    if (const YAML::Node in = root_["points_in"]) {
      const std::string said = word(in, "points_in");
      if (said != "camera" && said != "world") refuse(in, "points_in", "'" + said + "'", "camera or world");
      file.points_are_in_camera = said == "camera";
    }
    if (const YAML::Node range = root_["working_range_m"]) {
      const std::vector<double> values = numbers(range, "working_range_m", 3, kFarthestCamera);
      if (!(values[0] > 0.0 && values[0] < values[1])) refuse(range, "working_range_m", "", "near < far");
      file.range = model::CameraRange{values[0], values[1], values[2]};
    }
    read_pose(file);
    return file;
  }

 private:
  [[nodiscard]] std::string where(const YAML::Node& node) const {
    return name_ + ":" + std::to_string(std::max(0, node.Mark().line) + 1);
  }
  [[noreturn]] void refuse(const YAML::Node& node, const std::string& key, const std::string& got,
                           const std::string& expected) const {
    throw InputError(where(node), key, got, expected);
  }

  void check_key(const YAML::Node& node) const {
    const std::string key = node.IsScalar() ? node.Scalar() : std::string();
    const std::vector<std::string>& known = known_keys();
    if (ignored_keys().contains(key) || std::ranges::find(known, key) != known.end()) return;
    if (key.ends_with("_intrinsics"))  // which of them it is, depends on what the depth was aligned to
      refuse(node, printable(key, 60), "the optics of one of several cameras",
             "fx, fy, ppx and ppy of the depth frame alone: of the colour camera where depth is aligned to it");
    const std::string_view nearest = find_nearest(key, known);
    refuse(node, printable(key, 60), "an unknown key",
           nearest.empty() ? "keys of a camera (docs/camera-frames.md)" : "'" + std::string(nearest) + "'");
  }

  [[nodiscard]] std::string word(const YAML::Node& node, const char* key) const {
    if (!node.IsScalar()) refuse(node, key, "no word", "a word");
    return node.Scalar();
  }
  [[nodiscard]] std::string text(const char* key, const char* other) const {
    for (const char* one : {key, other}) {
      const YAML::Node node = root_[one];
      if (node && node.IsScalar() && is_printable(node.Scalar())) return node.Scalar().substr(0, 120);
    }
    return {};
  }

  [[nodiscard]] double number(const YAML::Node& node, const std::string& key, double most) const {
    double value = 0.0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !(std::abs(value) <= most)) {
      refuse(node, key, node.IsScalar() ? "'" + printable(node.Scalar(), 60) + "'" : "no number", "a finite number");
    }
    return value;
  }
  /// Numbers of a list, or of a list of lists.
  [[nodiscard]] std::vector<double> numbers(const YAML::Node& node, const std::string& key, std::size_t count,
                                            double most) const {
    std::vector<double> values;
    if (!node.IsSequence()) refuse(node, key, "no list", std::to_string(count) + " numbers");
    for (const auto& entry : node) {
      if (!entry.IsSequence()) {
        values.push_back(number(entry, key, most));
        continue;
      }
      for (const auto& inner : entry) values.push_back(number(inner, key, most));
    }
    if (count != 0 && values.size() != count)
      refuse(node, key, std::to_string(values.size()) + " numbers", std::to_string(count));
    return values;
  }

  void read_size(CameraFile& file) const {
    const auto side = [&](const YAML::Node& node, const char* key) {
      const double value = number(node, key, kMostPixels);
      if (!(value >= 1.0 && value == std::floor(value))) refuse(node, key, node.Scalar(), "1 to 8192 pixels");
      return static_cast<int>(value);
    };
    if (const YAML::Node size = root_["size_px"]) {
      if (!size.IsSequence() || size.size() != 2) refuse(size, "size_px", "no two numbers", "width, height");
      file.size = CameraFile::Size{side(size[0], "size_px"), side(size[1], "size_px")};
    }
    for (const auto& [across, along] : {std::pair{"width", "height"}, std::pair{"image_width", "image_height"}}) {
      const YAML::Node width = root_[across], height = root_[along];
      if (!width && !height) continue;
      if (!width || !height) refuse(root_, width ? along : across, "nothing", std::string(across) + " and " + along);
      file.size = CameraFile::Size{side(width, across), side(height, along)};
    }
  }

  /// The numbers of a matrix as ROS writes it: rows, cols, data.
  [[nodiscard]] static YAML::Node data_of(const YAML::Node& node) {
    return node.IsMap() && node["data"] ? node["data"] : node;
  }

  void set_optics(const YAML::Node& node, const char* key, const std::array<double, 4>& values,
                  CameraFile& file) const {
    if (!(values[0] > 1.0 && values[1] > 1.0)) refuse(node, key, "a focal length of at most 1 px", "fx fy cx cy in px");
    file.intrinsics = model::CameraIntrinsics{values[0], values[1], values[2], values[3]};
  }

  /// fx, fy, cx, cy, or a matrix of nine.
  void read_optics(const YAML::Node& map, CameraFile& file) const {
    if (map["fx"] || map["fy"]) {
      std::array<double, 4> values{};
      const std::array<std::array<const char*, 2>, 4> names = {
          {{"fx", "fx"}, {"fy", "fy"}, {"cx", "ppx"}, {"cy", "ppy"}}};
      for (std::size_t i = 0; i < names.size(); ++i) {
        const YAML::Node node = map[map[names[i][0]] ? names[i][0] : names[i][1]];
        if (!node) refuse(map, names[i][0], "nothing", "fx, fy, cx and cy in pixels");
        values[i] = number(node, names[i][0], 1e6);
      }
      set_optics(map, "fx", values, file);
    }
    if (const YAML::Node list = map["intrinsics_px"]) {
      const std::vector<double> v = numbers(list, "intrinsics_px", 4, 1e6);
      set_optics(list, "intrinsics_px", {v[0], v[1], v[2], v[3]}, file);
    }
    if (const YAML::Node inner = map["intrinsics"]) {
      if (inner.IsMap()) {
        read_optics(inner, file);
      } else {
        const std::vector<double> v = numbers(inner, "intrinsics", 4, 1e6);
        set_optics(inner, "intrinsics", {v[0], v[1], v[2], v[3]}, file);
      }
    }
    for (const char* key : {"intrinsic_matrix", "camera_matrix", "K", "k"}) {
      if (!map[key]) continue;
      const YAML::Node matrix = data_of(map[key]);
      const std::vector<double> v = numbers(matrix, key, 9, 1e6);
      // By rows as ROS writes it, or by columns as Open3D does: the two zeros below the diagonal tell which.
      const bool is_by_rows = v[6] == 0.0 && v[7] == 0.0;
      if (v[8] != 1.0 || (!is_by_rows && (v[2] != 0.0 || v[5] != 0.0)) || v[1] != 0.0 || v[3] != 0.0)
        refuse(matrix, key, "another matrix", "fx 0 cx 0 fy cy 0 0 1");
      set_optics(matrix, key, {v[0], v[4], is_by_rows ? v[2] : v[6], is_by_rows ? v[5] : v[7]}, file);
    }
  }

  void check_lens() const {
    for (const char* key : {"D", "d", "coeffs", "distortion_coefficients"}) {
      if (!root_[key]) continue;
      const YAML::Node lens = data_of(root_[key]);
      for (const double value : numbers(lens, key, 0, 1e6)) {
        if (std::abs(value) > kUndistorted)
          refuse(lens, key, "a lens that distorts", "rectified frames: the coefficients of their camera are 0");
      }
    }
  }

  void read_unit(CameraFile& file) const {
    for (const char* key : {"unit", "depth_scale"}) {
      const YAML::Node node = root_[key];
      if (!node) continue;
      std::string said = word(node, key);
      std::erase(said, ' ');
      for (const auto& [unit, metres] : {std::pair{"m", 1.0}, std::pair{"cm", 1e-2}, std::pair{"mm", 1e-3},
                                         std::pair{"0.1mm", 1e-4}, std::pair{"um", 1e-6}, std::pair{"1mm", 1e-3}}) {
        if (said == unit) file.unit = metres;
      }
      if (file.unit) continue;
      double value = 0.0;
      if (!YAML::convert<double>::decode(node, value) || !(value >= 1e-7 && value <= 1.0))
        refuse(node, key, "'" + printable(node.Scalar(), 60) + "'",
               "m, cm, mm, 0.1 mm, um, or the metres of one step (0.001 is a millimetre)");
      file.unit = value;
    }
  }

  [[nodiscard]] Matrix3 rotation(const YAML::Node& map, const YAML::Node& quat, const YAML::Node& vector,
                                 const YAML::Node& rpy) const {
    if (static_cast<int>(quat.IsDefined()) + static_cast<int>(vector.IsDefined()) + static_cast<int>(rpy.IsDefined()) >
        1)
      refuse(map, "pose", "two rotations", "quat_wxyz, rotation_vector or rpy_deg");
    if (quat) {
      const std::vector<double> q = numbers(quat, "quat_wxyz", 4, 2.0);
      const Quaternion turn(q[0], q[1], q[2], q[3]);
      if (!(std::abs(turn.norm() - 1.0) < 1e-3)) refuse(quat, "quat_wxyz", "no unit quaternion", "w, x, y, z");
      return turn.normalized().toRotationMatrix();
    }
    if (vector) {
      const std::vector<double> r = numbers(vector, "rotation_vector", 3, 10.0);
      return exp_rotation(Vector3(r[0], r[1], r[2]));
    }
    if (rpy) {
      const std::vector<double> a = numbers(rpy, "rpy_deg", 3, 720.0);
      const double unit = std::numbers::pi / 180.0;
      return exp_rotation(Vector3(0, 0, unit * a[2])) * exp_rotation(Vector3(0, unit * a[1], 0)) *
             exp_rotation(Vector3(unit * a[0], 0, 0));
    }
    return Matrix3::Identity();
  }

  void read_pose(CameraFile& file) const {
    std::optional<Pose> X_WC;
    if (const YAML::Node pose = root_["pose"]) {
      if (!pose.IsMap() || !pose["position"]) refuse(pose, "pose", "no position", "position and quat_wxyz");
      for (const auto& entry : pose) {
        const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
        if (key != "position" && key != "quat_wxyz" && key != "rotation_vector" && key != "rpy_deg")
          refuse(entry.first, "pose." + printable(key, 60), "an unknown key",
                 "position and quat_wxyz, rotation_vector or rpy_deg");
      }
      const std::vector<double> p = numbers(pose["position"], "pose.position", 3, kFarthestCamera);
      X_WC =
          Pose{rotation(pose, pose["quat_wxyz"], pose["rotation_vector"], pose["rpy_deg"]), Vector3(p[0], p[1], p[2])};
    }
    if (const YAML::Node place = root_["position_m"]) {
      const std::vector<double> p = numbers(place, "position_m", 3, kFarthestCamera);
      X_WC = Pose{rotation(root_, root_["quat_wxyz"], root_["none"], root_["none"]), Vector3(p[0], p[1], p[2])};
    }
    if (const YAML::Node matrix = root_["X_WC"]) {
      const std::vector<double> v = numbers(matrix, "X_WC", 16, kFarthestCamera);
      Matrix3 R;
      R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
      const bool is_rotation = (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-3 &&
                               R.determinant() > 0.0 && v[12] == 0.0 && v[13] == 0.0 && v[14] == 0.0 && v[15] == 1.0;
      if (!is_rotation) refuse(matrix, "X_WC", "no pose", "a 4 x 4 matrix by rows: rotation and metres, 0 0 0 1");
      X_WC = Pose{Quaternion(R).normalized().toRotationMatrix(), Vector3(v[3], v[7], v[11])};
    }
    if (!X_WC) return;
    X_WC->R = X_WC->R * rotation_of(file.axes.value_or(Axes::Optical));
    file.X_WC = X_WC;
  }

  YAML::Node root_;
  std::string name_;
};

}  // namespace

const char* name_of(Axes axes) {
  switch (axes) {
    case Axes::Optical:
      return "optical";
    case Axes::Ros:
      return "ros";
    case Axes::OpenGl:
      return "opengl";
  }
  return "";
}

Axes axes_of(const std::string& word, const std::string& where) {
  for (const Axes axes : kAllAxes) {
    if (word == name_of(axes)) return axes;
  }
  throw InputError(where, "axes", "'" + printable(word, 60) + "'",
                   "optical (z forward, x right, y down), ros (x forward, y left, z up) or opengl (-z forward, y up)");
}

Matrix3 rotation_of(Axes axes) {
  Matrix3 R = Matrix3::Identity();
  if (axes == Axes::Ros) R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  if (axes == Axes::OpenGl) R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return R;
}

CameraFile parse_camera_file(const std::string& text, const std::string& name) {
  model::check_yaml(text, name);
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(name + ":" + std::to_string(error.mark.line + 1), "", error.msg, "JSON or YAML of a camera");
  }
  return CameraReader(root, name).read();
}

CameraFile load_camera_file(const std::filesystem::path& path) {
  return parse_camera_file(read_file(path, "what a camera is (JSON or YAML)", kLargestFile), path.string());
}

std::optional<std::filesystem::path> find_camera_file(const std::filesystem::path& frame) {
  std::error_code error;
  for (const std::string& stem : {frame.stem().string(), std::string("camera")}) {
    std::optional<std::filesystem::path> found;
    for (const char* ending : {".json", ".yaml", ".yml"}) {
      const std::filesystem::path path = frame.parent_path() / (stem + ending);
      if (!std::filesystem::is_regular_file(path, error)) continue;
      if (found) throw InputError(path.string(), "", "a second file for " + frame.string(), "one: " + found->string());
      found = path;
    }
    if (found) return found;
  }
  return std::nullopt;
}

model::CameraParams choose_camera(const model::Scenario& scenario, const std::optional<std::string>& name,
                                  const std::string& source) {
  if (scenario.cameras.empty())
    throw InputError(source, "cameras", "none", "a scenario with cameras; --scenario names another one");
  if (!name) return scenario.cameras.front();
  if (const model::CameraParams* camera = model::find_camera(scenario, *name)) return *camera;
  std::vector<std::string> names;
  for (const model::CameraParams& camera : scenario.cameras) names.push_back(camera.name);
  const std::string_view nearest = find_nearest(*name, names);
  throw InputError("command line", "--camera", "'" + *name + "'",
                   fmt::format("one of {}{}", fmt::join(names, ", "),
                               nearest.empty() ? "" : fmt::format(", nearest is '{}'", nearest)));
}

}  // namespace snug::camera
