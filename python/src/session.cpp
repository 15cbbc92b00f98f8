// Packing sessions, runs of programs, recordings and their report: results are the documented JSON of the command line.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core.hpp"
#include "handles.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/write_file.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/record/reader.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run.hpp"
#include "snug/study/monte_carlo.hpp"
#include "snug/study/trial.hpp"
#include "snug/study/trial_report.hpp"

namespace snug::python {
namespace {

/// Ctrl-C ends what takes long: to be called now and then, without the interpreter's lock.
void check_signals() {
  const py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// An agent that is a Python object: `answer` takes and returns a line of JSON.
packing::Ask ask_of(const py::object& answer) {
  if (answer.is_none()) return {};
  // Called, copied and dropped by whoever holds the function: with the lock each time.
  const auto held = std::shared_ptr<py::object>(new py::object(answer), [](py::object* object) {
    const py::gil_scoped_acquire acquire;
    delete object;
  });
  return [held](const std::string& line) {
    const py::gil_scoped_acquire acquire;
    return (*held)(line).cast<std::string>();
  };
}

struct PackWords {
  std::string sequence, agent, perception;
  std::optional<std::string> robot;
  std::filesystem::path record;
  std::optional<std::uint64_t> seed;
  std::uint64_t plant_seed = 1;
  double decision_time = 0.5;
  int samples = 8, threads = 0, monte_carlo = 0;
  std::optional<double> tempo;  ///< none: with the demonstrator's lag
  py::object answer = py::none(), progress = py::none();
};

/// The robot that moves the tool: what was asked for, or the scenario's, where its file is there.
std::string choose_robot(const PackWords& words, const model::Scenario& scenario) {
  if (words.robot) return *words.robot == "none" ? std::string() : *words.robot;
  std::error_code error;
  const bool is_there = scenario.robot && std::filesystem::exists(robot::urdf_path(scenario), error);
  return is_there ? scenario.robot->name : std::string();
}

session::SessionOptions session_options(const model::Scenario& scenario, const PackWords& words) {
  if (words.samples < 0 || words.samples > 64)
    throw InputError("argument", "samples", std::to_string(words.samples), "0 .. 64");
  if (words.monte_carlo < 0)
    throw InputError("argument", "monte_carlo", std::to_string(words.monte_carlo), "0 or more");
  session::SessionOptions session;
  session.agent = words.agent;
  session.ask = ask_of(words.answer);
  session.decision.seed = words.seed.value_or(scenario.seed);
  session.decision.time = words.decision_time;
  session.threads = words.threads > 0 ? words.threads : core_count();
  session.decision.threads = session.threads;
  session.samples = words.samples;
  session.simulation.robot = choose_robot(words, scenario);
  if (words.tempo && !(*words.tempo >= 0.5 && *words.tempo <= 1.0))
    throw InputError("argument", "tempo", std::to_string(*words.tempo), "0.5 .. 1, or None");
  session.simulation.tracking =
      motion::choose_tracking(std::nullopt, words.tempo, motion::LaggedTracking{}, "argument");
  return session;
}

simulated_plant::LiveRecordingOptions recording_of(const simulated_plant::SimulatedPlantOptions& plant,
                                                   const std::string& agent, OutputFile& file) {
  simulated_plant::LiveRecordingOptions recording;
  recording.file = &file;
  recording.version = SNUG_VERSION;
  const std::string& robot = plant.simulation.robot;
  recording.settings_json =
      nlohmann::json{{"cup", "phases"},          {"controller", motion::name_of(plant.simulation.tracking)},
                     {"corrections", "none"},    {"robot", robot.empty() ? "none" : robot},
                     {"plant_seed", plant.seed}, {"agent", agent}}
          .dump();
  return recording;
}

study::MonteCarloResult repeated(const model::Scenario& scenario, const study::Trial& trial,
                                 const session::SessionOptions& session, int count) {
  if (count == 0) return {};
  study::MonteCarloOptions options;
  options.count = count;
  options.seed = session.decision.seed;
  options.threads = session.threads;
  options.simulation = session.simulation;
  return study::repeat(scenario, trial.session.sequence, trial.session.program, trial.session.plan, options);
}

runs::RunOptions run_options(const motion::Program& program, const std::string& sequence) {
  runs::RunOptions run;
  run.program = program;
  run.program_text = motion::format_program(program);
  run.sequence = sequence;
  run.version = SNUG_VERSION;
  run.describe = [](const runs::RunResult& one) { return runs::format_result(one); };
  return run;
}

/// The words of the result, and the program.
py::tuple pack(const ScenarioHandle& handle, const PackWords& words) {
  const model::Scenario& scenario = **handle;
  const session::SessionOptions session = session_options(scenario, words);
  simulated_plant::SimulatedPlantOptions plant;
  plant.seed = words.plant_seed;
  plant.perception = perception::kind_of(words.perception);
  plant.simulation = session.simulation;
  const auto progress = [&](const study::Trial& so_far, int item, int items) {
    check_signals();
    const py::gil_scoped_acquire acquire;
    if (!words.progress.is_none()) words.progress(item, items, so_far.executed_boxes, so_far.executed_percent);
  };
  std::string json;
  ProgramHandle program;
  study::Trial trial;
  {
    const py::gil_scoped_release release;
    std::optional<OutputFile> file;
    study::TrialFiles files;
    files.describe = [](const runs::RunResult& one) { return runs::format_result(one); };
    if (!words.record.empty()) {
      file = record::reserve_recording(words.record);
      files.recording = recording_of(plant, session.agent, *file);
    }
    trial = study::run_trial(scenario, words.sequence, session, plant, progress, files);
    json = study::format_json(trial, repeated(scenario, trial, session, words.monte_carlo));
    program = std::make_shared<Held<motion::Program>>(trial.session.program);
  }
  return py::make_tuple(from_json(json), program);
}

py::object simulate(const ScenarioHandle& scenario, const ProgramHandle& program, const std::string& sequence,
                    const std::string& corrections, const std::string& robot, const std::string& cup,
                    const std::string& controller, const std::optional<double>& until,
                    const std::filesystem::path& record) {
  runs::RunOptions run;
  if (program) run = run_options(**program, sequence);
  run.version = SNUG_VERSION;
  run.describe = [](const runs::RunResult& one) { return runs::format_result(one); };
  run.corrections = corrections;
  run.simulation.robot = robot;
  if (!cup.empty()) run.simulation.cup = cup::cup_mode_of(cup, "argument");
  const motion::Tracking made_for = program ? (**program).tracking : motion::Tracking();
  run.simulation.tracking = motion::choose_tracking(controller.empty() ? std::nullopt : std::optional(controller),
                                                    std::nullopt, made_for, "argument");
  if (until && !(*until > 0.0)) throw InputError("argument", "until", std::to_string(*until), "above 0 s");
  run.until = until;
  run.record_path = record;
  std::string json;
  if (record.empty()) {
    const py::gil_scoped_release release;
    json = runs::format_result(runs::run(**scenario, run));
  } else {
    const HdfUse use;
    json = runs::format_result(runs::run(**scenario, run));
  }
  return from_json(json);
}

class Recording {
 public:
  explicit Recording(std::filesystem::path path) : path_(std::move(path)), reader_(path_) {}

  [[nodiscard]] const record::RecordingHeader& header() const { return reader_.header(); }
  [[nodiscard]] const record::RecordingReader& reader() const { return reader_; }
  [[nodiscard]] std::string name() const { return path_.filename().string(); }

  /// Columns of every `every`-th frame.
  py::dict read(int every) {
    if (every < 1) throw InputError("argument", "every", std::to_string(every), "1 or more");
    const auto step = static_cast<std::size_t>(every);
    const std::size_t count = (reader_.frame_count() + step - 1) / step;
    const auto frames = static_cast<py::ssize_t>(count);
    const auto bodies = static_cast<py::ssize_t>(header().bodies.size());
    const auto joints = static_cast<py::ssize_t>(header().joints.size());
    Array time(frames), poses({frames, bodies, py::ssize_t{7}}), twists({frames, bodies, py::ssize_t{6}});
    Array tool({frames, py::ssize_t{7}}), pressure(frames), force({frames, py::ssize_t{6}});
    Array sensor({frames, py::ssize_t{6}}), positions({frames, joints});
    py::array_t<std::int64_t> row(frames);
    py::array_t<bool> present({frames, bodies});
    {
      const HdfUse use;
      record::Frame frame;
      for (std::size_t i = 0; i < count; ++i) {
        reader_.read_frame(i * step, frame);
        const auto k = static_cast<py::ssize_t>(i);
        time.mutable_data()[k] = frame.time;
        row.mutable_data()[k] = frame.program_row;
        pressure.mutable_data()[k] = frame.cup.pressure_gauge;
        put(frame.X_WE, tool.mutable_data() + 7 * k);
        put(as_vector(frame.cup.F_PSo_S), force.mutable_data() + 6 * k);
        put(as_vector(frame.F_flange), sensor.mutable_data() + 6 * k);
        for (py::ssize_t j = 0; j < joints; ++j)
          positions.mutable_data()[k * joints + j] = frame.joints[static_cast<std::size_t>(j)].position;
        for (py::ssize_t b = 0; b < bodies; ++b) {
          const record::BodySample& body = frame.bodies[static_cast<std::size_t>(b)];
          present.mutable_data()[k * bodies + b] = body.present;
          put(body.X_WB, poses.mutable_data() + 7 * (k * bodies + b));
          put(as_vector(body.V_WB), twists.mutable_data() + 6 * (k * bodies + b));
        }
      }
    }
    py::dict columns;
    columns["time"] = time;
    columns["row"] = row;
    columns["poses"] = poses;
    columns["twists"] = twists;
    columns["present"] = present;
    columns["tool"] = tool;
    columns["pressure_gauge"] = pressure;
    columns["cup_wrench"] = force;
    columns["flange_wrench"] = sensor;
    columns["joints"] = positions;
    return columns;
  }

  [[nodiscard]] std::string page(const std::string& page, int every) {
    replay::Selection selection;
    selection.every = static_cast<std::size_t>(std::max(1, every));
    const HdfUse use;
    const std::vector<report::PageRecording> one = {{name(), replay::encode_recording(reader_, name(), selection)}};
    return report::assemble_page(page, one);
  }

 private:
  static void put(const record::PoseSample& pose, double* out) {
    const double numbers[7] = {pose.p.x(),    pose.p.y(),    pose.p.z(),   pose.quat.w(),
                               pose.quat.x(), pose.quat.y(), pose.quat.z()};
    std::copy(std::begin(numbers), std::end(numbers), out);
  }
  static void put(const Vector6& v, double* out) { std::copy(v.data(), v.data() + 6, out); }

  std::filesystem::path path_;
  record::RecordingReader reader_;
};

/// "kind", "pose" in the body, and the sizes of that kind; a hull with the triangles of its surface.
py::dict shape_of(const record::ShapeInfo& shape) {
  static constexpr const char* kKinds[] = {"box", "capsule", "hull", "cylinder"};
  py::dict entry;
  entry["kind"] = kKinds[static_cast<std::size_t>(shape.kind)];
  Array pose(py::ssize_t{7});
  const Quaternion& q = shape.X_BG.quat;
  const double numbers[7] = {shape.X_BG.p.x(), shape.X_BG.p.y(), shape.X_BG.p.z(), q.w(), q.x(), q.y(), q.z()};
  std::copy(std::begin(numbers), std::end(numbers), pose.mutable_data());
  entry["pose"] = pose;
  if (shape.kind == record::ShapeKind::Box) {
    entry["size"] = std::vector<double>{2.0 * shape.half.x(), 2.0 * shape.half.y(), 2.0 * shape.half.z()};
  } else if (shape.kind != record::ShapeKind::Hull) {
    entry["radius"] = shape.radius;
    entry["length"] = 2.0 * shape.half_length;
  } else if (const auto hull = geometry::make_convex_hull(shape.vertices)) {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<int, 3>> triangles;
    for (const Vector3& v : hull->vertices) vertices.push_back({v.x(), v.y(), v.z()});
    for (const std::vector<int>& face : hull->faces) {
      for (std::size_t i = 2; i < face.size(); ++i) triangles.push_back({face[0], face[i - 1], face[i]});
    }
    entry["vertices"] = vertices;
    entry["triangles"] = triangles;
  }
  return entry;
}

py::list bodies_of(const record::RecordingHeader& header) {
  static constexpr const char* kKinds[] = {"static", "kinematic", "dynamic"};
  py::list list;
  for (const record::BodyInfo& body : header.bodies) {
    py::dict entry;
    entry["name"] = body.name;
    entry["type"] = body.type;
    entry["kind"] = kKinds[static_cast<std::size_t>(body.kind)];
    entry["mass"] = body.mass;
    py::list shapes;
    for (const record::ShapeInfo& shape : body.shapes) shapes.append(shape_of(shape));
    entry["shapes"] = shapes;
    list.append(entry);
  }
  return list;
}

}  // namespace

void bind_session(py::module_& m) {
  m.def(
      "pack",
      [](const ScenarioHandle& scenario, const std::string& sequence, const std::string& agent,
         const py::object& answer, const std::optional<std::uint64_t>& seed, std::uint64_t plant_seed,
         double decision_time, int samples, int threads, const std::optional<std::string>& robot,
         const std::string& perception, int monte_carlo, const std::optional<double>& tempo,
         const std::filesystem::path& record, const py::object& progress) {
        return pack(scenario, {sequence, agent, perception, robot, record, seed, plant_seed, decision_time, samples,
                               threads, monte_carlo, tempo, answer, progress});
      },
      py::arg("scenario"), py::arg("sequence"), py::arg("agent"), py::arg("answer"), py::arg("seed"),
      py::arg("plant_seed"), py::arg("decision_time"), py::arg("samples"), py::arg("threads"), py::arg("robot"),
      py::arg("perception"), py::arg("monte_carlo"), py::arg("tempo"), py::arg("record"), py::arg("progress"));
  m.def("simulate", &simulate, py::arg("scenario"), py::arg("program"), py::arg("sequence"), py::arg("corrections"),
        py::arg("robot"), py::arg("cup"), py::arg("controller"), py::arg("until"), py::arg("record"));
  py::class_<Recording>(m, "Recording")
      .def(py::init([](const std::filesystem::path& path) {
             const HdfUse use;
             return std::make_unique<Recording>(path);
           }),
           py::arg("path"))
      .def_property_readonly("file", &Recording::name)
      .def_property_readonly("names",
                             [](const Recording& r) {
                               std::vector<std::string> names;
                               for (const record::BodyInfo& body : r.header().bodies) names.push_back(body.name);
                               return names;
                             })
      .def_property_readonly("bodies", [](const Recording& r) { return bodies_of(r.header()); })
      .def_property_readonly("joint_names", [](const Recording& r) { return r.header().joints; })
      .def_property_readonly("sequence", [](const Recording& r) { return r.header().sequence; })
      .def_property_readonly("scenario_text", [](const Recording& r) { return r.header().scenario_text; })
      .def_property_readonly("program_text", [](const Recording& r) { return r.header().program_text; })
      .def_property_readonly("version", [](const Recording& r) { return r.header().version; })
      .def_property_readonly("is_complete", [](const Recording& r) { return r.reader().is_complete(); })
      .def_property_readonly("times",
                             [](const Recording& r) {
                               const std::vector<double>& times = r.reader().times();
                               return Array(static_cast<py::ssize_t>(times.size()), times.data());
                             })
      .def_property_readonly("result",
                             [](const Recording& r) -> py::object {
                               if (r.reader().result().empty()) return py::none();
                               return from_json(r.reader().result());
                             })
      .def_property_readonly("events",
                             [](const Recording& r) {
                               py::list list;
                               for (const record::Event& event : r.reader().events()) {
                                 py::dict entry;
                                 entry["time"] = event.time;
                                 entry["kind"] = event.kind;
                                 entry["body"] = event.body;
                                 entry["text"] = event.text;
                                 for (const record::EventNumber& n : event.numbers) entry[py::str(n.name)] = n.value;
                                 list.append(entry);
                               }
                               return list;
                             })
      .def("__repr__",
           [](const Recording& r) {
             const std::vector<double>& times = r.reader().times();
             return fmt::format("<snug.Recording '{}': {} frames, {:.2f} s, {} bodies{}>", r.name(), times.size(),
                                times.empty() ? 0.0 : times.back() - times.front(), r.header().bodies.size(),
                                r.reader().is_complete() ? "" : ", not complete");
           })
      .def("read", &Recording::read, py::arg("every") = 1)
      .def("page", &Recording::page, py::arg("page"), py::arg("every") = 1);
  m.def(
      "write_file",
      [](const std::filesystem::path& path, const std::string& text) { write_file(OutputFile(path), text); },
      py::arg("path"), py::arg("text"));
}

}  // namespace snug::python
