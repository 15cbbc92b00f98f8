// SceneExperiment: a scenario at given values, beside each recording.
#include "snug/identification/scene_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/rng.hpp"
#include "snug/core/units.hpp"
#include "snug/identification/free_flight.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/internal/motion_error.hpp"
#include "snug/identification/internal/program_motion.hpp"
#include "snug/identification/internal/recording_checks.hpp"
#include "snug/identification/internal/scene_motion.hpp"
#include "snug/model/number_edit.hpp"

namespace snug::identification {
namespace {

constexpr std::size_t kKnownRuns = 64;  // that are kept, a few MB each
constexpr double kOwnStep = 0.01;       // of what is expected of an own unknown, for differences
constexpr double kPathStep = 0.3;  // the same, of a driven body's path: what sticks or slides shows no slope nearer

}  // namespace

struct SceneExperiment::KnownRun {
  Eigen::VectorXd values;
  std::size_t lead = 0;  ///< see lead_of
  internal::ProgramRun run;
};

SceneExperiment::SceneExperiment(SceneExperiment&&) noexcept = default;
SceneExperiment::~SceneExperiment() = default;

SceneExperiment::SceneExperiment(model::SceneTask task, std::vector<RecordedMotion> motions, int threads)
    : task_(std::move(task)),
      motions_(std::move(motions)),
      threads_(threads),
      base_(model::load_scenario(task_.scenario)) {
  if (task_.time_step) base_.time_step = *task_.time_step;
  expect_recording_errors();
  for (const model::TaskParameter& parameter : task_.parameters) {
    std::vector<double>& numbers = base_numbers_.emplace_back();
    for (const std::string& path : parameter.paths) {
      const std::optional<double> number = model::find_number(base_, path, parameter.where);
      if (!number && parameter.form != model::ParameterForm::Value)
        throw InputError(parameter.where, path, "no number in the scenario", "one that can be scaled or shifted");
      numbers.push_back(number.value_or(0.0));
    }
  }
  check_bodies();
  for (RecordedMotion& motion : motions_) {
    if (!task_.program) {
      internal::check_conventions(task_, base_, motion);
      internal::reject_jumps(task_, motion);
    }
    samples_.push_back(internal::compared_samples(task_, motion));
    if (samples_of(samples_.size() - 1) == 0)
      throw InputError(task_.path.string(), motion.name, "no pose of a tracked object in the time simulated",
                       "at least one that can be compared");
  }
  (void)scenario_at(start());
  find_flights();
  find_driven();
}

Eigen::VectorXd SceneExperiment::start() const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(task_.parameters.size()));
  for (std::size_t i = 0; i < task_.parameters.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = task_.parameters[i].value;
  return values;
}

model::Scenario SceneExperiment::scenario_at(const Eigen::VectorXd& values) const {
  std::vector<model::NumberEdit> edits;
  for (std::size_t i = 0; i < task_.parameters.size(); ++i) {
    const model::TaskParameter& parameter = task_.parameters[i];
    const double value = values[static_cast<Eigen::Index>(i)];
    for (std::size_t k = 0; k < parameter.paths.size(); ++k) {
      const double base = base_numbers_[i][k];
      edits.push_back({parameter.paths[k], parameter.form == model::ParameterForm::Value   ? value
                                           : parameter.form == model::ParameterForm::Scale ? value * base
                                                                                           : value + base});
    }
  }
  model::Scenario scenario = model::with_numbers(base_, edits);
  scenario.time_step = base_.time_step;
  return scenario;
}

void SceneExperiment::check_bodies() const {
  const auto check = [&](const model::RecordedObject& object, model::BodyKind kind, const char* expected) {
    if (task_.program) {
      if (model::find_parcel(base_, object.body) != nullptr) return;
      throw InputError(task_.path.string(), "tracked_objects", "'" + object.body + "'", "a parcel of the scenario");
    }
    const model::Body* body = model::find_body(base_, object.body);
    if (body != nullptr && body->kind == kind) return;
    std::vector<std::string> names;
    for (const model::Body& one : base_.bodies)
      if (one.kind == kind) names.push_back(one.name);
    const std::string_view nearest = find_nearest(object.body, names);
    throw InputError(task_.path.string(), kind == model::BodyKind::Dynamic ? "tracked_objects" : "kinematic_bodies",
                     "'" + object.body + "'",
                     std::string(expected) + (nearest.empty() ? "" : ", nearest is '" + std::string(nearest) + "'"));
  };
  for (const model::RecordedObject& object : task_.tracked)
    check(object, model::BodyKind::Dynamic, "a dynamic body of the scenario");
  for (const model::RecordedObject& object : task_.kinematic)
    check(object, model::BodyKind::Kinematic, "a kinematic body of the scenario");
}

void SceneExperiment::expect_recording_errors() {
  constexpr double kQuartz = 5e-5;
  if (task_.loss != model::TaskLoss::Squares) return;
  if (task_.program && task_.own.clock_rate == 0.0) task_.own.clock_rate = kQuartz;
  if (task_.own.bias > 0.0 || task_.own.bias_rotation > 0.0) return;
  for (const RecordedMotion& motion : motions_) {
    task_.own.bias = std::max(task_.own.bias, motion.world_position_error);
    task_.own.bias_rotation = std::max(task_.own.bias_rotation, motion.world_rotation_error);
  }
}

void SceneExperiment::find_flights() {
  flights_.assign(motions_.size(), {});
  if (task_.start.from != model::StartFrom::FreeFlight) return;
  const model::Scenario scenario = scenario_at(start());
  for (std::size_t m = 0; m < motions_.size(); ++m)
    for (const RecordedBody& body : motions_[m].tracked)
      flights_[m].push_back(internal::count_flight_rows(scenario, body, task_.start));
}

internal::OwnValues SceneExperiment::own_values(const Eigen::VectorXd& values) const {
  return {task_, path_unknowns_, values};
}

Eigen::VectorXd SceneExperiment::own_deviation() const { return internal::own_deviation(task_, path_unknowns_); }

Eigen::Index SceneExperiment::samples_of(std::size_t motion) const {
  const std::vector<BodyRows> rows = rows_of(motion);
  return rows.back().first + rows.back().count;
}

double SceneExperiment::longest() const {
  double most = 0.0;
  for (const RecordedMotion& motion : motions_) {
    const double start = task_.start.from == model::StartFrom::Scenario ? 0.0 : motion.times.front();
    most = std::max(most, motion.times[internal::sample_count(task_, motion) - 1] - start);
  }
  return most;
}

std::vector<SceneExperiment::BodyRows> SceneExperiment::rows_of(std::size_t motion) const {
  const int each = internal::numbers_of(task_);
  std::vector<BodyRows> rows;
  Eigen::Index first = 0;
  for (const std::vector<std::size_t>& samples : samples_[motion]) {
    const auto count = static_cast<Eigen::Index>(samples.size()) * each;
    rows.push_back({std::exchange(first, first + count), count, each, &samples});
  }
  return rows;
}

numerics::BatchedProblem::Term SceneExperiment::term_of(std::size_t motion) const {
  const Eigen::VectorXd deviation = own_deviation();
  const std::vector<BodyRows> rows = rows_of(motion);
  const Eigen::Index samples = rows.back().first + rows.back().count;
  numerics::BatchedProblem::Term term{
      samples + deviation.size(), Eigen::VectorXd::Zero(deviation.size()), kOwnStep * deviation, {}};
  term.own_step.tail(path_unknowns_) *= kPathStep / kOwnStep;
  for (const std::optional<std::size_t> body : internal::own_bodies(task_, path_unknowns_)) {
    const Eigen::Index prior = samples + static_cast<Eigen::Index>(term.own_rows.size());  // its row
    const Eigen::Index first = body ? rows[*body].first : 0, count = body ? rows[*body].count : samples;
    term.own_rows.push_back({{first, count}, {prior, 1}});
  }
  return term;
}

MotionError SceneExperiment::compare(const internal::SimulatedMotion& simulated, std::size_t motion,
                                     const Eigen::VectorXd& own, double until) const {
  MotionError error = internal::compare(task_, motions_[motion], samples_[motion], simulated, own_values(own), until);
  const Eigen::VectorXd deviation = own_deviation();
  if (deviation.size() > 0 && error.failure.empty()) {
    const Eigen::VectorXd used = own.size() > 0 ? own : Eigen::VectorXd(Eigen::VectorXd::Zero(deviation.size()));
    error.residuals.tail(deviation.size()) = used.cwiseQuotient(deviation);
  }
  return error;
}

std::vector<MotionError> SceneExperiment::evaluate(std::span<const Eigen::VectorXd> points, std::span<const Job> jobs,
                                                   double until) const {
  return task_.program ? evaluate_program(points, jobs, until) : evaluate_scenes(points, jobs, until);
}

std::optional<model::Scenario> SceneExperiment::find_scenario(const Eigen::VectorXd& values,
                                                              std::string& failure) const {
  try {
    return scenario_at(values);
  } catch (const InputError& error) {  // values that no scenario can have: a legitimate no of a search
    failure = error.what();
    return std::nullopt;
  }
}

std::size_t SceneExperiment::lead_of(std::size_t motion) const {
  return motions_[motion].drive ? motion : motions_.size();
}

const internal::ProgramRun* SceneExperiment::find_run(const Eigen::VectorXd& point, std::size_t lead,
                                                      double until) const {
  for (const KnownRun& known : runs_)
    if (known.lead == lead && known.values == point && known.run.until >= until) return &known.run;
  return nullptr;
}

std::vector<MotionError> SceneExperiment::evaluate_program(std::span<const Eigen::VectorXd> points,
                                                           std::span<const Job> jobs, double until) const {
  // A run for each point and each that leads the tool: the program, or a recording.
  std::map<std::pair<std::size_t, std::size_t>, double> ends;
  for (const Job& job : jobs) {
    double& end = ends[{job.point, lead_of(job.motion)}];
    end = std::max(end, internal::end_of(task_, motions_[job.motion], own_values(job.own), until));
  }
  // A little more than asked for, so that a start that is a little later needs no other run.
  constexpr double kMore = 0.05;  // s
  std::vector<std::pair<std::size_t, std::size_t>> open;
  for (const auto& [key, end] : ends)
    if (find_run(points[key.first], key.second, end) == nullptr) open.push_back(key);
  std::vector<KnownRun> made(open.size());
  parallel_for(static_cast<int>(open.size()), threads_, [&](int index, int) {
    const auto [point, lead] = open[static_cast<std::size_t>(index)];
    KnownRun& known = made[static_cast<std::size_t>(index)];
    known.values = points[point];
    known.lead = lead;
    const RecordedDrive* drive = lead < motions_.size() ? &*motions_[lead].drive : nullptr;
    std::string failure;
    if (const std::optional<model::Scenario> scenario = find_scenario(points[point], failure))
      known.run = internal::run_program(*scenario, task_, drive, ends.at({point, lead}) + kMore);
    else
      known.run = {{}, std::numeric_limits<double>::infinity(), 0.0, failure};
  });
  for (KnownRun& known : made) {
    std::erase_if(runs_,
                  [&](const KnownRun& other) { return other.lead == known.lead && other.values == known.values; });
    runs_.push_back(std::move(known));
  }
  std::vector<MotionError> errors(jobs.size());
  parallel_for(static_cast<int>(jobs.size()), threads_, [&](int index, int) {
    const auto j = static_cast<std::size_t>(index);
    const Job& job = jobs[j];
    const internal::OwnValues own = own_values(job.own);
    const internal::ProgramRun& run =
        *find_run(points[job.point], lead_of(job.motion), ends.at({job.point, lead_of(job.motion)}));
    errors[j] =
        compare(internal::motion_of(run, motions_[job.motion], samples_[job.motion], own), job.motion, job.own, until);
  });
  // The latest are asked for again: a step of a search is where the next one starts.
  const std::size_t most = std::max<std::size_t>(kKnownRuns, ends.size());
  if (runs_.size() > most) runs_.erase(runs_.begin(), runs_.end() - static_cast<std::ptrdiff_t>(most));
  return errors;
}

internal::SimulatedMotion SceneExperiment::simulate(const model::Scenario& scenario, const Job& job,
                                                    double until) const {
  const internal::OwnValues own = own_values(job.own);
  std::vector<DrivenPath> driven = driven_of(job.motion, own.path);
  const double rate = job.clock_rate + own.clock_rate;
  if (rate == 0.0)
    return internal::simulate_scene(scenario, task_, motions_[job.motion], driven, flights_[job.motion], own, until);
  const double slower = 1.0 / (1.0 + rate);
  RecordedMotion motion = motions_[job.motion];
  for (double& time : motion.times) time *= slower;
  for (RecordedBody& body : motion.tracked)
    for (Twist& twist : body.twists) twist = {twist.linear / slower, twist.angular / slower};
  for (DrivenPath& path : driven) {
    for (double& time : path.position.times) time *= slower;
    for (double& time : path.rotation.times) time *= slower;
  }
  return internal::simulate_scene(scenario, task_, motion, driven, flights_[job.motion], own, until * slower);
}

std::vector<MotionError> SceneExperiment::evaluate_scenes(std::span<const Eigen::VectorXd> points,
                                                          std::span<const Job> jobs, double until) const {
  std::vector<std::optional<model::Scenario>> scenarios(points.size());
  std::vector<std::string> failures(points.size());
  parallel_for(static_cast<int>(points.size()), threads_, [&](int index, int) {
    const auto i = static_cast<std::size_t>(index);
    scenarios[i] = find_scenario(points[i], failures[i]);
  });
  // What a recording has of its own moves bodies by their start, their clock and the driven bodies' paths only.
  std::map<std::pair<std::pair<std::size_t, std::size_t>, std::vector<double>>, std::size_t> known;
  std::vector<std::size_t> first, simulation_of;  // job of each simulation, simulation of each job
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    const internal::OwnValues own = own_values(jobs[j].own);
    const Vector6 start = as_vector(own.start);
    std::vector<double> moving(start.data(), start.data() + start.size());
    moving.push_back(own.delay);
    moving.push_back(jobs[j].clock_rate + own.clock_rate);
    moving.insert(moving.end(), own.path.data(), own.path.data() + own.path.size());
    const auto [at, is_new] = known.insert({{{jobs[j].point, jobs[j].motion}, std::move(moving)}, first.size()});
    if (is_new) first.push_back(j);
    simulation_of.push_back(at->second);
  }
  std::vector<internal::SimulatedMotion> simulated(first.size());
  parallel_for(static_cast<int>(first.size()), threads_, [&](int index, int) {
    const auto i = static_cast<std::size_t>(index);
    const Job& job = jobs[first[i]];
    if (scenarios[job.point])
      simulated[i] = simulate(*scenarios[job.point], job, until);
    else
      simulated[i].failure = failures[job.point];
  });
  std::vector<MotionError> errors(jobs.size());
  parallel_for(static_cast<int>(jobs.size()), threads_, [&](int index, int) {
    const auto j = static_cast<std::size_t>(index);
    errors[j] = compare(simulated[simulation_of[j]], jobs[j].motion, jobs[j].own, until);
  });
  return errors;
}

std::vector<MotionError> SceneExperiment::evaluate_floor(const Eigen::VectorXd& values, std::uint64_t seed) const {
  if (task_.start.from != model::StartFrom::FreeFlight)
    throw InputError(task_.path.string(), "start", "no free flight", "from: free_flight, whose noise sets the floor");
  const model::Scenario scenario = scenario_at(values);
  const internal::OwnValues own = own_values({});
  constexpr double kAll = std::numeric_limits<double>::infinity();
  std::vector<MotionError> errors(motions_.size());
  parallel_for(static_cast<int>(motions_.size()), threads_, [&](int index, int) {
    const auto m = static_cast<std::size_t>(index);
    RecordedMotion twin = motions_[m];
    const internal::SimulatedMotion exact =
        internal::simulate_scene(scenario, task_, twin, driven_of(m, {}), flights_[m], own, kAll);
    RecordedMotion noisy = twin;
    Rng rng = Rng(seed).split("floor " + twin.name);
    for (std::size_t b = 0; b < twin.tracked.size() && exact.failure.empty(); ++b) {
      const std::size_t rows = flights_[m][b];
      const model::Body& body = *model::find_body(scenario, twin.tracked[b].body);
      if (rows < 4) {
        errors[m].failure = "fewer than four rows of free flight";
        return;
      }
      const FlightStart flight =
          fit_free_flight(std::span(twin.times).first(rows), std::span(twin.tracked[b].poses).first(rows), body.inertia,
                          scenario.gravity);
      twin.tracked[b].poses = exact.bodies[b];
      noisy.tracked[b].poses = exact.bodies[b];
      for (std::size_t k = 0; k < rows; ++k) {
        record::PoseSample& pose = noisy.tracked[b].poses[k];
        pose = Pose{pose.pose().R * exp_rotation(internal::normal3(rng, flight.rotation_rms)),
                    pose.p + internal::normal3(rng, flight.position_rms)};
      }
    }
    internal::SimulatedMotion again =
        internal::simulate_scene(scenario, task_, noisy, driven_of(m, {}), flights_[m], own, kAll);
    if (!exact.failure.empty()) again.failure = exact.failure;
    errors[m] = internal::compare(task_, twin, internal::compared_samples(task_, twin), again, own, kAll);
  });
  return errors;
}

double SceneExperiment::cost_of(const MotionError& error) const {
  const double ratio = task_.rotation_position_ratio;
  const double use_position = task_.use_position ? 1.0 : 0.0, use_rotation = task_.use_rotation ? 1.0 : 0.0;
  if (!error.failure.empty()) return 1e3 * internal::kLost * (use_position + use_rotation * ratio);
  if (task_.loss == model::TaskLoss::Distance)
    return 1e3 * (use_position * error.position + use_rotation * ratio * error.rotation);
  return 1e3 * std::sqrt(use_position * error.position_square + use_rotation * ratio * ratio * error.rotation_square);
}

SceneError SceneExperiment::summarize(std::span<const MotionError> errors) const {
  SceneError sum;
  for (const MotionError& error : errors) {
    const bool has_failed = !error.failure.empty();
    sum.failed += has_failed ? 1 : 0;
    sum.position_mm += 1e3 * (has_failed ? internal::kLost : error.position);
    sum.rotation_deg += kDegrees * (has_failed ? internal::kLost : error.rotation);
    sum.end_position_mm += 1e3 * (has_failed ? internal::kLost : error.end_position);
    sum.end_rotation_deg += kDegrees * (has_failed ? internal::kLost : error.end_rotation);
    sum.right_orientation_percent += 100.0 * error.right;
    sum.cost += cost_of(error);
  }
  sum.recordings = static_cast<int>(errors.size());
  const double count = std::max(1.0, static_cast<double>(errors.size()));
  for (double* value : {&sum.position_mm, &sum.rotation_deg, &sum.end_position_mm, &sum.end_rotation_deg,
                        &sum.right_orientation_percent, &sum.cost})
    *value /= count;
  return sum;
}

}  // namespace snug::identification
