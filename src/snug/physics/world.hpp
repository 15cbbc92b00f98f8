// World: rigid bodies that touch. What never changes, what does, and one step from now to the next instant.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/core/bounded_vector.hpp"
#include "snug/geometry/manifold.hpp"
#include "snug/physics/force_element.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::physics {

struct BodyId {
  int index = -1;
  [[nodiscard]] bool is_valid() const { return index >= 0; }
  auto operator<=>(const BodyId&) const = default;
};

enum class BodyKind { Static, Kinematic, Dynamic };

/// One convex part of a body.
struct Geom {
  geometry::Shape shape;
  Pose X_BG;                      ///< in the body frame
  int material = 0;               ///< index into WorldModel::laws
  bool touches_held_body = true;  ///< false: ignores the body named in WorldInput::held
  /// m/s, of the surface against the body, in the body frame: a belt that runs. What of it is along a contact's
  /// tangents counts, so that the faces a belt is square to do not push.
  Vector3 surface_velocity = Vector3::Zero();
  bool operator==(const Geom&) const = default;
};

struct BodyModel {
  std::string name;
  BodyKind kind = BodyKind::Dynamic;
  SpatialInertia inertia;  ///< used by dynamic bodies only
  std::vector<Geom> geoms;
  Pose X_WB;  ///< at the start; static bodies keep it
  bool operator==(const BodyModel&) const = default;
};

/// Where a face that lies on another bears, and so where its friction acts. docs/theory/contact.md, section 3.
enum class Bearing {
  Corners,  ///< on the corners of the patch, shared as the solver finds it
  Edges,    ///< evenly along the rim of the patch
  Face,     ///< with a pressure over the patch as even as equilibrium allows
};

/// What happens where two materials touch.
struct ContactLaw {
  double friction = 0.3;            ///< Coulomb coefficient, exact disc
  double restitution = 0.0;         ///< Newton's coefficient, applied above the threshold speed
  double stiffness = 0.0;           ///< N/m of one contact patch; 0: rigid
  double damping = 0.0;             ///< N s/m of one contact patch, with stiffness only
  double travel = 0.0;              ///< m, depth up to which `stiffness` holds; 0: at any depth
  double stiffness_beyond = 0.0;    ///< N/m of one contact patch for each metre deeper than `travel`
  double full_area = 0.0;           ///< m^2, boxes whose faces overlap by less have stiffness and damping in proportion
  double edge_share = 0.02;         ///< share of them that edges and corners have at least, above 0
  double rolling_resistance = 0.0;  ///< m, largest moment about axes in the contact plane per normal force
  double torsional_friction = 0.0;  ///< m, the same about the normal
  /// Damping over the critical one of each point by itself, beside `damping`, with stiffness only: the rebound from a
  /// point is the same for any mass.
  double damping_ratio = 0.0;
  /// Coulomb coefficient where one or two points of the patch bear: corners, edges, balls. Absent: `friction`.
  std::optional<double> edge_friction = std::nullopt;
  Bearing bearing = Bearing::Corners;
  [[nodiscard]] bool resists_turning() const { return rolling_resistance > 0.0 || torsional_friction > 0.0; }
  bool operator==(const ContactLaw&) const = default;
};

struct SleepSettings {
  bool enabled = true;
  double linear_speed = 5e-5;   ///< m/s, below it a body counts as at rest: near what the solver leaves, not slow
  double angular_speed = 5e-4;  ///< rad/s
  double time = 0.25;  ///< s, that all bodies of an island must stay below both, with something that carries them
  bool operator==(const SleepSettings&) const = default;
};

struct StepSettings {
  double dt = 1e-3;                     ///< s
  double tolerance = 1e-7;              ///< m/s, natural-map residual at which the contact solver stops
  int max_sweeps = 400;                 ///< a step that needs more says so
  double restitution_threshold = 0.05;  ///< m/s, slower impacts are plastic
  double position_slop = 1e-7;          ///< m, penetration that is left alone
  double contact_margin = 1e-3;         ///< m, manifolds are kept from this distance on
  SleepSettings sleep;
  bool operator==(const StepSettings&) const = default;
};

/// Constant during a run. Fill the first block, then call finalize().
struct WorldModel {
  std::vector<BodyModel> bodies;
  int material_count = 1;
  std::vector<ContactLaw> laws;      ///< material_count x material_count, symmetric, row-major
  Vector3 gravity{0.0, 0.0, -9.81};  ///< m/s^2
  StepSettings settings;

  /// Derived by finalize().
  struct GeomRef {
    int body = 0;
    int geom = 0;
    bool operator==(const GeomRef&) const = default;
  };
  struct MassProperties {
    double inverse_mass = 0.0;
    Vector3 inverse_inertia = Vector3::Zero();  ///< principal, body-fixed
    Matrix3 R_BI = Matrix3::Identity();         ///< principal axes in the body frame
    double radius = 0.0;                        ///< m, farthest point from the centre of mass
    bool operator==(const MassProperties&) const = default;
  };
  std::vector<GeomRef> geoms;   ///< all geoms, by body
  std::vector<int> first_geom;  ///< of each body, and one past the end
  std::vector<MassProperties> masses;
  std::size_t pair_capacity = 0;

  void finalize();
  [[nodiscard]] const ContactLaw& law(int material_a, int material_b) const {
    return laws[static_cast<std::size_t>(material_a * material_count + material_b)];
  }
  bool operator==(const WorldModel&) const = default;
};

/// Motion of one body. The linear part is that of the centre of mass, in W.
struct BodyState {
  Vector3 p_WBcm = Vector3::Zero();
  Quaternion quat_WB = Quaternion::Identity();
  Vector3 velocity = Vector3::Zero();
  Vector3 angular_velocity = Vector3::Zero();
  double slow_time = 0.0;  ///< s, since when the body has been slow
  int sleep_group = -1;    ///< bodies that fell asleep together; -1: awake
  bool is_present = true;  ///< absent bodies touch nothing and do not move
  bool operator==(const BodyState& other) const;
};

/// One touching point of a pair, remembered from step to step.
struct PairPoint {
  Vector3 p_A = Vector3::Zero();  ///< on A, in A's body frame
  Vector3 p_B = Vector3::Zero();  ///< on B, in B's body frame
  std::uint32_t feature = 0;
  bool operator==(const PairPoint&) const = default;
};

/// Of a pair whose law resists turning: what the last step left.
struct PairTurning {
  double pressed = 0.0;              ///< N s, normal impulse of all points together
  Vector3 moment = Vector3::Zero();  ///< N m s on B along n_A, t_A and n_A x t_A
  bool operator==(const PairTurning& other) const { return pressed == other.pressed && moment == other.moment; }
};

/// Two geoms whose fat boxes overlap, with the manifold found last.
struct PairState {
  std::uint32_t geom_a = 0, geom_b = 0;
  geometry::PairCache cache;
  int count = 0;
  bool is_known = false;        ///< the manifold below belongs to the relative pose below
  bool is_corner_pair = false;  ///< geometry::Manifold::is_corner_pair
  Vector3 p_AB = Vector3::Zero();
  Quaternion quat_AB = Quaternion::Identity();
  double margin = 0.0;             ///< m, up to which the manifold was looked for
  double face_area = 0.0;          ///< m^2, geometry::Manifold::face_area
  Vector3 n_A = Vector3::UnitZ();  ///< from A to B, in A's body frame
  Vector3 t_A = Vector3::UnitX();  ///< first tangent, in A's body frame
  std::array<PairPoint, geometry::kMaxManifoldPoints> points;
  /// N s on B in the last step, at each point, along n_A, t_A and n_A x t_A.
  std::array<std::array<double, 3>, geometry::kMaxManifoldPoints> impulses{};
  PairTurning turning;
  bool operator==(const PairState& other) const;
};

struct FatBox {
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::max());
  Vector3 upper = Vector3::Constant(std::numeric_limits<double>::lowest());
  bool operator==(const FatBox&) const = default;
};

/// Names the workspace and step that left a state as it is, so that the workspace may use again what it knows of it.
struct StepStamp {
  std::uint64_t value = 0;                                  ///< 0: nobody's
  bool operator==(const StepStamp&) const { return true; }  ///< says nothing about the world
};

/// Everything that changes. A copy is a snapshot: stepping it gives the same bytes.
struct WorldState {
  std::int64_t step_index = 0;
  std::vector<BodyState> bodies;
  std::vector<FatBox> fat_boxes;   ///< of each geom
  BoundedVector<PairState> pairs;  ///< sorted by (geom_a, geom_b)
  StepStamp stamp;                 ///< only saves time

  [[nodiscard]] double time(const WorldModel& model) const {
    return static_cast<double>(step_index) * model.settings.dt;
  }
  bool operator==(const WorldState&) const = default;
};

/// Motion of a kinematic body during one step.
struct KinematicTarget {
  BodyId body;
  Pose X_WB_end;  ///< at the end of the step
  /// Twist at the end of the step, linear part at the origin of B, in W. Absent: the mean of the step, as if the speed
  /// changed at its start; what rides on a body that speeds up lags by dt/2 of the change.
  std::optional<Twist> V_WB_end = std::nullopt;
};

/// A force element between a kinematic carrier and a dynamic body.
struct ElementUse {
  const ForceElement* element = nullptr;
  BodyId carrier;  ///< kinematic
  Pose X_CE;       ///< element's frame E in the carrier
  BodyId body;     ///< dynamic
};

/// Constant wrench during one step, about the body's centre of mass, in W.
struct ExternalWrench {
  BodyId body;
  Wrench wrench_W;
};

struct WorldInput {
  std::span<const KinematicTarget> kinematic;
  std::span<const ElementUse> elements;
  std::span<const ExternalWrench> wrenches;
  BodyId held;  ///< geoms with touches_held_body == false ignore it
};

enum class StepStatus {
  Converged,
  NotConverged,  ///< contact solver stopped at max_sweeps; the state is usable, the residual says how good
  NotFinite,     ///< the state or the input of a body is not a number; stop the run. Bad input leaves the state alone
  LostBody,      ///< a body is farther than 1 km from the origin; set_lost() and go on, or stop the run
  TooManyPairs,  ///< more pairs near each other than pair_capacity, or contacts than there is room for; stop the run
};

/// The two bodies of a contact, A and B; invalid when there was none.
struct BodyPair {
  BodyId a, b;
  bool operator==(const BodyPair&) const = default;
};

struct StepReport {
  StepStatus status = StepStatus::Converged;
  int sweeps = 0;                  ///< largest of all islands
  double residual = 0.0;           ///< m/s, natural map of the worst contact, or a bound on it (contact.md, 4)
  int contacts = 0;                ///< points given to the solver
  int awake = 0;                   ///< dynamic bodies that moved
  double worst_penetration = 0.0;  ///< m, rigid contacts, at the start of the step
  BodyPair worst_penetration_pair;
  double worst_compliant_depth = 0.0;  ///< m, compliant contacts, at the start of the step
  BodyPair worst_compliant_pair;
  BodyPair residual_pair;  ///< of the contact with the largest residual; with NotConverged only
  /// With NotConverged: it was proved that no velocities keep all rigid contacts apart, as under a press that a moving
  /// kinematic body closes; the search for them ended there (contact.md, section 4).
  bool is_infeasible = false;
  double element_residual = 0.0;  ///< m/s, of the implicit force elements
  BodyId culprit;                 ///< with NotFinite and LostBody
};

/// A touching point of the last step, for recordings and measurements.
struct ContactReport {
  BodyId a, b;
  Vector3 p_WQ = Vector3::Zero();  ///< m
  Vector3 n_AB_W = Vector3::UnitZ();
  Vector3 force_W = Vector3::Zero();  ///< N, on B
  double phi = 0.0;                   ///< m, at the start of the step
  bool slides = false;                ///< friction is at its limit
};

namespace internal {
struct Scratch;
}

/// Scratch memory of step(); holds no state, at most what it need not compute again. One per simulation under way, and
/// of one model that does not change.
class Workspace {
 public:
  /// `threads` share the work of each step where there is enough of it; the bytes do not depend on their number.
  explicit Workspace(const WorldModel& model, int threads = 1);
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  /// Contacts of the last step that were near enough to matter, in a fixed order. Valid until the next step.
  [[nodiscard]] std::span<const ContactReport> contacts() const;
  internal::Scratch& scratch() { return *scratch_; }

 private:
  std::unique_ptr<internal::Scratch> scratch_;
};

/// The state at the start: bodies at their X_WB, at rest, all awake.
[[nodiscard]] WorldState make_state(const WorldModel& model);

/// Advances one step of model.settings.dt. Never allocates or throws. docs/theory/contact.md.
[[nodiscard]] StepReport step(const WorldModel& model, const WorldInput& input, WorldState& state,
                              Workspace& work) noexcept;

[[nodiscard]] Pose pose_of(const WorldModel& model, const WorldState& state, BodyId body);
/// Twist of the body frame: linear part at the origin of B, in W.
[[nodiscard]] Twist twist_of(const WorldModel& model, const WorldState& state, BodyId body);
/// Moves a body, keeps its velocity, wakes it and its group; a body that does not sleep wakes all: it may carry them.
void set_pose(const WorldModel& model, WorldState& state, BodyId body, const Pose& X_WB);
/// Linear part at the origin of B, in W. Wakes the body and its group.
void set_twist(const WorldModel& model, WorldState& state, BodyId body, const Twist& V_WB);
/// Absent bodies touch nothing and do not move. Taking a body away wakes its group, or all when it does not sleep.
void set_present(WorldState& state, BodyId body, bool is_present);
void wake(WorldState& state, BodyId body);
/// Takes a lost body out of the world: absent from now on, and nothing else changes, since it touched nothing.
void set_lost(WorldState& state, BodyId body);

/// Contacts of a state as its last step left them, those of sleeping bodies included: each point that bears a force.
/// Forces are the impulses of the last step in which the pair was solved, over the time step.
[[nodiscard]] std::vector<ContactReport> bearing_contacts(const WorldModel& model, const WorldState& state);

[[nodiscard]] double kinetic_energy(const WorldModel& model, const WorldState& state);
[[nodiscard]] double potential_energy(const WorldModel& model, const WorldState& state);
/// Over every byte that influences the future.
[[nodiscard]] std::uint64_t hash_of(const WorldState& state);

}  // namespace snug::physics
