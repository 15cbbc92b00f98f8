// Engine in a process of its own: other people's packages for Python and node, asked by lines of JSON
// (workers/protocol.py).
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "peers/engine.hpp"

namespace snug::peers {

namespace {

using nlohmann::json;

json to_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

json to_json(const Pose& X) {
  const Quaternion q(X.R);
  return {X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
}

json to_json(const Contact& contact) {
  return {{"friction", contact.friction},           {"restitution", contact.restitution},
          {"stiffness", contact.stiffness},         {"damping", contact.damping},
          {"time_constant", contact.time_constant}, {"damping_ratio", contact.damping_ratio},
          {"impedance", contact.impedance}};
}

Vector3 vector_of(const json& form, std::size_t from) {
  return {form.at(from).get<double>(), form.at(from + 1).get<double>(), form.at(from + 2).get<double>()};
}

json to_json(const Scene& scene, double dt) {
  json bodies = json::array();
  for (const BoxBody& box : scene.bodies) {
    bodies.push_back({{"half", to_json(box.half)},
                      {"is_round", box.is_round},
                      {"mass", box.mass},
                      {"moments", box.inertia_factor == 1.0 ? json(nullptr) : to_json(moments_of(box))},
                      {"middle", to_json(box.middle)},
                      {"pose", to_json(box.X_WB)},
                      {"present", box.is_present}});
  }
  return {{"dt", dt},
          {"gravity", to_json(scene.gravity)},
          {"plane", scene.has_plane ? json(scene.plane_height) : json(nullptr)},
          {"box_box", to_json(scene.box_box)},
          {"box_container", to_json(scene.box_container)},
          {"bodies", bodies}};
}

/// A process that answers each line written to it with one.
class Worker {
 public:
  explicit Worker(const std::vector<std::string>& command) : name_(fmt::format("{}", fmt::join(command, " "))) {
    std::array<int, 2> in{}, out{};
    if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error(name_ + ": no pipe: " + std::strerror(errno));
    }
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    std::signal(SIGPIPE, SIG_IGN);  // a worker that has ended is told by what it does not answer
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(in[0], STDIN_FILENO);
      ::dup2(out[1], STDOUT_FILENO);
      ::execvp(arguments.front(), arguments.data());
      ::_exit(127);
    }
    ::close(in[0]);
    ::close(out[1]);
    to_ = ::fdopen(in[1], "w");
    from_ = ::fdopen(out[0], "r");
    if (process_ < 0 || to_ == nullptr || from_ == nullptr) throw std::runtime_error(name_ + ": no process");
  }
  ~Worker() {
    std::fclose(to_);
    std::fclose(from_);
    ::waitpid(process_, nullptr, 0);
    std::free(line_);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  json ask(const json& question) {
    std::fputs((question.dump() + "\n").c_str(), to_);
    std::fflush(to_);
    if (::getline(&line_, &room_, from_) < 0) throw std::runtime_error(name_ + ": ended without an answer");
    json answer = json::parse(line_);
    if (answer.contains("error")) throw std::runtime_error(name_ + ": " + answer["error"].get<std::string>());
    return answer;
  }

 private:
  std::string name_;
  pid_t process_ = -1;
  std::FILE *to_ = nullptr, *from_ = nullptr;
  char* line_ = nullptr;
  std::size_t room_ = 0;
};

/// Steps and what goes before them are sent when something is asked.
class ProcessEngine final : public Engine {
 public:
  explicit ProcessEngine(const std::vector<std::string>& command) : worker_(command) {}

  void build(const Scene& scene, double dt) override {
    pending_ = json::array();
    state_ = worker_.ask({{"build", to_json(scene, dt)}});
  }

  void step() override {
    if (pending_.empty() || !pending_.back().contains("steps")) pending_.push_back({{"steps", 0}});
    json& steps = pending_.back()["steps"];
    steps = steps.get<int>() + 1;
  }

  double cpu_seconds() const override { return state().at("cpu"); }
  bool has_failed() const override { return state().at("failed"); }

  Pose pose(int body) const override { return pose_of(state().at("poses").at(static_cast<std::size_t>(body))); }

  std::vector<Pose> follow(int body, int count) override {
    pending_.push_back({{"steps", count}, {"follow", body}});
    std::vector<Pose> poses;
    for (const json& form : state().at("path")) poses.push_back(pose_of(form));
    if (has_failed()) poses.clear();
    return poses;
  }

  Twist velocity(int body) const override {
    const json& form = state().at("velocities").at(static_cast<std::size_t>(body));
    return {vector_of(form, 0), vector_of(form, 3)};
  }

  void set_motion(int body, const Pose& X_WB, const Twist& V_WB) override {
    pending_.push_back(
        {{"set", body},
         {"pose", to_json(X_WB)},
         {"velocity",
          {V_WB.linear.x(), V_WB.linear.y(), V_WB.linear.z(), V_WB.angular.x(), V_WB.angular.y(), V_WB.angular.z()}}});
  }

  void insert(int body, const Pose& X_WB) override {
    pending_.push_back({{"insert", body}, {"pose", to_json(X_WB)}, {"velocity", {0, 0, 0, 0, 0, 0}}});
  }

  void apply_wrench(int body, const Wrench& wrench_W) override {
    pending_.push_back({{"push", body}, {"force", to_json(wrench_W.force)}, {"torque", to_json(wrench_W.torque)}});
  }

  double normal_force(int body_a, int body_b) const override {
    (void)state();
    const json answer = worker_.ask({{"normal_force", {body_a, body_b}}}).at("normal_force");
    return answer.is_null() ? std::numeric_limits<double>::quiet_NaN() : answer.get<double>();
  }

 private:
  static Pose pose_of(const json& form) {
    const auto number = [&](std::size_t at) { return form.at(at).get<double>(); };
    const Quaternion q(number(3), number(4), number(5), number(6));
    return {q.normalized().toRotationMatrix(), vector_of(form, 0)};
  }

  const json& state() const {
    if (!pending_.empty()) state_ = worker_.ask({{"do", pending_}});
    pending_ = json::array();
    return state_;
  }

  mutable Worker worker_;
  mutable json pending_ = json::array(), state_;
};

}  // namespace

std::unique_ptr<Engine> make_process(const std::vector<std::string>& command) {
  return std::make_unique<ProcessEngine>(command);
}

}  // namespace snug::peers
