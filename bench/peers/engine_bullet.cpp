// Engine over Debian's Bullet, double precision: sequential impulses on boxes and a plane.
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "peers/engine.hpp"

namespace snug::peers {

static_assert(sizeof(btScalar) == 8, "needs BT_USE_DOUBLE_PRECISION and the -float64 libraries");

namespace {

btVector3 to_bullet(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
Vector3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform to_bullet(const Pose& X) {
  const Matrix3& R = X.R;
  const btMatrix3x3 basis(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2));
  return btTransform(basis, to_bullet(X.p));
}

Pose from_bullet(const btTransform& X) {
  Pose pose;
  for (int i = 0; i < 3; ++i) pose.R.row(i) = from_bullet(X.getBasis()[i]).transpose();
  pose.p = from_bullet(X.getOrigin());
  return pose;
}

class BulletEngine final : public Engine {
 public:
  explicit BulletEngine(const BulletSettings& settings) : settings_(settings) {}
  ~BulletEngine() override { clear(); }
  BulletEngine(const BulletEngine&) = delete;
  BulletEngine& operator=(const BulletEngine&) = delete;

  void build(const Scene& scene, double dt) override {
    clear();
    dt_ = dt;
    dispatcher_ = std::make_unique<btCollisionDispatcher>(&configuration_);
    broadphase_ = std::make_unique<btDbvtBroadphase>();
    world_ = std::make_unique<btDiscreteDynamicsWorld>(dispatcher_.get(), broadphase_.get(), &solver_, &configuration_);
    world_->setGravity(to_bullet(scene.gravity));
    btContactSolverInfo& info = world_->getSolverInfo();
    info.m_numIterations = settings_.iterations;
    if (settings_.use_two_friction_directions) info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    for (const BoxBody& box : scene.bodies) add(scene, box);
    if (scene.has_plane) add_plane(scene);
  }

  void step() override { world_->stepSimulation(dt_, 0); }

  Pose pose(int body) const override { return from_bullet(at(body).getWorldTransform()); }
  Twist velocity(int body) const override {
    return {from_bullet(at(body).getLinearVelocity()), from_bullet(at(body).getAngularVelocity())};
  }

  void set_motion(int body, const Pose& X_WB, const Twist& V_WB) override {
    btRigidBody& rigid = at(body);
    rigid.setWorldTransform(to_bullet(X_WB));
    rigid.setInterpolationWorldTransform(to_bullet(X_WB));
    rigid.setLinearVelocity(to_bullet(V_WB.linear));
    rigid.setAngularVelocity(to_bullet(V_WB.angular));
    rigid.updateInertiaTensor();
  }

  void insert(int body, const Pose& X_WB) override {
    set_motion(body, X_WB, {});
    world_->addRigidBody(&at(body));
  }

  void apply_wrench(int body, const Wrench& wrench_W) override {
    at(body).applyCentralForce(to_bullet(wrench_W.force));
    at(body).applyTorque(to_bullet(wrench_W.torque));
  }

  double normal_force(int body_a, int body_b) const override {
    const btCollisionObject* a = &at(body_a);
    const btCollisionObject* b = &at(body_b);
    double impulse = 0.0;
    for (int i = 0; i < dispatcher_->getNumManifolds(); ++i) {
      const btPersistentManifold& pair = *dispatcher_->getManifoldByIndexInternal(i);
      const bool is_ours =
          (pair.getBody0() == a && pair.getBody1() == b) || (pair.getBody0() == b && pair.getBody1() == a);
      for (int k = 0; is_ours && k < pair.getNumContacts(); ++k) impulse += pair.getContactPoint(k).getAppliedImpulse();
    }
    return impulse / dt_;
  }

 private:
  /// Bullet multiplies the values of the two bodies: a box gets the root of the box-box value.
  static void set_contact(btRigidBody& body, const Scene& scene, bool is_box) {
    const double friction = std::sqrt(scene.box_box.friction), restitution = std::sqrt(scene.box_box.restitution);
    body.setFriction(is_box ? friction : scene.box_container.friction / friction);
    body.setRestitution(is_box || restitution == 0.0 ? restitution : scene.box_container.restitution / restitution);
  }

  void add(const Scene& scene, const BoxBody& box) {
    if (box.is_round) {
      shapes_.push_back(std::make_unique<btCylinderShapeZ>(to_bullet(box.half)));
    } else {
      shapes_.push_back(std::make_unique<btBoxShape>(to_bullet(box.half)));
    }
    btVector3 inertia(0, 0, 0);
    if (box.mass > 0) shapes_.back()->calculateLocalInertia(box.mass, inertia);
    inertia *= box.inertia_factor;
    if (box.middle != Vector3::Zero()) {
      auto aside = std::make_unique<btCompoundShape>();
      aside->addChildShape(btTransform(btQuaternion::getIdentity(), to_bullet(box.middle)), shapes_.back().get());
      shapes_.push_back(std::move(aside));
    }
    bodies_.push_back(std::make_unique<btRigidBody>(box.mass, nullptr, shapes_.back().get(), inertia));
    btRigidBody& body = *bodies_.back();
    body.setWorldTransform(to_bullet(box.X_WB));
    body.setInterpolationWorldTransform(to_bullet(box.X_WB));
    set_contact(body, scene, box.mass > 0);
    // Bullet adds the softness of both bodies as springs in a row: only what is fixed has it.
    if (!(box.mass > 0) && scene.box_container.stiffness > 0.0)
      body.setContactStiffnessAndDamping(scene.box_container.stiffness, scene.box_container.damping);
    body.setActivationState(DISABLE_DEACTIVATION);
    if (box.is_present) world_->addRigidBody(&body);
  }

  /// A large box: against Bullet's own plane a box gets one contact point a step, and stops 2 % short in S3.
  void add_plane(const Scene& scene) {
    const Vector3 half(5.0, 5.0, 0.5);
    BoxBody plane{.name = "plane", .half = half};
    plane.X_WB.p.z() = scene.plane_height - half.z();
    add(scene, plane);
  }

  /// The plane, if any, is the last body.
  btRigidBody& at(int body) const {
    return *(body == kPlane ? bodies_.back() : bodies_.at(static_cast<std::size_t>(body)));
  }

  void clear() {
    for (const auto& body : bodies_) {
      if (body->isInWorld()) world_->removeRigidBody(body.get());
    }
    world_.reset();
    bodies_.clear();
    shapes_.clear();
    broadphase_.reset();
    dispatcher_.reset();
    solver_.reset();
  }

  BulletSettings settings_;
  double dt_ = 1e-3;
  btDefaultCollisionConfiguration configuration_;
  btSequentialImpulseConstraintSolver solver_;
  std::unique_ptr<btCollisionDispatcher> dispatcher_;
  std::unique_ptr<btDbvtBroadphase> broadphase_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
};

}  // namespace

std::unique_ptr<Engine> make_bullet(const BulletSettings& settings) { return std::make_unique<BulletEngine>(settings); }

}  // namespace snug::peers
