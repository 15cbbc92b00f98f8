// Scenario: one cell or scene as a person described it: pure data, every value checked on loading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/model/body.hpp"
#include "snug/model/camera_params.hpp"
#include "snug/model/controller_params.hpp"
#include "snug/model/cup_params.hpp"
#include "snug/model/gripper_params.hpp"
#include "snug/model/material.hpp"
#include "snug/model/parcel.hpp"
#include "snug/model/robot_params.hpp"
#include "snug/model/uncertainty.hpp"
#include "snug/settings/session_settings.hpp"
#include "snug/settings/skill_params.hpp"

namespace snug::model {

struct SleepSettings {
  bool enabled = true;
  double linear_speed = 5.0e-5;   ///< m/s, a body slower than both speeds is calm
  double angular_speed = 5.0e-4;  ///< rad/s
  double time = 0.25;             ///< s, calm this long: the island falls asleep

  template <class Archive>
  void fields(Archive& a) {
    a("enabled", enabled);
    a("linear_speed", linear_speed, Range::NotNegative);
    a("angular_speed", angular_speed, Range::NotNegative);
    a("time", time, Range::Positive);
  }
  bool operator==(const SleepSettings&) const = default;
};

/// What a run may show before it says that it failed, or warns.
struct ContactLimits {
  double rigid_depth = 0.01;      ///< m, of rigid bodies in each other: beyond, the run failed
  double compliant_depth = 0.02;  ///< m, of compliant ones: beyond, the run failed
  double residual = 0.1;          ///< m/s, of the contact solver: beyond, the run warns

  template <class Archive>
  void fields(Archive& a) {
    a("rigid_depth", rigid_depth, Range::Positive);
    a("compliant_depth", compliant_depth, Range::Positive);
    a("residual", residual, Range::Positive);
  }
  bool operator==(const ContactLimits&) const = default;
};

struct SolverSettings {
  double tolerance = 1.0e-5;            ///< m/s, natural-map residual of the contact velocities
  int max_sweeps = 200;                 ///< Gauss-Seidel sweeps before a step gives up and says so
  double contact_margin = 0.002;        ///< m, pairs nearer than this are treated as contacts to come
  double restitution_threshold = 0.05;  ///< m/s, slower approaches do not rebound
  double position_slop = 1.0e-6;        ///< m, penetration that is left uncorrected
  SleepSettings sleep;
  ContactLimits contact_limits;

  template <class Archive>
  void fields(Archive& a) {
    a("tolerance", tolerance, Range::Positive);
    a("max_sweeps", max_sweeps, Range::Positive);
    a("contact_margin", contact_margin, Range::NotNegative);
    a("restitution_threshold", restitution_threshold, Range::NotNegative);
    a("position_slop", position_slop, Range::NotNegative);
    a("sleep", sleep);
    a("contact_limits", contact_limits);
  }
  bool operator==(const SolverSettings&) const = default;
};

struct Frame {
  std::string name;
  Pose X_WF;
  bool operator==(const Frame&) const = default;
};

/// A recording that a run without a program goes on from.
struct InitialState {
  std::filesystem::path recording;
  std::optional<double> time;  ///< s; absent: its last frame
  bool operator==(const InitialState&) const = default;
};

/// World frame W: z up unless gravity says otherwise. All poses are resolved to W while loading.
struct Scenario {
  std::string name;
  std::string source_name;                        ///< file or label it was read from
  std::string source_text;                        ///< the text itself, for recordings
  std::vector<std::filesystem::path> side_files;  ///< what it names and has read: meshes, tables of poses
  std::vector<std::string> warnings;              ///< what was taken otherwise than its writer may think

  Vector3 gravity = Vector3(0.0, 0.0, -9.81);  ///< m/s^2
  double time_step = 0.001;                    ///< s
  double duration = 5.0;                       ///< s, of a run without a program when none is asked for
  std::uint64_t seed = 1;
  std::optional<double> record_period;  ///< s between frames of a recording; absent: the cell's choice
  std::optional<InitialState> initial_state;
  SolverSettings solver;

  std::vector<Material> materials;
  std::vector<ContactPair> contact_pairs;
  std::optional<ContactParams> default_contact;

  std::vector<Frame> frames;
  std::vector<ParcelType> parcel_types;
  std::vector<Parcel> parcels;
  double parcel_clearance = 0.0;  ///< m, collision size = measured size - this, in each dimension
  std::vector<Container> containers;
  std::string target;        ///< name of the container to be packed; empty without containers
  std::vector<Body> bodies;  ///< static, kinematic and free ones, in the order written
  std::optional<Aligner> aligner;
  std::optional<ToolParams> tool;
  CupParams cup;  ///< with a `gripper`: one cup that stands for all of its cups (equivalent_cup)
  std::optional<GripperParams> gripper;
  ControllerParams controller;
  std::optional<RobotParams> robot;
  std::vector<CameraParams> cameras;
  std::vector<Sequence> sequences;
  Uncertainty uncertainty;  ///< of all of the above
  settings::SkillParams skills;
  settings::PackingSettings packing;
  settings::PlaceLimits place_limits;
  settings::RehearsalSettings rehearsal;
  settings::BeliefParams belief;
  settings::RecoverySettings recovery;
  settings::MotionGuards motion_guards;
  std::vector<Spring> springs;
  std::vector<AppliedWrench> wrenches;
  std::optional<Drops> drops;

  bool operator==(const Scenario&) const = default;
};

/// Reads a scenario file. Throws InputError (file:line, key, got, expected) for anything it does not understand or
/// that cannot be: docs/scenario.md is the reference.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Scenario parse_scenario(std::string_view text, std::string_view name);

/// Parameters of a pair of materials: its entry, else the default, else nothing (loading made sure that no pair that
/// can meet ends there).
[[nodiscard]] std::optional<ContactParams> find_contact(const Scenario& scenario, MaterialId a, MaterialId b);

/// Each returns nullptr when there is none of that name.
[[nodiscard]] const Parcel* find_parcel(const Scenario& scenario, std::string_view id);
[[nodiscard]] const ParcelType* find_parcel_type(const Scenario& scenario, std::string_view name);
[[nodiscard]] const Container* find_container(const Scenario& scenario, std::string_view name);
[[nodiscard]] const Sequence* find_sequence(const Scenario& scenario, std::string_view name);
[[nodiscard]] const CameraParams* find_camera(const Scenario& scenario, std::string_view name);
[[nodiscard]] const Body* find_body(const Scenario& scenario, std::string_view name);
[[nodiscard]] const CorrectionLayer* find_correction_layer(const Scenario& scenario, std::string_view name);

/// Size used for collision, m: measured size less the clearance.
[[nodiscard]] inline Vector3 collision_size(const Scenario& scenario, const Parcel& parcel) {
  return parcel.size - Vector3::Constant(scenario.parcel_clearance);
}

/// Ids of the first `count` items, or of all where there are fewer.
[[nodiscard]] std::vector<std::string> first_parcels(const Sequence& sequence, int count);
/// Report eq. (1): percent of the container's inner volume filled by these boxes (measured sizes).
[[nodiscard]] double compute_filling_degree_percent(const Scenario& scenario, const Container& container,
                                                    const std::vector<std::string>& parcel_ids);

}  // namespace snug::model
