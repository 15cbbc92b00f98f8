// StaticPoses from JSON and CSV.
#include "snug/identification/static_poses.hpp"

#include <cmath>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/internal/json_file.hpp"
#include "snug/identification/internal/measured_table.hpp"

namespace snug::identification {
namespace {

using internal::JsonValue;

constexpr double kLargestBend = std::numbers::pi / 4.0;  // where the law ends, docs/theory/cup.md, section 4

/// What every pose must be, whatever it was read from.
void check(const StaticPoses& poses, const StaticPose& pose) {
  const Pose H = poses.frames.X_ES2.inverse() * pose.X_ES * poses.frames.X_SS1;
  const double bend = cup::bend_angle(H.R);
  if (!(bend < kLargestBend))
    throw InputError(pose.where, "",
                     "a cup bent by " + std::to_string(std::lround(bend * 180.0 / std::numbers::pi)) + " degrees",
                     "less than 45, where its law ends; is this the pose of the lip in the gripper's frame?");
  if (!(H.p.norm() < 0.1))
    throw InputError(pose.where, "",
                     "a lip " + std::to_string(std::lround(1e3 * H.p.norm())) + " mm from where it rests without load",
                     "metres, less than 0.1; do the cup's lengths belong to this file?");
  if (!pose.load && !pose.wrench_S)
    throw InputError(pose.where, "", "neither a wrench nor a payload with the gripper's orientation", "one of them");
}

MeasurementNoise read_noise(const JsonValue& value) {
  value.check_keys({"pos_m", "rot_rad", "force_N", "torque_Nm"});
  MeasurementNoise noise;
  noise.position = value.at("pos_m").not_negative();
  noise.rotation = value.at("rot_rad").not_negative();
  if (value.has("force_N")) noise.force = value.at("force_N").not_negative();
  if (value.has("torque_Nm")) noise.torque = value.at("torque_Nm").not_negative();
  return noise;
}

/// The measured value where the file has it, else the plain one.
JsonValue measured(const JsonValue& record, const std::string& key) {
  return record.has(key + "_meas") ? record.at(key + "_meas") : record.at(key);
}

StaticPose read_pose(const JsonValue& record, int index) {
  record.check_keys({"i", "mass", "com_S", "tilt_deg", "W_q_E", "E_o_S", "E_q_S", "wrench_S", "E_o_S_meas",
                     "E_q_S_meas", "wrench_S_meas", "E_o_S_true", "E_q_S_true", "wrench_S_true"});
  StaticPose pose;
  pose.index = index;
  pose.where = record.where();
  pose.X_ES = {measured(record, "E_q_S").quaternion(), measured(record, "E_o_S").vector3()};
  if (record.has("wrench_S_meas") || record.has("wrench_S")) pose.wrench_S = measured(record, "wrench_S").vector6();
  if (record.has("mass") || record.has("W_q_E"))
    pose.load = KnownLoad{record.at("W_q_E").quaternion(), record.at("mass").positive(), record.at("com_S").vector3()};
  return pose;
}

}  // namespace

CupFrames frames_of(const model::CupParams& cup) {
  return {Pose{Matrix3::Identity(), Vector3(0.0, 0.0, cup.hold_length - cup.centre_from_lip)},
          Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -cup.centre_from_lip)}};
}

StaticPoses parse_static_poses_json(std::string_view text, const std::string& name, const model::CupParams& cup) {
  const nlohmann::json document = internal::parse_json(text, name);
  const JsonValue root(document, name);
  root.check_keys({"noise", "gravity", "L0", "E_H_S2_o", "S_H_S1_o", "K_true", "theta_names", "theta_true", "recovered",
                   "records"});
  StaticPoses poses;
  poses.source = name;
  poses.frames = frames_of(cup);
  if (root.has("E_H_S2_o")) poses.frames.X_ES2.p = root.at("E_H_S2_o").vector3();
  if (root.has("S_H_S1_o")) poses.frames.X_SS1.p = root.at("S_H_S1_o").vector3();
  if (root.has("gravity")) poses.gravity_W.z() = -root.at("gravity").positive();
  poses.noise_is_given = root.has("noise");
  if (poses.noise_is_given) poses.noise = read_noise(root.at("noise"));
  for (const JsonValue& record : root.at("records").entries()) {
    poses.poses.push_back(read_pose(record, static_cast<int>(poses.poses.size())));
    check(poses, poses.poses.back());
  }
  return poses;
}

StaticPoses parse_static_poses_csv(const std::string& text, const std::string& name, const model::CupParams& cup) {
  const std::vector<std::string> lip{"x", "y", "z", "qw", "qx", "qy", "qz"};
  const std::vector<std::string> load{"mass",       "com_x",      "com_y",      "com_z",
                                      "gripper_qw", "gripper_qx", "gripper_qy", "gripper_qz"};
  const std::vector<std::string> wrench{"fx", "fy", "fz", "tx", "ty", "tz"};
  std::vector<std::string> optional = load;
  optional.insert(optional.end(), wrench.begin(), wrench.end());
  const Table table = parse_table(text, name, lip, optional);
  const auto load_at = internal::find_group(table, load), wrench_at = internal::find_group(table, wrench);
  if (table.rows.empty()) throw InputError(name, "", "no rows", "one row for each pose");
  StaticPoses poses;
  poses.source = name;
  poses.frames = frames_of(cup);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    StaticPose pose;
    pose.index = static_cast<int>(row);
    pose.where = table.where(row);
    pose.X_ES = {internal::rotation_at(table, row, 3), internal::vector_at(table, row, 0)};
    if (wrench_at)
      pose.wrench_S =
          (Vector6() << internal::vector_at(table, row, *wrench_at), internal::vector_at(table, row, *wrench_at + 3))
              .finished();
    if (load_at) {
      const double mass = table.rows[row][*load_at];
      if (!(mass > 0.0)) throw InputError(pose.where, "mass", std::to_string(mass), "a number above 0");
      pose.load = KnownLoad{internal::rotation_at(table, row, *load_at + 4), mass,
                            internal::vector_at(table, row, *load_at + 1)};
    }
    check(poses, pose);
    poses.poses.push_back(pose);
  }
  return poses;
}

StaticPoses load_static_poses(const std::filesystem::path& path, const model::CupParams& cup) {
  const std::string text = read_file(path, "measurements (JSON or CSV)");
  if (path.extension() == ".json") return parse_static_poses_json(text, path.string(), cup);
  if (path.extension() == ".csv") return parse_static_poses_csv(text, path.string(), cup);
  throw InputError(path.string(), "", "a name that ends in '" + path.extension().string() + "'", ".json or .csv");
}

}  // namespace snug::identification
