// Poses and frames of SDF.
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/scene_import/internal/sdf.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr std::size_t kLongestChain = 1000;

}  // namespace

SdfPose read_sdf_pose(const Node& node) {
  const std::optional<Node> pose = node.child("pose");
  if (!pose) return {};
  SdfPose read;
  if (pose->has("relative_to") && !pose->attribute("relative_to").empty())
    read.relative_to = pose->attribute("relative_to");
  const std::string text = pose->text();
  if (text.empty()) return read;
  const bool is_quaternion = pose->attribute("rotation_format") == "quat_xyzw";
  const std::vector<double> v = pose->numbers(text, "pose", is_quaternion ? 7 : 6, is_quaternion ? 7 : 6);
  read.X.p = Vector3(v[0], v[1], v[2]);
  if (is_quaternion) {
    const Quaternion quat(v[6], v[3], v[4], v[5]);
    if (!(quat.norm() > 1e-10)) pose->fail("a quaternion of length 0", "a rotation: x, y, z, w");
    read.X.R = quat.normalized().toRotationMatrix();
    return read;
  }
  const bool is_in_degrees = pose->has("degrees") && pose->yes_or_no(pose->attribute("degrees"), "degrees");
  read.X.R = rpy_rotation((is_in_degrees ? std::numbers::pi / 180.0 : 1.0) * Vector3(v[3], v[4], v[5]));
  return read;
}

void SdfFrames::add(const std::string& key, const Pose& X, const std::string& relative_to, const Node& node,
                    const std::string& placement) {
  if (key.empty()) node.fail("no name", "a name");
  if (!frames_.emplace(key, Frame{X, relative_to, node, placement}).second)
    node.fail("a second '" + key + "'", "each name once within a model");
}

SdfFrames::Frame& SdfFrames::find(const std::string& key, const Node& node) {
  const auto found = frames_.find(key);
  if (found != frames_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, frame] : frames_) names.push_back(name);
  const std::string_view nearest = find_nearest(key, names);
  node.fail("frame '" + key + "', which is not there",
            nearest.empty() ? "a link, frame, joint or model" : "'" + std::string(nearest) + "'");
}

Pose SdfFrames::in(const std::string& key, const std::string& base, const Node& node) {
  Pose X;
  std::string at = key;
  for (std::size_t steps = 0; at != base; ++steps) {
    if (at.empty()) node.fail("frame '" + key + "', which is not inside '" + base + "'", "a frame of the model");
    Frame& frame = find(at, node);
    if (steps > kLongestChain) frame.node.fail("frames relative to each other", "an end, in the world");
    X = local(frame, at) * X;
    at = frame.relative_to;
  }
  return X;
}

const Pose& SdfFrames::local(Frame& frame, const std::string& key) {
  if (frame.local) return *frame.local;
  if (frame.is_being_found) frame.node.fail("frames relative to each other", "an end, in the world");
  frame.is_being_found = true;
  Pose X = frame.X;
  if (!frame.placement.empty()) X = X * in(frame.placement, key, frame.node).inverse();
  frame.is_being_found = false;
  frame.local = X;
  return *frame.local;
}

std::optional<std::filesystem::path> find_uri(const std::string& uri, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto there = [&](const fs::path& path) { return fs::exists(path, error); };
  for (const char* scheme : {"model://", "package://"}) {
    if (!uri.starts_with(scheme)) continue;
    const std::string rest = uri.substr(std::string_view(scheme).size());
    const std::string model = rest.substr(0, rest.find('/'));
    const fs::path start = folder.empty() ? fs::current_path(error) : fs::absolute(folder, error);
    for (fs::path up = start; up.has_relative_path(); up = up.parent_path()) {
      for (const fs::path& path : {up / rest, up / "models" / rest}) {
        if (there(path)) return path;
      }
      if (up.filename() == model && there(up.parent_path() / rest)) return up.parent_path() / rest;
    }
    return std::nullopt;
  }
  if (uri.starts_with("file://")) {
    const fs::path path = uri.substr(7);
    const fs::path whole = path.is_relative() ? folder / path : path;
    return there(whole) ? std::optional(whole) : std::nullopt;
  }
  if (uri.find("://") != std::string::npos) return std::nullopt;
  const fs::path path = fs::path(uri).is_relative() ? folder / uri : fs::path(uri);
  return there(path) ? std::optional(path) : std::nullopt;
}

}  // namespace snug::scene_import::internal
