// SceneExperiment: a scenario at given values, beside each recording.
#include "snug/identification/scene_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/identification/free_flight.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/internal/motion_error.hpp"
#include "snug/identification/internal/program_motion.hpp"
#include "snug/identification/internal/scene_motion.hpp"
#include "snug/model/number_edit.hpp"

namespace snug::identification {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kOwnStep = 0.01;  // of what is expected of an own unknown, for differences
constexpr double kLost = 1.0;      // m and rad: what a recording without a simulation counts as

}  // namespace

SceneExperiment::SceneExperiment(model::SceneTask task, std::vector<RecordedMotion> motions, int threads)
    : task_(std::move(task)),
      motions_(std::move(motions)),
      threads_(threads),
      base_(model::load_scenario(task_.scenario)) {
  if (task_.time_step) base_.time_step = *task_.time_step;
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
  (void)scenario_at(start());
  find_flights();
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

void SceneExperiment::find_flights() {
  flights_.assign(motions_.size(), {});
  if (task_.start.from != model::StartFrom::FreeFlight) return;
  const model::Scenario scenario = scenario_at(start());
  for (std::size_t m = 0; m < motions_.size(); ++m)
    for (const RecordedBody& body : motions_[m].tracked)
      flights_[m].push_back(internal::count_flight_rows(scenario, body, task_.start));
}

Eigen::VectorXd SceneExperiment::own_deviation() const { return internal::own_deviation(task_); }

Eigen::Index SceneExperiment::samples_of(std::size_t motion) const {
  return internal::count_residuals(task_, motions_[motion]);
}

numerics::BatchedProblem::Term SceneExperiment::term_of(std::size_t motion) const {
  const Eigen::VectorXd deviation = own_deviation();
  const Eigen::Index samples = samples_of(motion);
  const auto bodies = static_cast<Eigen::Index>(motions_[motion].tracked.size());
  numerics::BatchedProblem::Term term{
      samples + deviation.size(), Eigen::VectorXd::Zero(deviation.size()), kOwnStep * deviation, {}};
  for (const std::optional<std::size_t> body : internal::own_bodies(task_)) {
    const Eigen::Index prior = samples + static_cast<Eigen::Index>(term.own_rows.size());  // its row
    const Eigen::Index count = body ? samples / bodies : samples;
    const Eigen::Index first = body ? static_cast<Eigen::Index>(*body) * count : 0;
    term.own_rows.push_back({{first, count}, {prior, 1}});
  }
  return term;
}

MotionError SceneExperiment::compare(const internal::SimulatedMotion& simulated, std::size_t motion,
                                     const Eigen::VectorXd& own) const {
  MotionError error = internal::compare(task_, motions_[motion], simulated, internal::OwnValues(task_, own));
  const Eigen::VectorXd deviation = own_deviation();
  if (deviation.size() > 0 && error.failure.empty()) {
    const Eigen::VectorXd used = own.size() > 0 ? own : Eigen::VectorXd(Eigen::VectorXd::Zero(deviation.size()));
    error.residuals.tail(deviation.size()) = used.cwiseQuotient(deviation);
  }
  return error;
}

std::vector<MotionError> SceneExperiment::evaluate(std::span<const Eigen::VectorXd> points,
                                                   std::span<const Job> jobs) const {
  std::vector<std::optional<model::Scenario>> scenarios(points.size());
  std::vector<std::string> failures(points.size());
  parallel_for(static_cast<int>(points.size()), threads_, [&](int index, int) {
    const auto i = static_cast<std::size_t>(index);
    try {
      scenarios[i] = scenario_at(points[i]);
    } catch (const InputError& error) {  // values that no scenario can have: a legitimate no of a search
      failures[i] = error.what();
    }
  });
  std::vector<internal::ProgramRun> runs(task_.program ? points.size() : 0);
  std::vector<double> ends(runs.size(), 0.0);
  for (const Job& job : jobs)
    if (task_.program)
      ends[job.point] =
          std::max(ends[job.point], internal::end_of(task_, motions_[job.motion], internal::OwnValues(task_, job.own)));
  parallel_for(static_cast<int>(runs.size()), threads_, [&](int index, int) {
    const auto i = static_cast<std::size_t>(index);
    if (scenarios[i] && ends[i] > 0.0) runs[i] = internal::run_program(*scenarios[i], task_, ends[i]);
  });
  // What a recording has of its own moves bodies by their start and the delay only.
  std::map<std::pair<std::pair<std::size_t, std::size_t>, std::vector<double>>, std::size_t> known;
  std::vector<std::size_t> first, simulation_of;  // job of each simulation, simulation of each job
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    const internal::OwnValues own(task_, jobs[j].own);
    const Vector6 start = as_vector(own.start);
    std::vector<double> moving(start.data(), start.data() + start.size());
    moving.push_back(own.delay);
    const auto [at, is_new] = known.insert({{{jobs[j].point, jobs[j].motion}, std::move(moving)}, first.size()});
    if (is_new) first.push_back(j);
    simulation_of.push_back(at->second);
  }
  std::vector<internal::SimulatedMotion> simulated(first.size());
  parallel_for(static_cast<int>(first.size()), threads_, [&](int index, int) {
    const auto i = static_cast<std::size_t>(index);
    const Job& job = jobs[first[i]];
    const RecordedMotion& motion = motions_[job.motion];
    const internal::OwnValues own(task_, job.own);
    if (!scenarios[job.point])
      simulated[i].failure = failures[job.point];
    else if (task_.program)
      simulated[i] = internal::motion_of(runs[job.point], task_, motion, own);
    else
      simulated[i] = internal::simulate_scene(*scenarios[job.point], task_, motion, flights_[job.motion], own);
  });
  std::vector<MotionError> errors(jobs.size());
  parallel_for(static_cast<int>(jobs.size()), threads_, [&](int index, int) {
    const auto j = static_cast<std::size_t>(index);
    errors[j] = compare(simulated[simulation_of[j]], jobs[j].motion, jobs[j].own);
  });
  return errors;
}

std::vector<MotionError> SceneExperiment::evaluate_floor(const Eigen::VectorXd& values, std::uint64_t seed) const {
  if (task_.start.from != model::StartFrom::FreeFlight)
    throw InputError(task_.path.string(), "start", "no free flight", "from: free_flight, whose noise sets the floor");
  const model::Scenario scenario = scenario_at(values);
  const internal::OwnValues own(task_, {});
  std::vector<MotionError> errors(motions_.size());
  parallel_for(static_cast<int>(motions_.size()), threads_, [&](int index, int) {
    const auto m = static_cast<std::size_t>(index);
    RecordedMotion twin = motions_[m];
    const internal::SimulatedMotion exact = internal::simulate_scene(scenario, task_, twin, flights_[m], own);
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
    internal::SimulatedMotion again = internal::simulate_scene(scenario, task_, noisy, flights_[m], own);
    if (!exact.failure.empty()) again.failure = exact.failure;
    errors[m] = internal::compare(task_, twin, again, own);
  });
  return errors;
}

double SceneExperiment::cost_of(const MotionError& error) const {
  const double ratio = task_.rotation_position_ratio;
  const double use_position = task_.use_position ? 1.0 : 0.0, use_rotation = task_.use_rotation ? 1.0 : 0.0;
  if (!error.failure.empty()) return 1e3 * kLost * (use_position + use_rotation * ratio);
  if (task_.loss == model::TaskLoss::Distance)
    return 1e3 * (use_position * error.position + use_rotation * ratio * error.rotation);
  return 1e3 * std::sqrt(use_position * error.position_square + use_rotation * ratio * ratio * error.rotation_square);
}

SceneError SceneExperiment::summarize(std::span<const MotionError> errors) const {
  SceneError sum;
  for (const MotionError& error : errors) {
    const bool has_failed = !error.failure.empty();
    sum.failed += has_failed ? 1 : 0;
    sum.position_mm += 1e3 * (has_failed ? kLost : error.position);
    sum.rotation_deg += kDegrees * (has_failed ? kLost : error.rotation);
    sum.end_position_mm += 1e3 * (has_failed ? kLost : error.end_position);
    sum.end_rotation_deg += kDegrees * (has_failed ? kLost : error.end_rotation);
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
