// World and Cell: bodies alone, and the robot's cell with a program; stepped from Python, kept as snapshots.
#include <fmt/format.h>

#include "bodies.hpp"
#include "handles.hpp"
#include "snug/cell/scene.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/core/input_error.hpp"
#include "snug/runs/corrected.hpp"

namespace snug::python {

physics::BodyId body_named(const cell::CellWorld& world, const std::string& name) {
  const physics::BodyId body = cell::find_body(world, name);
  if (body.is_valid()) return body;
  std::vector<std::string> names;
  for (const physics::BodyModel& known : world.model.bodies) names.push_back(known.name);
  const std::string_view nearest = find_nearest(name, names);
  throw InputError("body", "name", "'" + name + "'",
                   nearest.empty() ? "one of `names`" : "one of `names`; did you mean " + std::string(nearest) + "?");
}

py::list names_of(const cell::CellWorld& world) {
  py::list names;
  for (const physics::BodyModel& body : world.model.bodies) names.append(body.name);
  return names;
}

Array poses_of(const cell::CellWorld& world, const physics::WorldState& state, const std::optional<Array>& out) {
  const auto count = static_cast<py::ssize_t>(state.bodies.size());
  Array poses = out ? *out : Array({count, static_cast<py::ssize_t>(7)});
  if (poses.ndim() != 2 || poses.shape(0) != count || poses.shape(1) != 7 || !poses.writeable())
    throw InputError("argument", "out", "another array",
                     "a writable array of " + std::to_string(count) + " x 7 numbers");
  double* const to = poses.mutable_data();
  for (py::ssize_t i = 0; i < count; ++i) {
    const physics::BodyState& body = state.bodies[static_cast<std::size_t>(i)];
    double* const row = to + 7 * i;
    const Vector3 origin = body.p_WBcm - body.quat_WB * world.model.bodies[static_cast<std::size_t>(i)].inertia.com;
    const double sign = body.quat_WB.w() < 0.0 ? -1.0 : 1.0;
    row[0] = origin.x();
    row[1] = origin.y();
    row[2] = origin.z();
    row[3] = sign * body.quat_WB.w();
    row[4] = sign * body.quat_WB.x();
    row[5] = sign * body.quat_WB.y();
    row[6] = sign * body.quat_WB.z();
  }
  return poses;
}

py::list contacts_of(const cell::CellWorld& world, const physics::WorldState& state) {
  py::list list;
  for (const physics::ContactReport& contact : physics::bearing_contacts(world.model, state)) {
    py::dict entry;
    entry["bodies"] = py::make_tuple(cell::name_of(world, contact.a), cell::name_of(world, contact.b));
    entry["point"] = as_array(contact.p_WQ);
    entry["normal"] = as_array(contact.n_AB_W);
    entry["force"] = as_array(contact.force_W);
    entry["gap"] = contact.phi;
    entry["slides"] = contact.slides;
    list.append(entry);
  }
  return list;
}

namespace {

/// The bodies that a snapshot is of: equal bodies, equal meaning of a state.
using Bodies = std::shared_ptr<const std::vector<physics::BodyModel>>;

Bodies bodies_of(const cell::CellWorld& world) {
  return std::make_shared<const std::vector<physics::BodyModel>>(world.model.bodies);
}

struct WorldSnapshot {
  cell::SceneState state;
  Bodies bodies;
};

struct CellSnapshot {
  cell::CellState state;
  Bodies bodies;
  bool has_ended = false;
};

class World {
 public:
  explicit World(ScenarioHandle scenario)
      : scenario_(std::move(scenario)), scene_(**scenario_), bodies_(bodies_of(scene_.world())) {}

  void step(int steps) {
    if (steps < 0) throw InputError("argument", "steps", std::to_string(steps), "0 or more");
    const Use use(busy_);
    const py::gil_scoped_release release;
    for (int i = 0; i < steps; ++i) {
      report_ = scene_.advance();
      if (report_.status == physics::StepStatus::NotFinite || report_.status == physics::StepStatus::TooManyPairs) {
        throw std::runtime_error(cell::find_failure(world(), state(), scene_.work(), report_).text);
      }
    }
  }
  [[nodiscard]] WorldSnapshot snapshot() {
    const Use use(busy_);
    return {scene_.snapshot(), bodies_};
  }
  void restore(const WorldSnapshot& snapshot) {
    const Use use(busy_);
    if (*snapshot.bodies != *bodies_)
      throw InputError("argument", "snapshot", "one of another world", "a snapshot of this world or of an equal one");
    scene_.restore(snapshot.state);
  }
  [[nodiscard]] cell::Scene& scene() { return scene_; }
  [[nodiscard]] const cell::CellWorld& world() const { return scene_.world(); }
  [[nodiscard]] const physics::WorldState& state() const { return scene_.state(); }
  [[nodiscard]] const physics::StepReport& report() const { return report_; }
  [[nodiscard]] const ScenarioHandle& scenario() const { return scenario_; }
  [[nodiscard]] std::atomic<bool>& busy() { return busy_; }

 private:
  ScenarioHandle scenario_;
  cell::Scene scene_;
  Bodies bodies_;
  physics::StepReport report_;
  std::atomic<bool> busy_{false};
};

cell::SimulationOptions options_of(const model::Scenario& scenario, const motion::Program& program,
                                   const std::string& cup, const std::string& controller, const std::string& robot,
                                   const std::string& corrections) {
  cell::SimulationOptions options;
  options.cup = cup.empty() ? runs::cup_for(scenario, corrections) : cup::cup_mode_of(cup, "argument");
  options.tracking = motion::choose_tracking(controller.empty() ? std::nullopt : std::optional(controller),
                                             std::nullopt, program.tracking, "argument");
  options.robot = robot;
  return options;
}

class Cell {
 public:
  Cell(ScenarioHandle scenario, const std::string& sequence, ProgramHandle program, const std::string& cup,
       const std::string& controller, const std::string& robot, const std::string& corrections)
      : scenario_(std::move(scenario)),
        program_(std::move(program)),
        simulation_(**scenario_, sequence, options_of(**scenario_, **program_, cup, controller, robot, corrections)),
        plan_(simulation_.prepare(runs::corrected(**scenario_, **program_, corrections))),
        state_(simulation_.make_state()),
        bodies_(bodies_of(simulation_.world())),
        work_(simulation_.make_workspace()) {}

  /// Whether the program goes on.
  bool step(int ticks) {
    if (ticks < 0) throw InputError("argument", "ticks", std::to_string(ticks), "0 or more");
    const Use use(busy_);
    const py::gil_scoped_release release;
    for (int i = 0; i < ticks; ++i) {
      const cell::CellTick tick = simulation_.advance(plan_, state_, work_);
      has_ended_ |= tick.has_ended;
      if (tick.failure) throw std::runtime_error(tick.failure.text);
    }
    return !has_ended_;
  }
  void run() {
    const Use use(busy_);
    const py::gil_scoped_release release;
    constexpr double kLongest = 7200.0;  // s
    while (!has_ended_) {
      const cell::CellTick tick = simulation_.advance(plan_, state_, work_);
      has_ended_ = tick.has_ended;
      if (tick.failure) throw std::runtime_error(tick.failure.text);
      if (simulation_.time(state_) > kLongest) throw std::runtime_error("the program did not end within two hours");
    }
  }
  [[nodiscard]] CellSnapshot snapshot() {
    const Use use(busy_);
    return {state_, bodies_, has_ended_};
  }
  void restore(const CellSnapshot& snapshot) {
    const Use use(busy_);
    if (*snapshot.bodies != *bodies_)
      throw InputError("argument", "snapshot", "one of another cell", "a snapshot of this cell or of an equal one");
    state_ = snapshot.state;
    has_ended_ = snapshot.has_ended;
  }
  [[nodiscard]] const cell::Simulation& simulation() const { return simulation_; }
  [[nodiscard]] const cell::CellState& cell_state() const { return state_; }
  [[nodiscard]] const cell::CellWorld& world() const { return simulation_.world(); }
  [[nodiscard]] const physics::WorldState& state() const { return state_.world; }
  [[nodiscard]] bool has_ended() const { return has_ended_; }
  [[nodiscard]] const ScenarioHandle& scenario() const { return scenario_; }

 private:
  ScenarioHandle scenario_;
  ProgramHandle program_;
  cell::Simulation simulation_;
  motion::PreparedProgram plan_;
  cell::CellState state_;
  Bodies bodies_;
  cell::CellWorkspace work_;
  bool has_ended_ = false;
  std::atomic<bool> busy_{false};
};

py::list events_of(const std::vector<record::Event>& events) {
  py::list list;
  for (const record::Event& event : events) {
    py::dict entry;
    entry["time"] = event.time;
    entry["kind"] = event.kind;
    entry["body"] = event.body;
    entry["text"] = event.text;
    for (const record::EventNumber& number : event.numbers) entry[py::str(number.name)] = number.value;
    list.append(entry);
  }
  return list;
}

py::list boxes_of(const Cell& cell) {
  py::list list;
  for (const cell::BoxResult& box : cell.simulation().boxes(cell.cell_state())) {
    py::dict entry;
    entry["id"] = box.id;
    entry["state"] = cell::name_of(box.state);
    entry["pose"] = as_array(box.X_TP);
    entry["up"] = std::string(1, box.up);
    entry["outside"] = box.outside;
    entry["above_rim"] = box.above_rim;
    entry["events"] = events_of(box.events);
    list.append(entry);
  }
  return list;
}

py::dict cup_of(const Cell& cell) {
  const cell::GripperState& gripper = cell.cell_state().gripper;
  py::dict dict;
  const char* const phases[] = {"free", "holding", "releasing"};
  dict["phase"] = phases[static_cast<int>(gripper.cup.phase)];
  dict["pressure_gauge"] = gripper.cup.pressure_gauge;
  dict["holds"] = gripper.cup.body >= 0
                      ? py::object(py::str(cell::name_of(cell.world(), physics::BodyId{gripper.cup.body})))
                      : py::object(py::none());
  dict["bend"] = gripper.cup.bend;
  dict["wrench"] = as_array(as_vector(gripper.F_S));
  return dict;
}

/// <snug.World 'drop': 2 bodies, t = 0.100 s>
template <class Self>
std::string describe(const Self& self, const char* type) {
  const auto& model = self.world().model;
  const double time = static_cast<double>(self.state().step_index) * model.settings.dt;
  return fmt::format("<snug.{} '{}': {} bodies, t = {:.3f} s>", type, (*self.scenario())->name, model.bodies.size(),
                     time);
}

void bind_bodies_alone(py::module_& m) {
  py::class_<WorldSnapshot>(m, "WorldSnapshot").def_property_readonly("hash", [](const WorldSnapshot& s) {
    return physics::hash_of(s.state.world);
  });
  py::class_<World> world(m, "World");
  world.def(py::init<ScenarioHandle>(), py::arg("scenario"))
      .def("step", &World::step, py::arg("steps") = 1)
      .def("snapshot", &World::snapshot)
      .def("restore", &World::restore, py::arg("snapshot"))
      .def(
          "set_pose",
          [](World& w, const std::string& name, const Array& pose) {
            const Use use(w.busy());
            physics::set_pose(w.world().model, w.scene().state(), body_named(w.world(), name), as_pose(pose, "pose"));
          },
          py::arg("name"), py::arg("pose"))
      .def(
          "set_twist",
          [](World& w, const std::string& name, const Array& linear, const Array& angular) {
            const Use use(w.busy());
            physics::set_twist(w.world().model, w.scene().state(), body_named(w.world(), name),
                               {as_vector3(linear, "linear"), as_vector3(angular, "angular")});
          },
          py::arg("name"), py::arg("linear"), py::arg("angular"))
      .def_property_readonly("dt", [](const World& w) { return w.world().model.settings.dt; })
      .def_property_readonly("scenario", &World::scenario)
      .def_property_readonly("hash", [](const World& w) { return physics::hash_of(w.state()); })
      .def_property_readonly("report", [](const World& w) {
        py::dict dict;
        const char* const words[] = {"converged", "not converged", "not finite", "lost body", "too many pairs"};
        dict["status"] = words[static_cast<int>(w.report().status)];
        dict["sweeps"] = w.report().sweeps;
        dict["residual"] = w.report().residual;
        dict["contacts"] = w.report().contacts;
        dict["awake"] = w.report().awake;
        dict["worst_penetration"] = w.report().worst_penetration;
        return dict;
      });
  world.def("__repr__", [](const World& w) { return describe(w, "World"); });
  add_bodies(world);
}

}  // namespace

void bind_world(py::module_& m) {
  bind_bodies_alone(m);
  py::class_<CellSnapshot>(m, "CellSnapshot").def_property_readonly("steps", [](const CellSnapshot& s) {
    return s.state.world.step_index;
  });
  py::class_<Cell> cell(m, "Cell");
  cell.def(py::init<ScenarioHandle, const std::string&, ProgramHandle, const std::string&, const std::string&,
                    const std::string&, const std::string&>(),
           py::arg("scenario"), py::arg("sequence"), py::arg("program"), py::kw_only(), py::arg("cup") = "",
           py::arg("controller") = "", py::arg("robot") = "", py::arg("corrections") = "")
      .def("step", &Cell::step, py::arg("ticks") = 1)
      .def("run", &Cell::run)
      .def("snapshot", &Cell::snapshot)
      .def("restore", &Cell::restore, py::arg("snapshot"))
      .def_property_readonly("scenario", &Cell::scenario)
      .def_property_readonly("tick", [](const Cell& c) { return c.simulation().scenario().controller.tick; })
      .def_property_readonly("has_ended", &Cell::has_ended)
      .def_property_readonly("row", [](const Cell& c) { return c.cell_state().controller.row; })
      .def_property_readonly("tool", [](const Cell& c) { return as_array(c.cell_state().controller.command.X_WE); })
      .def_property_readonly("cup", &cup_of)
      .def_property_readonly("joints",
                             [](const Cell& c) -> py::object {
                               if (!c.cell_state().arm) return py::none();
                               const robot::JointVector& q = c.cell_state().arm->machine.joints.q;
                               return Array(static_cast<py::ssize_t>(q.size()), q.data());
                             })
      .def("boxes", &boxes_of)
      .def("events", [](const Cell& c) { return events_of(c.cell_state().event_log.events()); })
      .def_property_readonly("hash", [](const Cell& c) { return c.simulation().hash(c.cell_state()); });
  cell.def("__repr__", [](const Cell& c) { return describe(c, "Cell"); });
  add_bodies(cell);
}

}  // namespace snug::python
