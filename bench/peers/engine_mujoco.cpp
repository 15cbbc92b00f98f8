// Engine over Debian's MuJoCo: free boxes, contact pairs of the default kind, Newton solver.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "peers/engine.hpp"

namespace snug::peers {

namespace {

struct Deleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

/// The container's friction has priority, so that a box touches it with box_container and another box with box_box.
std::string geom_xml(const BoxBody& box, const Scene& scene) {
  const bool is_box = box.mass > 0;
  const Quaternion quat(box.X_WB.R);
  const Vector3& p = box.X_WB.p;
  const std::string place =
      fmt::format(R"(pos="{} {} {}" quat="{} {} {} {}")", p.x(), p.y(), p.z(), quat.w(), quat.x(), quat.y(), quat.z());
  const std::string size = box.is_round ? fmt::format("{} {}", box.half.x(), box.half.z())
                                        : fmt::format("{} {} {}", box.half.x(), box.half.y(), box.half.z());
  const std::string geom =
      fmt::format(R"(type="{}" size="{}" friction="{} 0.005 0.0001")", box.is_round ? "cylinder" : "box", size,
                  is_box ? scene.box_box.friction : scene.box_container.friction);
  if (!is_box) return fmt::format("<geom {} {} priority=\"1\"/>\n", place, geom);
  if (box.inertia_factor != 1.0) {
    const Vector3 moments = moments_of(box);
    return fmt::format(
        "<body {}><freejoint/><inertial pos=\"0 0 0\" mass=\"{}\" diaginertia=\"{} {} {}\"/><geom {} pos=\"{} {} "
        "{}\"/></body>\n",
        place, box.mass, moments.x(), moments.y(), moments.z(), geom, box.middle.x(), box.middle.y(), box.middle.z());
  }
  return fmt::format("<body {}><freejoint/><geom {} mass=\"{}\"/></body>\n", place, geom, box.mass);
}

std::string scene_xml(const Scene& scene, const MujocoSettings& settings, double dt) {
  std::string bodies;
  for (const BoxBody& box : scene.bodies) bodies += geom_xml(box, scene);
  if (scene.has_plane) {
    const Contact& contact = scene.box_container;
    const std::string soft = contact.time_constant > 0.0
                                 ? fmt::format("solref=\"{} {}\" solimp=\"{} {} 0.001\"", contact.time_constant,
                                               contact.damping_ratio, contact.impedance, settings.impedance_max)
                                 : "";
    bodies +=
        fmt::format(R"(<geom type="plane" size="5 5 1" pos="0 0 {}" friction="{} 0.005 0.0001" priority="1" {}/>)",
                    scene.plane_height, contact.friction, soft);
  }
  return fmt::format(
      R"(<mujoco><size njmax="{}" nconmax="{}"/>
<option timestep="{}" gravity="{} {} {}" cone="{}" impratio="{}"/>
<default><geom solref="{} 1" solimp="{} {} 0.001"/></default>
<worldbody>
{}</worldbody></mujoco>)",
      1600 + 32 * scene.bodies.size(), 400 + 8 * scene.bodies.size(), dt, scene.gravity.x(), scene.gravity.y(),
      scene.gravity.z(), settings.use_elliptic_cone ? "elliptic" : "pyramidal", settings.impratio,
      settings.time_constant, settings.impedance_min, settings.impedance_max, bodies);
}

class MujocoEngine final : public Engine {
 public:
  explicit MujocoEngine(const MujocoSettings& settings) : settings_(settings) {
    mju_user_warning = [](const char*) {};  // step() reads the counters; the default writes a file where it is run
  }

  void build(const Scene& scene, double dt) override {
    const std::string xml = scene_xml(scene, settings_, dt);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[files->nfile - 1], xml.data(), xml.size());
    has_failed_ = false;
    char error[1000] = "";
    model_.reset(mj_loadXML("scene.xml", files.get(), error, sizeof error));
    mj_deleteVFS(files.get());
    if (!model_) throw std::runtime_error(std::string("MuJoCo refuses the scene: ") + error);
    data_.reset(mj_makeData(model_.get()));
    index_bodies(scene);
    for (std::size_t i = 0; i < absent_.size(); ++i) park(static_cast<int>(i));
    mj_forward(model_.get(), data_.get());
  }

  void step() override {
    for (std::size_t i = 0; i < absent_.size(); ++i) park(static_cast<int>(i));
    mj_step(model_.get(), data_.get());
    has_failed_ = has_failed_ || has_warned(mjWARN_BADQPOS) || has_warned(mjWARN_BADQVEL) || has_warned(mjWARN_BADQACC);
    if (!has_failed_ && (has_warned(mjWARN_CONTACTFULL) || has_warned(mjWARN_CNSTRFULL))) {
      throw std::runtime_error("MuJoCo ran out of room for contacts: njmax, nconmax in engine_mujoco.cpp");
    }
    mju_zero(data_->xfrc_applied, 6 * model_->nbody);
  }

  /// After these warnings MuJoCo has put all bodies back to the start.
  bool has_failed() const override { return has_failed_; }

  Pose pose(int body) const override {
    const mjtNum* q = data_->qpos + qpos_of(body);
    return {Quaternion(q[3], q[4], q[5], q[6]).normalized().toRotationMatrix(), {q[0], q[1], q[2]}};
  }

  Twist velocity(int body) const override {
    const mjtNum* v = data_->qvel + qvel_of(body);
    return {{v[0], v[1], v[2]}, pose(body).R * Vector3(v[3], v[4], v[5])};
  }

  void set_motion(int body, const Pose& X_WB, const Twist& V_WB) override {
    mjtNum* q = data_->qpos + qpos_of(body);
    mjtNum* v = data_->qvel + qvel_of(body);
    const Quaternion quat(X_WB.R);
    const Vector3 w_B = X_WB.R.transpose() * V_WB.angular;  // free joints keep it in body axes
    for (int i = 0; i < 3; ++i) q[i] = X_WB.p[i], v[i] = V_WB.linear[i], v[3 + i] = w_B[i];
    q[3] = quat.w(), q[4] = quat.x(), q[5] = quat.y(), q[6] = quat.z();
  }

  void insert(int body, const Pose& X_WB) override {
    absent_.at(static_cast<std::size_t>(body)) = false;
    set_motion(body, X_WB, {});
  }

  void apply_wrench(int body, const Wrench& wrench_W) override {
    mjtNum* applied = data_->xfrc_applied + 6 * body_.at(static_cast<std::size_t>(body));
    for (int i = 0; i < 3; ++i) applied[i] = wrench_W.force[i], applied[3 + i] = wrench_W.torque[i];
  }

  double normal_force(int body_a, int body_b) const override {
    const int a = geom_of(body_a), b = geom_of(body_b);
    double sum = 0.0;
    for (int i = 0; i < data_->ncon; ++i) {
      const mjContact& contact = data_->contact[i];
      if (!((contact.geom1 == a && contact.geom2 == b) || (contact.geom1 == b && contact.geom2 == a))) continue;
      mjtNum force[6];
      mj_contactForce(model_.get(), data_.get(), i, force);
      sum += force[0];
    }
    return sum;
  }

 private:
  /// MuJoCo numbers fixed geoms, which belong to the world body, before those of free bodies.
  void index_bodies(const Scene& scene) {
    const auto fixed_count =
        std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const BoxBody& box) { return !(box.mass > 0); });
    plane_geom_ = static_cast<int>(fixed_count);
    int fixed = 0, free = 0;
    body_.clear(), geom_.clear(), absent_.clear();
    for (const BoxBody& box : scene.bodies) {
      const bool is_free = box.mass > 0;
      body_.push_back(is_free ? ++free : 0);
      geom_.push_back(is_free ? model_->body_geomadr[free] : fixed++);
      absent_.push_back(!box.is_present);
    }
  }

  /// Bodies cannot be added to a model: one that is not there yet is kept at rest, far away and from the others.
  void park(int body) {
    if (!absent_[static_cast<std::size_t>(body)]) return;
    Pose X_WB;
    X_WB.p = {10.0 + body, 0.0, 100.0};
    set_motion(body, X_WB, {});
  }

  bool has_warned(mjtWarning kind) const { return data_->warning[kind].number > 0; }
  int body_id(int body) const { return body_.at(static_cast<std::size_t>(body)); }
  int qpos_of(int body) const { return model_->jnt_qposadr[model_->body_jntadr[body_id(body)]]; }
  int qvel_of(int body) const { return model_->jnt_dofadr[model_->body_jntadr[body_id(body)]]; }
  int geom_of(int body) const { return body == kPlane ? plane_geom_ : geom_.at(static_cast<std::size_t>(body)); }

  MujocoSettings settings_;
  std::unique_ptr<mjModel, Deleter> model_;
  std::unique_ptr<mjData, Deleter> data_;
  std::vector<int> body_, geom_;  // MuJoCo's ids, by index in the scene
  std::vector<bool> absent_;
  int plane_geom_ = 0;
  bool has_failed_ = false;
};

}  // namespace

std::unique_ptr<Engine> make_mujoco(const MujocoSettings& settings) { return std::make_unique<MujocoEngine>(settings); }

}  // namespace snug::peers
