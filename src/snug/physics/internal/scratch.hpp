// Scratch: what a step works with and forgets.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "snug/core/bounded_vector.hpp"
#include "snug/core/worker_pool.hpp"
#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_newton.hpp"
#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/internal/element_bodies.hpp"
#include "snug/physics/internal/position_correction.hpp"
#include "snug/physics/internal/shared_supports.hpp"
#include "snug/physics/world.hpp"

namespace snug::physics::internal {

/// Pose and velocity of a body during the step, world frame.
struct BodyWork {
  Matrix3 R_WB = Matrix3::Identity();
  Vector3 p_WB = Vector3::Zero();            ///< origin of B
  Vector3 p_WBcm = Vector3::Zero();          ///< the point its velocity belongs to
  Vector3 velocity_start = Vector3::Zero();  ///< of that point; kinematic: half of this and `velocity` is the mean
  Vector3 angular_start = Vector3::Zero();
  Vector3 velocity = Vector3::Zero();  ///< at the end of the step; before the solver: without contacts
  Vector3 angular = Vector3::Zero();
  Vector3 angular_guess = Vector3::Zero();  ///< at the end of the step, with the impulses of the step before
  bool turns = false;                       ///< beyond rounding: contacts that last follow it
  double speed = 0.0;                       ///< bound on the speed of any of its points, m/s
  int active = -1;                          ///< index among the bodies that move in this step
  int island = -1;                          ///< of a body with an element
  bool is_moving = false;                   ///< dynamic and awake, or kinematic with a motion
  bool has_element = false;
  bool is_lone = false;        ///< find_lone_body(): what it bears on may follow its path
  bool has_same_pose = false;  ///< as in this workspace's last step, bit by bit
  bool is_steady = false;      ///< and enters the rows of its contacts as it did then
  bool has_result = false;     ///< velocity holds the answer of the contact solver
};

/// What a workspace remembers of a body's last step.
struct BodyMemory {
  Vector3 p_WBcm = Vector3::Zero();
  Quaternion quat_WB = Quaternion::Identity();
  int active = -1;
  bool is_plain = false;  ///< neither turning, nor with an element, nor a moving kinematic body
};

/// What a workspace remembers of a pair.
struct PairMemory {
  int body_a = 0, body_b = 0;
  int patch = -1;
  double clearance = 0.0;   ///< m, no point nearer than this
  std::uint64_t stamp = 0;  ///< of the step in which this was so
};

/// What the walk over the pairs has to know of a pair that was looked at before.
struct PairVisit {
  static constexpr int kNone = -1;
  int count = kNone;        ///< points that matter in this step
  bool touches = false;     ///< one of them
  double clearance = 0.0;   ///< m, no point nearer than this
  double reach_from = 0.0;  ///< m, the same points for any reach from here
  double reach_to = 0.0;    ///< m, to below here
};

/// Maps impulses to velocities of one moving body: v = T u with T T^T = inverse mass, so that every row of the
/// contact problem is J T and the mass disappears from the sweeps.
struct Whitening {
  double linear = 0.0;                ///< 1/sqrt(mass)
  Matrix3 angular = Matrix3::Zero();  ///< R_WI diag(1/sqrt(I))
  const Matrix6* dense = nullptr;     ///< T of a body with an implicit force element, in Scratch::dense_whitening
};

/// The contacts of one pair: they share bodies, normal and law.
struct Patch {
  std::uint32_t pair = 0;
  int body_a = 0, body_b = 0;
  int first_contact = 0;
  int contact_count = 0;
  int row_count = 0;  ///< contacts, and what resists turning
  int first_row = 0;
  int island = 0;
  int plane = -1;                ///< in SharedSupports::orders, of the first patch of a plane
  double reach_from = 0.0;       ///< m, has the same contacts for any reach from here
  double reach_to = 0.0;         ///< m, to below here
  bool is_kept = false;          ///< the same as in the last step, at the same place
  Vector3 n = Vector3::UnitZ();  ///< from A to B, W
  Vector3 t1 = Vector3::UnitX(), t2 = Vector3::UnitY();
  std::size_t law = 0;          ///< in WorldModel::laws
  double share = 1.0;           ///< of the law's stiffness and damping
  bool has_belt = false;        ///< one of the surfaces runs
  bool moves_friction = false;  ///< friction of its contacts acts at Scratch::friction_points
  bool is_shared = false;       ///< one of several supports of a face that bears on edges or as a face
  bool is_swept = false;        ///< found at the end of the step: arms and normal are those of there
  Vector3 way_a = Vector3::Zero(), way_b = Vector3::Zero();  ///< swept: of the centres of mass, in this step
  Vector3 belt_W = Vector3::Zero();  ///< of B's surface against A's, beyond the motion of the bodies, m/s
};

/// A touching point that may matter in this step.
struct Contact {
  Vector3 p_WQ = Vector3::Zero();
  double phi = 0.0;
  double approach = 0.0;  ///< normal relative velocity at the start of the step, m/s
  int patch = 0;
  int point = 0;            ///< of the pair's manifold; swept: -1
  bool is_covered = false;  ///< bears nothing: others around it, of the same face and plane, do
};

/// Where the friction of a contact acts that stands for a part of a face, and the fraction of it that is left where the
/// part turns about a point within.
struct FrictionPoint {
  Vector3 p_WQ = Vector3::Zero();
  double fraction = 1.0;
  bool operator==(const FrictionPoint& other) const { return p_WQ == other.p_WQ && fraction == other.fraction; }
};

/// Of one pair.
using PairContacts = std::array<Contact, geometry::kMaxManifoldPoints>;

struct Island {
  int first_patch = 0;  ///< in Scratch::patch_order
  int end_patch = 0;
  int first_row = 0;
  int end_row = 0;
  bool has_element = false;
  bool has_turning = false;    ///< rows that resist turning
  bool is_infeasible = false;  ///< once solved: no velocities keep its contacts apart
  bool is_carried = false;     ///< once solved: by something that the solver does not move
};

/// What a body moves by in a step.
struct Displacement {
  Vector3 way = Vector3::Zero();       ///< m, of the centre of mass
  Vector3 rotation = Vector3::Zero();  ///< rad
};

/// Where a body is at the end of the step as solved.
struct BodyEnd {
  Pose X_WB;
  Vector3 p_WBcm = Vector3::Zero();
  Displacement displacement;
  bool turns_fast = false;
};

/// What one thread solves islands with.
struct IslandWorker {
  NewtonScratch newton;
  PositionCorrection positions;
  std::vector<ElementBody> element_bodies;  ///< of the island being solved
  StepReport report;                        ///< of its islands of this step
};

struct Scratch {
  Scratch(const WorldModel& model, int threads);

  WorkerPool pool;
  std::vector<IslandWorker> workers;  ///< one of each of the pool's
  SolverThreads solver_threads;       ///< all of them, for one island

  std::uint64_t stamp = 0;  ///< of the state that the memories and the arrays below belong to
  bool knows_state = false;
  bool knows_pairs = false;  ///< the memories of pairs hold
  std::vector<BodyMemory> memories;
  BoundedVector<PairMemory> pair_memories;  ///< of each pair
  BoundedVector<PairVisit> visits;          ///< of each pair, if has_visits
  bool has_visits = false;
  std::size_t last_rows = 0;  ///< rows of the last step

  std::vector<BodyWork> bodies;
  std::vector<int> active;  ///< bodies that move in this step; [0, active_count)
  int active_count = 0;
  std::vector<ElementQuery> carriers;      ///< of each element in use, at the middle of the step
  std::vector<Whitening> whitening;        ///< by active index
  BoundedVector<Matrix6> dense_whitening;  ///< by active index, where there are elements
  std::vector<Vector3>
      last_torque;               ///< N m s, by active index: of the contacts of the step before, where that turns fast
  std::vector<Vector3> centres;  ///< p_WBcm, by active index
  std::vector<double> u;         ///< 6 per active body
  std::vector<double> shift;     ///< 6 per active body, position correction in whitened coordinates
  std::vector<BodyEnd> ends;     ///< of each body; of steps in which one turns fast
  std::vector<int> parent;       ///< union-find over active bodies
  std::vector<int> island_of_root;
  BoundedVector<Patch> patches;
  BoundedVector<Contact> contacts;             ///< by patch
  std::vector<FrictionPoint> friction_points;  ///< of each contact, where its patch says so; empty: no law needs them
  PairContacts no_room;                        ///< where contacts go that are too many
  BoundedVector<int> patch_order;              ///< patches by island
  BoundedVector<Row> rows;
  int row_count = 0;  ///< of this step's islands
  BoundedVector<ContactReport> reports;
  bool has_reports = false;
  double dt = 0.0;
  std::vector<Island> islands;
  int island_count = 0;
  std::vector<int> island_order;  ///< those with most rows first
  bool has_too_many_contacts = false;
  bool has_belts = false;         ///< the model: surfaces that run
  bool has_corner_pairs = false;  ///< among the pairs of rigid geoms that were looked at
  SharedSupports shared_supports;
  LostImpulses lost_impulses;

  std::vector<std::uint64_t> keys, old_keys, new_keys;  ///< of pairs: all, those before, those of boxes that moved
  BoundedVector<int> pair_origin;                       ///< of each key: its place among the old ones
  std::vector<int> moved;
  std::vector<char> is_moved;
  std::vector<int> sweep_order;
  BoundedVector<char> pair_done;           ///< of each pair
  std::vector<char> is_moving;             ///< of each body, side by side for the walk over the pairs
  std::vector<std::uint64_t> still_since;  ///< of each body: stamp of the first step in its present pose
};

// The stages of a step, in order.

/// Poses, velocities and the list of moving bodies. False when nothing moves.
bool begin_step(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work);
/// Keeps state.pairs equal to the geoms whose fat boxes overlap. False: too many pairs.
bool update_pairs(const WorldModel& model, WorldState& state, Scratch& work);
/// Manifolds of all pairs that matter, wakes what is touched, fills work.patches and work.contacts.
void detect_contacts(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work,
                     StepReport& report);
/// Of faces that lie on several fixed geoms in one plane, contacts within the convex hull of all: rigid bodies need
/// them for nothing, and they would make what bears depend on the order of the file.
void mark_covered_contacts(const WorldModel& model, WorldState& state, Scratch& work);
/// Of laws that bear on edges or faces: evens the loads of the step before and places friction.
void bear_on_faces(const WorldModel& model, WorldState& state, Scratch& work);
/// The same for a face on several supports of one plane: patches, and all of their contacts, of which those on the rim
/// are not covered. False: more of these than a face has.
bool bear_on_plane(const WorldModel& model, std::span<const int> patches, std::span<const int> contacts,
                   WorldState& state, Scratch& work);
/// Puts the rows of a face on several supports of one plane into the order in which one slab has them, or back into
/// their own. What sweeps leave open depends on it.
void arrange_planes(const Island& island, bool is_as_one_slab, Scratch& work);
/// Marks a sleeping group as moving, from within a step.
void wake_group(const WorldModel& model, WorldState& state, Scratch& work, int group);
/// Velocities at the end of the step without contacts (bodies with force elements: done in solve_islands).
void free_motion(const WorldModel& model, const WorldInput& input, const WorldState& state, Scratch& work);
void build_islands(const WorldInput& input, Scratch& work);
/// Velocities at the end of the step; leaves the impulses in the state.
void solve_islands(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work,
                   StepReport& report);
/// What a body moves by in this step as solved.
[[nodiscard]] Displacement displacement_of(const Scratch& work, int body);
enum class Swept {
  Nothing,   ///< the step stands
  Contacts,  ///< were added to work.patches: the step is to be solved again
  Sleepers,  ///< were woken: contacts are to be found and the step is to be solved again
};
/// Looks where bodies that turn fast are at the end of the step as solved, and what they run into there.
[[nodiscard]] Swept add_swept_contacts(const WorldModel& model, WorldState& state, Scratch& work);
/// Positions, penetration, sleep.
void end_step(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work, StepReport& report);
/// Fills work.reports, once a step and only when somebody asks.
void report_contacts(Scratch& work);

[[nodiscard]] Whitening plain_whitening(const WorldModel::MassProperties& mass, const Matrix3& R_WB);
/// u = T^-1 v.
[[nodiscard]] Vector6 whiten(const Whitening& whitening, const Vector3& linear, const Vector3& angular);
/// v = T u.
void unwhiten(const Whitening& whitening, const double* u, Vector3& linear, Vector3& angular);

/// Rows of an island, from the free velocities in work.u. The first time with the impulses of the step before, later
/// with those of the row. `pool`: threads to use, or nullptr.
void build_rows(const WorldModel& model, const WorldState& state, Scratch& work, const Island& island, bool is_first,
                WorkerPool* pool);

constexpr int kMaxTurningRows = 2;  ///< of a patch
[[nodiscard]] int count_turning_rows(const ContactLaw& law);
/// Rows that resist turning, behind the contacts of the patch. Returns the end of them.
Row* build_turning_rows(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch,
                        bool is_kept, bool is_first, Row* row);
/// What the next step starts from.
void keep_moment(const Row& row, const Scratch& work, const Patch& patch, PairState& pair);

// The contact problem of one island (contact_solver.cpp).

struct SolveResult {
  int iterations = 0;  ///< sweeps of Gauss-Seidel and steps of Newton's method
  double residual = 0.0;
  bool has_converged = true;
  bool is_infeasible = false;  ///< proved: StepReport::is_infeasible
};
[[nodiscard]] SolveResult solve_rows(const StepSettings& settings, const Residuals& residuals, Row* first, Row* end,
                                     double* u, NewtonScratch& newton) noexcept;
/// The same where rows resist turning: again with the normal impulses found as bounds, until they agree or nearly so.
[[nodiscard]] SolveResult solve_with_turning(const StepSettings& settings, const Residuals& residuals, Row* first,
                                             Row* end, double* u, NewtonScratch& newton) noexcept;

}  // namespace snug::physics::internal
