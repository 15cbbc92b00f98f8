// Recording: what a simulation leaves behind: where everything was, what touched what, and what happened.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::record {

/// Version of the file layout (docs/formats.md). Readers refuse newer files.
inline constexpr int kFormatVersion = 1;

/// Pose as it is stored: the numbers of a file, not an orthonormal matrix, so that they survive a round trip bit by
/// bit.
struct PoseSample {
  Vector3 p = Vector3::Zero();                       ///< p_AB, m
  Quaternion quat = Quaternion(1.0, 0.0, 0.0, 0.0);  ///< quat_AB, unit; maps B to A. Never normalised by this module

  PoseSample() = default;
  PoseSample(const Vector3& position, const Quaternion& quaternion) : p(position), quat(quaternion) {}
  /// Implicit on purpose: `frame.tool = X_WE;`
  PoseSample(const Pose& X_AB) : p(X_AB.p), quat(X_AB.R) {}

  [[nodiscard]] Pose pose() const { return {quat.normalized().toRotationMatrix(), p}; }
  bool operator==(const PoseSample& other) const { return p == other.p && quat.coeffs() == other.quat.coeffs(); }
};

enum class BodyKind : std::uint8_t { Static = 0, Kinematic = 1, Dynamic = 2 };
enum class ShapeKind : std::uint8_t { Box = 0, Capsule = 1, Hull = 2, Cylinder = 3 };

/// Enough of a shape to draw it. Frame G is the shape's own.
struct ShapeInfo {
  ShapeKind kind = ShapeKind::Box;
  PoseSample X_BG;                 ///< in the body frame B
  Vector3 half = Vector3::Zero();  ///< box: half edge lengths, m
  double radius = 0.0;             ///< capsule: m
  double half_length = 0.0;        ///< capsule: half of the segment along z of G, m
  std::vector<Vector3> vertices;   ///< hull: p_GV, m
  bool operator==(const ShapeInfo&) const = default;
};

/// A body that takes part in the run, from its start to its end.
struct BodyInfo {
  std::string name;  ///< unique, not empty, e.g. "box024"; becomes a column prefix of the CSV
  std::string type;  ///< box type of the scenario ("B3"), or empty
  BodyKind kind = BodyKind::Dynamic;
  double mass = 0.0;              ///< kg; 0 for static and kinematic bodies
  Vector3 com = Vector3::Zero();  ///< p_BBcm, m
  std::vector<ShapeInfo> shapes;
  bool operator==(const BodyInfo&) const = default;
};

/// The container that is packed. Name empty when the scene has none.
struct ContainerInfo {
  std::string name;
  PoseSample X_WT;                       ///< container frame, as the scenario defines it
  PoseSample X_TI;                       ///< I: middle of the inner floor, z up, axes along the inner edges
  Vector3 inner_size = Vector3::Zero();  ///< along the axes of I, m
  bool operator==(const ContainerInfo&) const = default;
};

/// One joint of a robot at one instant.
struct JointSample {
  double position = 0.0;  ///< rad, or m of a prismatic joint
  double velocity = 0.0;  ///< rad/s or m/s
  double torque = 0.0;    ///< that the drive supplies, Nm or N
  bool operator==(const JointSample&) const = default;
};

/// What ran. Fixed when the recording starts.
struct RecordingHeader {
  std::string scenario_text;  ///< the whole file
  std::string program_text;   ///< the whole 13-column file, or empty
  std::string program_name;   ///< its name, or empty
  std::string sequence;       ///< item sequence, or empty
  std::uint64_t seed = 0;
  std::string version;          ///< snug version and commit
  std::string settings = "{}";  ///< settings of the run that are not in the scenario, JSON
  double dt = 0.0;              ///< length of a simulation step, s
  double record_period = 0.0;   ///< time between frames, s, > 0
  std::vector<BodyInfo> bodies;
  std::vector<std::string> joints;  ///< names, base to tool; empty without a robot
  ContainerInfo container;
  bool operator==(const RecordingHeader&) const = default;
};

/// State of one body in one frame.
struct BodySample {
  bool present = true;  ///< false: not in the cell (yet); pose and twist then mean nothing and are stored as NaN
  PoseSample X_WB;
  Twist V_WB;  ///< in W; linear part at the origin of B
  bool operator==(const BodySample&) const = default;
};

enum class ContactState : std::uint8_t { Unknown = 0, Open = 1, Sticking = 2, Sliding = 3 };

/// One contact point. Stored in single precision, rounded to kPointQuantum, kForceQuantum, kGapQuantum.
struct ContactSample {
  int body_a = -1;  ///< index into RecordingHeader::bodies
  int body_b = -1;
  Vector3 p_WQ = Vector3::Zero();       ///< m
  Vector3 n_AB_W = Vector3::UnitZ();    ///< unit, from A to B
  Vector3 force_B_W = Vector3::Zero();  ///< force on B (minus it acts on A), N
  double phi = 0.0;                     ///< signed gap, m, positive apart
  ContactState state = ContactState::Unknown;
  bool operator==(const ContactSample&) const = default;
};

/// Rounding of contacts in the file. It lets a contact at rest repeat exactly, and so be stored once.
inline constexpr double kPointQuantum = 0x1.0p-20;  ///< m, about 1 um; also for the normal (no unit)
inline constexpr double kForceQuantum = 0x1.0p-13;  ///< N, about 0.12 mN
inline constexpr double kGapQuantum = 0x1.0p-27;    ///< m, about 7.5 nm

/// Suction cup. E: control point at the gripper's end; S: lip; P: the package held.
struct CupSample {
  bool vacuum_command = false;
  bool blow_off_command = false;
  double pressure_gauge = 0.0;  ///< Pa, vacuum is negative
  int attached_body = -1;       ///< index into RecordingHeader::bodies, -1: holds nothing
  PoseSample X_ES;              ///< deformation: lip in the control point's frame
  double length = 0.0;          ///< distance E to S along z of E, m
  double bend = 0.0;            ///< angle between the z axes of E and S, rad
  Wrench F_PSo_S;               ///< of the cup on the package, about the origin of S, in S
  bool operator==(const CupSample&) const = default;
};

enum class SolverStatus : std::uint8_t { Converged = 0, NotConverged = 1, NothingToSolve = 2, Failed = 3 };

/// How well the contact solver did in the step that ended at this frame.
struct SolverSample {
  double residual = 0.0;
  int iterations = 0;
  SolverStatus status = SolverStatus::Converged;
  bool operator==(const SolverSample&) const = default;
};

/// Everything at one instant. Reuse one object for all frames of a run: its vectors keep their memory.
struct Frame {
  double time = 0.0;        ///< s, strictly increasing from frame to frame
  std::int64_t step = 0;    ///< simulation steps done; time = step * dt
  int program_row = -1;     ///< 0-based row of the program being approached, -1: none
  PoseSample X_WE;          ///< tool as it is
  Twist V_WE;               ///< in W, linear part at the origin of E
  PoseSample X_WE_command;  ///< tool as commanded by the reference
  CupSample cup;
  /// Wrench of the tool and all it carries or touches on the flange, about the flange's origin, in the flange's
  /// frame F: a hanging load pulls it down. With a robot: what its force/torque sensor reads, in the sensor's frame.
  Wrench F_flange;
  std::vector<BodySample> bodies;   ///< one per RecordingHeader::bodies, in that order
  std::vector<JointSample> joints;  ///< one per RecordingHeader::joints, in that order
  std::vector<ContactSample> contacts;
  SolverSample solver;
  bool operator==(const Frame&) const = default;
};

/// A named number of an event, e.g. {"shear_N", 41.2}. The unit belongs to the name.
struct EventNumber {
  std::string name;
  double value = 0.0;
  bool operator==(const EventNumber&) const = default;
};

/// Something that happened: seal, no seal, slip, flip, release, a warning. In the file the text is cut after 1024
/// bytes, the other words and the names of numbers after 64.
struct Event {
  double time = 0.0;  ///< s
  std::string kind;   ///< short, stable word, e.g. "seal"
  std::string body;   ///< name of the body concerned, or empty
  std::string text;   ///< for people
  std::vector<EventNumber> numbers;
  bool operator==(const Event&) const = default;
};

struct Recording {
  RecordingHeader header;
  std::vector<Frame> frames;
  std::vector<Event> events;
  /// Did the writer end in order? False for the file of a run that was killed.
  bool is_complete = true;
  std::string result;  ///< what became of the run, JSON; empty when it was not stored
  bool operator==(const Recording&) const = default;
};

/// Index of the body of that name, or -1.
[[nodiscard]] int find_body(const RecordingHeader& header, std::string_view name);

}  // namespace snug::record
