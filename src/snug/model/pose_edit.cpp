// Pose edits: things of a cell moved in the text of its scenario; comments and layout stay, and everything else.
#include "snug/model/pose_edit.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/model/internal/key_path.hpp"
#include "snug/model/internal/value.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::model {
namespace {

constexpr double kPoseDegree = std::numbers::pi / 180.0;
constexpr double kFarthestPart = 100.0;  // m
constexpr double kSameTurn = 1e-9;       // rad
constexpr double kUpright = 1e-9;

constexpr const char* kEditablePose =
    "a pose that is written as {position: [x, y, z], yaw_deg: a}; change it in the text";

/// At most six decimals and at least one: 0.45, 0.0.
std::string decimal(double value) {
  std::string text = fmt::format("{:.6f}", value);
  while (text.ends_with('0') && !text.ends_with(".0")) text.pop_back();
  return text == "-0.0" ? "0.0" : text;
}

std::string decimals(const Vector3& v) {
  return "[" + decimal(v.x()) + ", " + decimal(v.y()) + ", " + decimal(v.z()) + "]";
}

/// A piece of the text in the place of another.
struct Replacement {
  std::size_t begin = 0, end = 0;
  std::string words;
};

/// The node under `key` with the node of the key itself.
std::optional<std::pair<YAML::Node, YAML::Node>> find_member(const YAML::Node& map, const std::string& key) {
  for (const auto& entry : map)
    if (entry.first.IsScalar() && entry.first.Scalar() == key) return std::pair(entry.first, entry.second);
  return std::nullopt;
}

/// Equal, but for what stands under `key` of the mapping that `steps` lead to, from `depth` on. Aliases are compared
/// as what they stand for.
bool is_same_elsewhere(const YAML::Node& a, const YAML::Node& b, const std::vector<std::string>* steps,
                       const std::string& changed, std::size_t depth) {
  if (a.Type() != b.Type()) return false;
  if (a.IsScalar()) return a.Scalar() == b.Scalar() && a.Tag() == b.Tag();
  const bool is_part = steps != nullptr && depth == steps->size();
  const auto below = [&](const std::string& step) {
    return steps != nullptr && !is_part && (*steps)[depth] == step ? steps : nullptr;
  };
  if (a.IsSequence()) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!is_same_elsewhere(a[i], b[i], below(std::to_string(i)), changed, depth + 1)) return false;
    return true;
  }
  if (!a.IsMap()) return true;
  std::size_t count = b.size() - (is_part && find_member(b, changed) ? 1 : 0);
  for (const auto& entry : a) {
    if (!entry.first.IsScalar()) return false;
    const std::string& key = entry.first.Scalar();
    if (is_part && key == changed) continue;
    const auto other = find_member(b, key);
    if (!other || !is_same_elsewhere(entry.second, other->second, below(key), changed, depth + 1)) return false;
    --count;
  }
  return count == 0;
}

/// One part of a text.
class PartText {
 public:
  PartText(std::string text, const std::string& where, const std::string& key)
      : text_(std::move(text)),
        where_(where),
        key_(key),
        pose_(key == kStartKey ? "start_pose" : "pose"),
        root_(YAML::Load(text_)),
        part_(find_part()) {}

  [[nodiscard]] std::string moved(const Pose& X_FP, double turn) {
    const auto pose = find_member(part_, pose_);
    if (!pose) {
      put_key(part_, pose_, "{" + written(X_FP.p, turn) + "}");
    } else {
      change(pose->second, X_FP, turn);
    }
    std::ranges::stable_sort(replacements_, std::greater{}, &Replacement::begin);
    std::string changed = text_;
    for (const Replacement& one : replacements_) changed.replace(one.begin, one.end - one.begin, one.words);
    try {
      if (is_same_elsewhere(root_, YAML::Load(changed), &steps_, pose_, 0)) return changed;
    } catch (const YAML::Exception&) {
      refuse("a pose that is written in another way");
    }
    refuse("a pose that other parts use, too");
  }

 private:
  [[nodiscard]] YAML::Node find_part() {
    const std::size_t dot = key_.find('.');
    steps_ = {key_.substr(0, dot)};
    const auto top = find_member(root_, steps_.front());
    if (!top) refuse("no such key");
    if (dot == std::string::npos || key_ == kStartKey) {
      if (!top->second.IsMap()) refuse("no mapping");
      return top->second;
    }
    const auto index = top->second.IsSequence() ? internal::find_entry(top->second, key_.substr(dot + 1))
                                                : std::optional<std::size_t>();
    if (!index || !top->second[*index].IsMap()) refuse("no entry of that name");
    steps_.push_back(std::to_string(*index));
    return top->second[*index];
  }

  [[nodiscard]] static std::string written(const Vector3& p, double yaw) {
    return "position: " + decimals(p) + (std::abs(yaw) > kSameTurn ? ", yaw_deg: " + decimal(yaw / kPoseDegree) : "");
  }

  void change(const YAML::Node& pose, const Pose& X_FP, double turn) {
    if (!pose.IsMap()) refuse("no mapping");
    if (const auto position = find_member(pose, "position")) {
      replace_list(position->second, decimals(X_FP.p));
    } else {
      put_key(pose, "position", decimals(X_FP.p));
    }
    if (std::abs(turn) <= kSameTurn) return;
    if (find_member(pose, "quat_wxyz") || find_member(pose, "rotation_vector"))
      refuse("a quaternion or rotation vector");
    if (const auto yaw = find_member(pose, "yaw_deg")) {
      replace_number(yaw->second, turn);
    } else if (const auto rpy = find_member(pose, "rpy_deg")) {
      if (!rpy->second.IsSequence() || rpy->second.size() != 3) refuse("no three angles");
      replace_number(rpy->second[2], turn);
    } else {
      put_key(pose, "yaw_deg", decimal(turn / kPoseDegree));
    }
  }

  /// yaml-cpp counts from behind a byte order mark.
  [[nodiscard]] std::size_t place_of(const YAML::Node& node) const {
    const std::size_t mark = text_.starts_with("\xef\xbb\xbf") ? 3 : 0;
    const std::size_t place = mark + static_cast<std::size_t>(std::max(0, node.Mark().pos));
    if (node.Mark().is_null() || place >= text_.size()) refuse("a pose that is written in another way");
    return place;
  }

  void replace_list(const YAML::Node& list, const std::string& words) {
    const std::size_t begin = place_of(list);
    const std::size_t end = text_.find(']', begin);
    const bool is_plain = list.IsSequence() && list.size() == 3 && text_[begin] == '[' && end != std::string::npos &&
                          text_.substr(begin, end - begin).find_first_of("#\n&*") == std::string::npos;
    if (!is_plain) refuse("a position that is written in another way");
    replacements_.push_back({begin, end + 1, words});
  }

  /// An angle in degrees, by `turn` [rad] more.
  void replace_number(const YAML::Node& number, double turn) {
    double before = 0.0;
    const std::size_t begin = place_of(number);
    const std::size_t end = std::min(text_.find_first_of(",}] \t\r\n", begin), text_.size());
    if (!number.IsScalar() || !YAML::convert<double>::decode(number, before) ||
        text_.substr(begin, end - begin) != number.Scalar())
      refuse("an angle that is written in another way");
    double degrees = before + turn / kPoseDegree;
    degrees -= 360.0 * std::round(degrees / 360.0);
    replacements_.push_back({begin, end, decimal(degrees)});
  }

  /// Before the first key of a mapping.
  void put_key(const YAML::Node& map, const std::string& key, const std::string& words) {
    const std::size_t begin = place_of(map);
    if (text_[begin] == '{') {
      const bool has_more = map.size() > 0 || std::ranges::any_of(replacements_, [&](const Replacement& one) {
                              return one.begin == begin + 1 && one.end == begin + 1;
                            });
      replacements_.push_back({begin + 1, begin + 1, key + ": " + words + (has_more ? ", " : "")});
    } else {
      const std::string indent(static_cast<std::size_t>(std::max(0, map.Mark().column)), ' ');
      replacements_.push_back({begin, begin, key + ": " + words + "\n" + indent});
    }
  }

  [[noreturn]] void refuse(const std::string& got) const { throw InputError(where_, key_, got, kEditablePose); }

  std::string text_, where_, key_, pose_;
  std::vector<std::string> steps_;  ///< to the part
  YAML::Node root_, part_;
  std::vector<Replacement> replacements_;
};

/// The frame that the pose of a part is written in.
Pose find_frame(const Scenario& scenario, const std::string& key) {
  const YAML::Node root = YAML::Load(scenario.source_text);
  const std::size_t dot = key.find('.');
  YAML::Node part = root[key.substr(0, dot)];
  if (dot != std::string::npos && part && part.IsSequence()) {
    const auto index = internal::find_entry(part, key.substr(dot + 1));
    if (!index) return {};
    part.reset(part[*index]);
  }
  if (!part || !part.IsMap()) return {};
  const auto pose = find_member(part, key == kStartKey ? "start_pose" : "pose");
  const auto frame = pose && pose->second.IsMap() ? find_member(pose->second, "frame") : std::nullopt;
  if (!frame || !frame->second.IsScalar()) return {};
  const auto known = std::ranges::find(scenario.frames, frame->second.Scalar(), &Frame::name);
  return known == scenario.frames.end() ? Pose{} : known->X_WF;
}

}  // namespace

double yaw_about_vertical(const Matrix3& R_W) {
  const bool has_level_x = R_W.col(0).head<2>().norm() > 1e-6;
  return has_level_x ? std::atan2(R_W(1, 0), R_W(0, 0)) : std::atan2(-R_W(0, 1), R_W(1, 1));
}

std::vector<CellPart> find_parts(const Scenario& scenario) {
  std::vector<CellPart> parts;
  if (scenario.robot) parts.push_back({"robot", scenario.robot->name, scenario.robot->X_WB});
  for (const Container& one : scenario.containers) parts.push_back({"containers." + one.name, one.name, one.X_WT});
  if (scenario.aligner) parts.push_back({"aligner", "aligner", scenario.aligner->X_WA});
  for (const Body& one : scenario.bodies)
    if (one.kind == BodyKind::Static) parts.push_back({"bodies." + one.name, one.name, one.X_WB});
  return parts;
}

std::string move_parts(const Scenario& scenario, std::span<const PoseEdit> edits) {
  std::vector<CellPart> parts = find_parts(scenario);
  parts.push_back({kStartKey, "start", scenario.controller.X_WE_start});
  std::string text = scenario.source_text;
  for (const PoseEdit& edit : edits) {
    const auto part = std::ranges::find(parts, edit.key, &CellPart::key);
    if (part == parts.end())
      throw InputError(scenario.source_name, edit.key, "no part of the cell",
                       "robot, aligner, containers.NAME or bodies.NAME");
    const bool is_near = edit.p_W.allFinite() && edit.p_W.cwiseAbs().maxCoeff() <= kFarthestPart &&
                         std::isfinite(edit.yaw) && std::abs(edit.yaw) <= 100.0;
    if (!is_near) throw InputError(scenario.source_name, edit.key, "a place that is too far away", "at most 100 m");
    double turn = edit.yaw - yaw_about_vertical(part->X_W.R);
    turn -= 2.0 * std::numbers::pi * std::round(turn / (2.0 * std::numbers::pi));
    const Pose X_WF = find_frame(scenario, edit.key);
    const double up = X_WF.R(2, 2);  // of the frame: a turn about the vertical is one about its own axis
    if (std::abs(turn) > kSameTurn && std::abs(up) < 1.0 - kUpright)
      throw InputError(scenario.source_name, edit.key, "a frame that is tilted", kEditablePose);
    const Pose X_FP = X_WF.inverse() * Pose{part->X_W.R, edit.p_W};
    text = PartText(std::move(text), scenario.source_name, edit.key).moved(X_FP, up > 0.0 ? turn : -turn);
  }
  return text;
}

std::string write_posture(const Scenario& scenario, std::span<const double> posture) {
  const std::string& text = scenario.source_text;
  const YAML::Node list = YAML::Load(text)["robot"]["posture"];
  const std::size_t begin = list.Mark().is_null() ? text.size() : static_cast<std::size_t>(list.Mark().pos);
  const std::size_t end = text.find(']', begin);
  const bool is_plain = list.IsSequence() && list.size() == posture.size() && end != std::string::npos &&
                        text[begin] == '[' &&
                        text.substr(begin, end - begin).find_first_of("#\n&*") == std::string::npos;
  if (!is_plain)
    throw InputError(scenario.source_name, "robot.posture", "a list that is written in another way",
                     "one that is written as [a, b, c]; change it in the text");
  std::string words = "[";
  for (const double q : posture) words += (words.size() > 1 ? ", " : "") + decimal(1e-4 * std::round(1e4 * q));
  return text.substr(0, begin) + words + text.substr(end);
}

}  // namespace snug::model
