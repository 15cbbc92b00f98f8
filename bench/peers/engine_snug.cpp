// SnugEngine: our own physics behind the interface of the comparison, with the settings that scenarios have by default.
#include <algorithm>
#include <memory>
#include <optional>

#include "peers/engine.hpp"
#include "snug/cup/suction_cup.hpp"
#include "snug/model/scenario.hpp"
#include "snug/physics/world.hpp"

namespace snug::peers {
namespace {

constexpr int kBox = 0, kFixed = 1;  // materials

class SnugEngine final : public Engine {
 public:
  explicit SnugEngine(const SnugSettings& settings) : settings_(settings) {}

  void build(const Scene& scene, double dt) override {
    model_ = physics::WorldModel{};
    const model::SolverSettings solver;
    model_.settings.dt = dt;
    model_.settings.tolerance = solver.tolerance;
    model_.settings.max_sweeps = solver.max_sweeps;
    model_.settings.restitution_threshold = solver.restitution_threshold;
    model_.settings.position_slop = solver.position_slop;
    model_.settings.contact_margin = solver.contact_margin;
    model_.settings.sleep.enabled = false;
    model_.gravity = scene.gravity;
    model_.material_count = 2;
    physics::ContactLaw box_box{scene.box_box.friction, scene.box_box.restitution, 0.0, 0.0};
    const Contact& fixed = scene.box_container;
    physics::ContactLaw box_fixed{fixed.friction, fixed.restitution, fixed.stiffness, 0.0};
    box_fixed.damping_ratio = fixed.snug_damping_ratio;
    box_fixed.edge_friction = fixed.edge_friction;
    if (settings_.bears_on_faces) box_box.bearing = box_fixed.bearing = physics::Bearing::Face;
    model_.laws = {box_box, box_fixed, box_fixed, box_fixed};
    for (const BoxBody& box : scene.bodies) model_.bodies.push_back(body_of(box));
    plane_ = static_cast<int>(model_.bodies.size());
    if (scene.has_plane) {
      constexpr double kHalf = 10.0;
      BoxBody plane{.name = "plane", .half = Vector3::Constant(kHalf)};
      plane.X_WB.p.z() = scene.plane_height - kHalf;
      model_.bodies.push_back(body_of(plane));
    }
    holder_ = physics::BodyId{static_cast<int>(model_.bodies.size())};
    model_.bodies.push_back({"holder", physics::BodyKind::Kinematic, {}, {}, {}});
    model_.finalize();
    state_ = physics::make_state(model_);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (!scene.bodies[i].is_present) physics::set_present(state_, physics::BodyId{static_cast<int>(i)}, false);
    }
    work_.emplace(model_);
    has_failed_ = false;
    wrenches_.clear();
    is_pulled_ = false;
  }

  void step() override {
    physics::KinematicTarget target{holder_, holder_end_};
    physics::ElementUse use{&spring_, holder_, Pose{}, pulled_};
    physics::WorldInput input;
    input.wrenches = wrenches_;
    if (is_pulled_) {
      input.kinematic = {&target, 1};
      input.elements = {&use, 1};
    }
    const physics::StepReport report = physics::step(model_, input, state_, *work_);
    has_failed_ = has_failed_ || (report.status != physics::StepStatus::Converged &&
                                  report.status != physics::StepStatus::NotConverged);
    wrenches_.clear();
    is_pulled_ = false;
  }

  [[nodiscard]] bool has_failed() const override { return has_failed_; }
  [[nodiscard]] Pose pose(int body) const override { return physics::pose_of(model_, state_, physics::BodyId{body}); }
  [[nodiscard]] Twist velocity(int body) const override {
    return physics::twist_of(model_, state_, physics::BodyId{body});
  }
  void set_motion(int body, const Pose& X_WB, const Twist& V_WB) override {
    physics::set_pose(model_, state_, physics::BodyId{body}, X_WB);
    physics::set_twist(model_, state_, physics::BodyId{body}, V_WB);
  }
  void insert(int body, const Pose& X_WB) override {
    physics::set_present(state_, physics::BodyId{body}, true);
    set_motion(body, X_WB, Twist{});
  }
  void apply_wrench(int body, const Wrench& wrench_W) override {
    wrenches_.push_back({physics::BodyId{body}, wrench_W});
  }
  [[nodiscard]] double normal_force(int body_a, int body_b) const override {
    const int a = body_a == kPlane ? plane_ : body_a, b = body_b == kPlane ? plane_ : body_b;
    double sum = 0.0;
    for (const physics::ContactReport& contact : work_->contacts()) {
      const bool is_pair =
          (contact.a.index == a && contact.b.index == b) || (contact.a.index == b && contact.b.index == a);
      if (is_pair) sum += contact.n_AB_W.dot(contact.force_W);
    }
    return sum;
  }

  /// The law of the cup with the spring's values, implicit in the step.
  void pull(int body, const Spring& spring, const HolderMotion& begin, const HolderMotion& end) override {
    Vector6 stiffness, damping;
    stiffness << spring.stiffness, spring.rotational_stiffness;
    damping << spring.damping, spring.rotational_damping;
    spring_ = cup::SuctionCup(stiffness.asDiagonal(), damping.asDiagonal(), Pose{},
                              Pose{Matrix3::Identity(), spring.p_BA}, Pose{});
    pulled_ = physics::BodyId{body};
    physics::set_pose(model_, state_, holder_, begin.X_WE);
    holder_end_ = end.X_WE;
    is_pulled_ = true;
  }

 private:
  static physics::BodyModel body_of(const BoxBody& box) {
    physics::BodyModel body;
    body.name = box.name;
    body.kind = box.mass > 0.0 ? physics::BodyKind::Dynamic : physics::BodyKind::Static;
    body.inertia.mass = std::max(box.mass, 1.0);
    if (box.mass > 0.0) {
      body.inertia.mass = box.mass;
      body.inertia.inertia = moments_of(box).asDiagonal();
    }
    geometry::Shape shape = geometry::Box{box.half};
    if (box.is_round) shape = geometry::Cylinder{box.half.z(), box.half.x()};
    body.geoms = {{shape, Pose{Matrix3::Identity(), box.middle}, box.mass > 0.0 ? kBox : kFixed, true}};
    body.X_WB = box.X_WB;
    return body;
  }

  SnugSettings settings_;
  physics::WorldModel model_;
  physics::WorldState state_;
  std::optional<physics::Workspace> work_;
  std::vector<physics::ExternalWrench> wrenches_;
  cup::SuctionCup spring_;
  physics::BodyId pulled_, holder_;
  Pose holder_end_;
  int plane_ = 0;
  bool is_pulled_ = false, has_failed_ = false;
};

}  // namespace

std::unique_ptr<Engine> make_snug(const SnugSettings& settings) { return std::make_unique<SnugEngine>(settings); }

}  // namespace snug::peers
