// Tosses: the same search and the same figures for every engine.
#include "peers/tosses.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <thread>

#include "snug/core/parallel.hpp"
#include "snug/core/rng.hpp"
#include "snug/identification/free_flight.hpp"
#include "snug/identification/recorded_motion.hpp"
#include "snug/numerics/bounded_search.hpp"

namespace snug::peers {
namespace {

constexpr double kEdge = 0.1048, kMass = 0.370, kMoment = 8.1e-4;  // m, kg, kg m^2: as the source of the data says
constexpr double kRatio = 0.05;                                    // m/rad
constexpr double kMargin = 0.002;                                  // m: nearer to the board a corner may touch
constexpr int kFlight = 25;                                        // samples of the free flight, at most
constexpr double kStep = 1e-3;                                     // s
constexpr std::size_t kHeldBack = 5;                               // each fifth toss
constexpr double kRight = std::numbers::pi / 6.0;                  // rad, at the end

/// An unknown, and where it is looked for.
struct Number {
  const char* name;
  double lower, upper, start;
};
/// Bounds around what flights and changes of momentum say: tracked lengths are 2 % short, the cube is hollow.
constexpr std::array kNumbers{
    Number{"friction", 0.10, 0.30, 0.18},
    Number{"softness", 0.0, 1.0, 0.5},
    Number{"damping", 0.0, 1.0, 0.3},
    Number{"edge", 0.96, 1.00, 0.979},
    Number{"moments", 1.2, 1.6, 1.4},
    Number{"height_m", -0.002, 0.002, 0.0},
    Number{"own", 0.0, 1.0, 0.3},
    Number{"middle_z_m", -0.004, 0.004, 0.0}  // of the cube, in the frame that was tracked
};

Eigen::VectorXd all_of(double Number::*value) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(kNumbers.size()));
  for (std::size_t i = 0; i < kNumbers.size(); ++i) all[static_cast<Eigen::Index>(i)] = kNumbers[i].*value;
  return all;
}

/// The first as the numbers say, the others in the middle half of what the bounds span.
Eigen::VectorXd start_of(int search) {
  const Eigen::VectorXd lower = all_of(&Number::lower), span = all_of(&Number::upper) - lower;
  if (search == 0) return all_of(&Number::start);
  Rng rng = Rng(1).split(std::to_string(search));
  Eigen::VectorXd start = lower;
  for (Eigen::Index i = 0; i < start.size(); ++i) start[i] += rng.uniform(0.25, 0.75) * span[i];
  return start;
}

/// What the free flights say: where the centre of mass is in the tracked frame, and how it falls (lengths of the
/// tracking may be short, and gravity with them).
struct Flights {
  Vector3 com = Vector3::Zero();
  Vector3 gravity = Vector3::Zero();
};

Scene scene_of(const Eigen::VectorXd& x, const Flights& flights) {
  Scene scene;
  scene.name = "toss";
  scene.has_plane = true;
  scene.plane_height = x[5];
  scene.gravity = flights.gravity;
  Contact contact;
  contact.friction = x[0];
  contact.restitution = 1e-9 + 0.3 * x[6];         // Bullet's own; it divides by it
  contact.stiffness = 2e3 * std::pow(30.0, x[1]);  // 2 to 60 kN/m
  contact.damping = 200.0 * x[2];                  // Ns/m
  contact.snug_damping_ratio = x[2];
  contact.time_constant = 0.02 * std::pow(0.1, x[1]);  // 20 to 2 ms
  contact.damping_ratio = 0.1 + 1.9 * x[2];
  contact.edge_friction = (1.0 - 0.5 * x[6]) * x[0];  // snug's own
  contact.impedance = 0.95 - 0.45 * x[6];             // MuJoCo's own
  scene.box_container = contact;
  scene.box_box = contact;
  BoxBody cube{"cube", Vector3::Constant(0.5 * kEdge * x[3]), kMass, {}};
  const double solid = kMass * std::pow(kEdge * x[3], 2) / 6.0;
  cube.inertia_factor = x[4] * kMoment / solid;
  cube.middle = Vector3(0.0, 0.0, x[7]) - flights.com;
  cube.X_WB.p.z() = 1.0;
  scene.bodies.push_back(cube);
  return scene;
}

struct Toss {
  std::vector<double> times;
  std::vector<record::PoseSample> poses;  ///< of the tracked frame
  std::size_t flight = 3;                 ///< samples before the first touch
  Pose X_WC;                              ///< at the start, of the centre of mass, by the flight
  Twist V_WC;
};

std::size_t count_flight(const identification::RecordedBody& body) {
  std::size_t k = 0;
  for (; k < std::min<std::size_t>(body.poses.size(), kFlight); ++k) {
    const Pose X = body.poses[k].pose();
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) {
      const Vector3 corner((i & 1) ? 1.0 : -1.0, (i & 2) ? 1.0 : -1.0, (i & 4) ? 1.0 : -1.0);
      lowest = std::min(lowest, (X * Vector3(0.5 * kEdge * corner)).z());
    }
    if (lowest <= kMargin) break;
  }
  return k;
}

std::vector<Toss> load(const std::filesystem::path& file) {
  model::SceneTask task;
  task.recording_column = "toss";
  task.tracked = {{"cube", {"x", "y", "z", "qw", "qx", "qy", "qz"}, {}, {}}};
  std::vector<Toss> tosses;
  for (const identification::RecordedMotion& motion : identification::load_motions(task, {file})) {
    Toss& toss = tosses.emplace_back();
    const identification::RecordedBody& body = motion.tracked.front();
    for (const double time : motion.times) toss.times.push_back(time - motion.times.front());
    toss.poses = body.poses;
    toss.flight = std::max<std::size_t>(3, count_flight(body));
  }
  return tosses;
}

/// Least squares over all flights: p + R com is a parabola, p0 and v0 of each flight its own and eliminated.
Flights fit_flights(const std::vector<Toss>& tosses) {
  Matrix6 square = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (const Toss& toss : tosses) {
    const auto count = static_cast<Eigen::Index>(toss.flight);
    Eigen::MatrixXd line(3 * count, 6), rows(3 * count, 6);  // p0 and v0; com and gravity
    Eigen::VectorXd measured(3 * count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Pose X = toss.poses[static_cast<std::size_t>(k)].pose();
      const double t = toss.times[static_cast<std::size_t>(k)];
      line.middleRows<3>(3 * k) << Matrix3::Identity(), t * Matrix3::Identity();
      rows.middleRows<3>(3 * k) << -X.R, 0.5 * t * t * Matrix3::Identity();
      measured.segment<3>(3 * k) = X.p;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(line);
    const Eigen::MatrixXd own = qr.householderQ() * Eigen::MatrixXd::Identity(3 * count, 6);
    rows -= own * (own.transpose() * rows).eval();
    measured -= own * (own.transpose() * measured).eval();
    square += rows.transpose() * rows;
    right += rows.transpose() * measured;
  }
  const Vector6 x = square.ldlt().solve(right);
  return {x.head<3>(), x.tail<3>()};
}

struct Error {
  double position = 1.0, rotation = 1.0;  // m, rad: what an engine that gave up counts as
  bool is_right = false;
};

void fill_start(const Flights& flights, Toss& toss) {
  const SpatialInertia inertia{kMass, flights.com, Matrix3(kMoment * Matrix3::Identity())};
  const identification::FlightStart start = identification::fit_free_flight(
      std::span(toss.times).first(toss.flight), std::span(toss.poses).first(toss.flight), inertia, flights.gravity);
  toss.X_WC = start.X_WB * Pose{Matrix3::Identity(), flights.com};
  toss.V_WC = {start.V_WB.linear + start.V_WB.angular.cross(start.X_WB.R * flights.com), start.V_WB.angular};
}

Error predict(Engine& engine, const Toss& toss, const Vector3& com) {
  const Pose X_CB{Matrix3::Identity(), -com};
  engine.set_motion(0, toss.X_WC, toss.V_WC);
  const auto step_of = [](double time) { return static_cast<int>(std::ceil((time - 1e-9) / kStep)); };
  const int last = step_of(toss.times.back());
  const std::vector<Pose> path = engine.follow(0, last);
  if (std::ssize(path) < last) return {};
  const auto pose_after = [&](int steps) { return steps > 0 ? path[static_cast<std::size_t>(steps - 1)] : toss.X_WC; };
  Error error{0.0, 0.0, false};
  double angle = 0.0;
  for (std::size_t k = 1; k < toss.times.size(); ++k) {
    const int steps = step_of(toss.times[k]);
    const Pose before = pose_after(steps - 1), now = pose_after(steps);
    const double share = 1.0 - (steps * kStep - toss.times[k]) / kStep;
    const Pose X_WC{before.R * exp_rotation(share * log_rotation(before.R.transpose() * now.R)),
                    before.p + share * (now.p - before.p)};
    const Pose X_WB = X_WC * X_CB, measured = toss.poses[k].pose();
    angle = angle_between(X_WB.R, measured.R);
    error.position += (X_WB.p - measured.p).norm();
    error.rotation += angle;
  }
  const auto count = static_cast<double>(toss.times.size() - 1);
  error.position /= count;
  error.rotation /= count;
  error.is_right = angle <= kRight;
  return error;
}

}  // namespace

std::vector<Result> measure_tosses(const std::function<std::unique_ptr<Engine>()>& make, const TossOptions& options) {
  std::vector<Toss> tosses = load(options.file);
  std::vector<std::size_t> all(tosses.size()), fitted, held;
  for (std::size_t i = 0; i < tosses.size(); ++i) {
    all[i] = i;
    (i % kHeldBack == kHeldBack - 1 ? held : fitted).push_back(i);
  }
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::unique_ptr<Engine>> engines(static_cast<std::size_t>(threads));
  for (std::unique_ptr<Engine>& engine : engines) engine = make();
  std::vector<Toss> known;
  for (const std::size_t i : fitted) known.push_back(tosses[i]);
  const Flights flights = fit_flights(known);
  for (Toss& toss : tosses) fill_start(flights, toss);
  const auto predict_all = [&](const Eigen::VectorXd& x, const std::vector<std::size_t>& which) {
    const Scene scene = scene_of(x, flights);
    std::vector<Error> errors(which.size());
    parallel_for(static_cast<int>(which.size()), threads, [&](int i, int thread) {
      Engine& engine = *engines[static_cast<std::size_t>(thread)];
      engine.build(scene, kStep);
      errors[static_cast<std::size_t>(i)] = predict(engine, tosses[which[static_cast<std::size_t>(i)]], flights.com);
    });
    return errors;
  };
  const auto cost = [&](const Eigen::VectorXd& x) {
    double sum = 0.0;
    for (const Error& error : predict_all(x, fitted)) sum += error.position + kRatio * error.rotation;
    return 1e3 * sum / static_cast<double>(fitted.size());
  };
  numerics::SearchOptions search;
  search.evaluations = options.evaluations;
  numerics::SearchResult found;
  found.cost = std::numeric_limits<double>::infinity();
  double worst = 0.0;
  for (int i = 0; i < options.starts; ++i) {
    const numerics::SearchResult one =
        numerics::minimize_bounded(cost, start_of(i), all_of(&Number::lower), all_of(&Number::upper), search);
    worst = std::max(worst, one.cost);
    if (one.cost < found.cost) found = one;
  }
  std::vector<Result> results;
  results.push_back({"tosses.best_start.cost_mm", found.cost, "mm"});
  results.push_back({"tosses.worst_start.cost_mm", worst, "mm"});
  const auto add = [&](const std::string& name, const std::vector<std::size_t>& which) {
    double position = 0.0, rotation = 0.0, right = 0.0;
    for (const Error& error : predict_all(found.x, which)) {
      position += error.position, rotation += error.rotation, right += error.is_right ? 1.0 : 0.0;
    }
    const auto count = static_cast<double>(which.size());
    results.push_back({"tosses." + name + ".position_mm", 1e3 * position / count, "mm"});
    results.push_back({"tosses." + name + ".rotation_deg", 180.0 / std::numbers::pi * rotation / count, "deg"});
    results.push_back({"tosses." + name + ".right_face_percent", 100.0 * right / count, "%"});
  };
  add("all", all);
  add("held_back", held);
  for (std::size_t i = 0; i < kNumbers.size(); ++i)
    results.push_back({std::string("tosses.found.") + kNumbers[i].name, found.x[static_cast<Eigen::Index>(i)], "1"});
  return results;
}

}  // namespace snug::peers
