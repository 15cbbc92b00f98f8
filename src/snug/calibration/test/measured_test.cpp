// Calibrations from measurements: planted deviations come back within the uncertainty that is predicted; bad data are
// refused with words that help.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/force_sensor.hpp"
#include "snug/calibration/identify.hpp"
#include "snug/calibration/test/nominal.hpp"
#include "snug/calibration/tool_tip.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::calibration {
namespace {

using test::nominal;
using test::normal3;

void append(Table& table, std::vector<double> row) {
  table.rows.push_back(std::move(row));
  table.lines.push_back(static_cast<int>(table.rows.size()) + 1);  // below the header
}

std::vector<double> pose_cells(const Pose& X) {
  const Vector3 r = log_rotation(X.R);
  return {X.p.x(), X.p.y(), X.p.z(), r.x(), r.y(), r.z()};
}

void expect_refused(const std::function<void()>& work, const std::string& part) {
  try {
    work();
    ADD_FAILURE() << "accepted; expected a complaint with '" << part << "'";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

/// Mean of `count` values that are chi-square with `degrees` degrees of freedom must lie within 4 standard deviations.
void expect_chi_square_mean(double mean, double degrees, int count) {
  EXPECT_NEAR(mean, degrees, 4.0 * std::sqrt(2.0 * degrees / count));
}

// --- kinematics ----------------------------------------------------------------------------------------------------

constexpr double kPositionNoise = 1e-4;  // m
constexpr double kAngleNoise = 2e-4;     // rad

MeasuredFrames frames() { return {robot::find_link(nominal(), "base"), robot::find_link(nominal(), "tool0")}; }

Eigen::VectorXd planted_deviations(Rng& rng) {
  Eigen::VectorXd x(deviation_count(nominal()));
  // Shifts of 1 mm and turns of 5 mrad, as real arms have.
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool is_turn = i < 24 ? i % 4 >= 2 : i >= 27;
    x(i) = (is_turn ? 5e-3 : 1e-3) * rng.normal();
  }
  return x;
}

PosePairs simulate_pairs(const robot::ArmModel& arm, Rng& rng, int count, double noise, double joint_range) {
  Table table{"pairs.csv", {}, {}, {}};
  for (int k = 0; k < count; ++k) {
    robot::JointVector q(6);
    std::vector<double> row;
    for (int i = 0; i < 6; ++i) {
      q(i) = rng.uniform(-joint_range, joint_range);
      row.push_back(q(i));
    }
    const robot::ArmPose at = robot::forward(arm, q);
    Pose X = robot::link_pose(arm, at, frames().base).inverse() * robot::link_pose(arm, at, frames().end);
    X.p += normal3(rng, noise * kPositionNoise);
    X.R = exp_rotation(normal3(rng, noise * kAngleNoise)) * X.R;
    for (const double cell : pose_cells(X)) row.push_back(cell);
    append(table, row);
  }
  return make_pose_pairs(std::move(table), nominal());
}

TEST(IdentifyArm, FindsPlantedDeviationsExactlyWithoutNoise) {
  Rng rng = Rng(1).split("exact");
  const Eigen::VectorXd planted = planted_deviations(rng);
  const robot::ArmModel real = with_deviations(nominal(), planted);
  const IdentifiedArm found = identify_arm(nominal(), simulate_pairs(real, rng, 40, 0.0, 3.0), frames());
  EXPECT_LT((found.deviations - planted).cwiseAbs().maxCoeff(), 1e-9);  // of the convergence test, in m and rad
  EXPECT_GT(found.rms_position_before, 1e-3);
  EXPECT_LT(found.rms_position, 1e-9);
  // Frames near nominal change nothing at the end.
  for (int k = 0; k < 20; ++k) {
    robot::JointVector q(6);
    for (int i = 0; i < 6; ++i) q(i) = rng.uniform(-3.0, 3.0);
    EXPECT_LT((robot::forward_tool(found.arm, q).p - robot::forward_tool(real, q).p).norm(), 2e-9);
  }
}

TEST(IdentifyArm, FindsPlantedDeviationsWithinThePredictedUncertainty) {
  constexpr int kSeeds = 20;
  double chi_square = 0.0;
  double noise = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Rng rng = Rng(static_cast<std::uint64_t>(seed)).split("identify");
    const Eigen::VectorXd planted = planted_deviations(rng);
    const IdentifiedArm found =
        identify_arm(nominal(), simulate_pairs(with_deviations(nominal(), planted), rng, 60, 1.0, 2.8), frames());
    const Eigen::VectorXd error = found.deviations - planted;
    chi_square += error.dot(found.covariance.ldlt().solve(error)) / kSeeds;
    noise += found.position_noise / kSeeds;
  }
  // 30 deviations; noise estimated from 330 residuals raises the mean by 330 / 328 and the spread little; the weights,
  // from medians of 60, by some percent more, which 4 standard deviations of the mean (7) cover.
  expect_chi_square_mean(chi_square, 30.0, kSeeds);
  EXPECT_NEAR(noise / kPositionNoise, 1.0, 0.1);
}

TEST(IdentifyArm, RefusesTooFewPairs) {
  Rng rng = Rng(3).split("few");
  expect_refused([&] { (void)identify_arm(nominal(), simulate_pairs(nominal(), rng, 9, 1.0, 3.0), frames()); },
                 "9 joint and pose pairs; expected 10 or more");
}

TEST(IdentifyArm, RefusesPosesThatDetermineTooLittle) {
  Rng rng = Rng(4).split("degenerate");
  expect_refused([&] { (void)identify_arm(nominal(), simulate_pairs(nominal(), rng, 40, 0.0, 1e-3), frames()); },
                 "undetermined");
}

TEST(IdentifyArm, NamesTheLinesOfOutliers) {
  Rng rng = Rng(5).split("outlier");
  PosePairs pairs = simulate_pairs(with_deviations(nominal(), planted_deviations(rng)), rng, 50, 1.0, 2.8);
  pairs.X_BF[17].p.x() += 0.01;
  pairs.X_BF[31].R = exp_rotation(Vector3(0.0, 0.02, 0.0)) * pairs.X_BF[31].R;
  expect_refused([&] { (void)identify_arm(nominal(), pairs, frames()); }, "line 19, 33");
}

// --- tool tip ------------------------------------------------------------------------------------------------------

const Vector3 kTip(0.004, -0.003, 0.341);
const Vector3 kPoint(0.5, -0.3, -0.1);

Table simulate_touches(Rng& rng, int count, double noise, bool is_planar) {
  Table table{"touches.csv", tool_tip_columns(), {}, {}};
  for (int k = 0; k < count; ++k) {
    Vector3 turn = normal3(rng, 0.4);
    if (is_planar) turn.head<2>().setZero();
    const Matrix3 R = exp_rotation(Vector3(std::numbers::pi, 0, 0)) * exp_rotation(turn);
    append(table, pose_cells({R, kPoint - R * kTip + normal3(rng, noise)}));
  }
  return table;
}

TEST(ToolTip, IsExactWithoutNoise) {
  Rng rng = Rng(6).split("tip");
  const ToolTip tip = find_tool_tip(simulate_touches(rng, 8, 0.0, false));
  EXPECT_LT((tip.p_FQ - kTip).norm(), 1e-12);
  EXPECT_LT((tip.p_WQ - kPoint).norm(), 1e-12);
}

TEST(ToolTip, LiesWithinThePredictedUncertainty) {
  constexpr int kSeeds = 300;
  double chi_square = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Rng rng = Rng(static_cast<std::uint64_t>(seed)).split("tip");
    const ToolTip tip = find_tool_tip(simulate_touches(rng, 24, 2e-4, false));
    const Vector3 error = tip.p_FQ - kTip;
    chi_square += error.dot(tip.covariance.ldlt().solve(error)) / kSeeds;
  }
  // Noise is estimated from 66 residuals: the mean of 3 becomes 3 * 66 / 64.
  expect_chi_square_mean(chi_square * 64.0 / 66.0, 3.0, kSeeds);
}

TEST(ToolTip, RefusesPosesTurnedAboutOneAxisAndTooFew) {
  Rng rng = Rng(7).split("planar");
  expect_refused([&] { (void)find_tool_tip(simulate_touches(rng, 10, 0.0, true)); }, "(0.00, 0.00,");
  expect_refused([&] { (void)find_tool_tip(simulate_touches(rng, 3, 0.0, false)); }, "3 touches");
}

TEST(ToolTip, NamesTheLineOfAnOutlier) {
  Rng rng = Rng(8).split("outlier");
  Table table = simulate_touches(rng, 15, 1e-4, false);
  table.rows[6][1] += 0.005;
  expect_refused([&] { (void)find_tool_tip(table); }, "line 8");
}

// --- force sensor --------------------------------------------------------------------------------------------------

constexpr double kMass = 1.0;
const Vector3 kCom(0.002, -0.001, 0.17);
const Vector3 kScale(1.02, 0.97, 1.0 / (1.02 * 0.97));  // product 1
const Vector3 kForceOffset(3.0, -2.0, 12.0);
const Vector3 kTorqueOffset(0.2, -0.1, 0.05);

Table simulate_readings(Rng& rng, int repeats, double force_noise, double torque_noise) {
  Table table{"readings.csv", force_sensor_columns(), {}, {}};
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  // Each axis down and up, a little off, as hands do it.
  for (int k = 0; k < repeats; ++k) {
    for (const Vector3& turn : {Vector3(0, 0, 0), Vector3(2 * kQuarter, 0, 0), Vector3(kQuarter, 0, 0),
                                Vector3(-kQuarter, 0, 0), Vector3(0, kQuarter, 0), Vector3(0, -kQuarter, 0)}) {
      const Matrix3 R = exp_rotation(turn) * exp_rotation(normal3(rng, 0.1));
      const Vector3 force = kMass * (R.transpose() * Vector3(0, 0, -9.81));
      const Vector3 torque = kCom.cross(force) + kTorqueOffset + normal3(rng, torque_noise);
      const Vector3 reading = force.cwiseQuotient(kScale) + kForceOffset + normal3(rng, force_noise);
      const Vector3 r = log_rotation(R);
      append(table, {r.x(), r.y(), r.z(), reading.x(), reading.y(), reading.z(), torque.x(), torque.y(), torque.z()});
    }
  }
  return table;
}

TEST(ForceSensor, IsExactWithoutNoise) {
  Rng rng = Rng(9).split("sensor");
  const ForceSensorFit fit = fit_force_sensor(simulate_readings(rng, 1, 0.0, 0.0), std::nullopt);
  EXPECT_NEAR(fit.mass, kMass, 1e-12);
  EXPECT_LT((fit.scale - kScale).norm(), 1e-12);
  EXPECT_LT((fit.com - kCom).norm(), 1e-12);
  EXPECT_LT((fit.force_offset - kForceOffset).norm(), 1e-12);
  EXPECT_LT((fit.torque_offset - kTorqueOffset).norm(), 1e-12);
  // With a mass twice as large all scales double.
  const ForceSensorFit heavy = fit_force_sensor(simulate_readings(rng, 1, 0.0, 0.0), 2.0 * kMass);
  EXPECT_LT((heavy.scale - 2.0 * kScale).norm(), 1e-12);
}

TEST(ForceSensor, LiesWithinThePredictedUncertainty) {
  constexpr int kSeeds = 300;
  Eigen::Matrix<double, 13, 1> squares = Eigen::Matrix<double, 13, 1>::Zero();
  for (int seed = 0; seed < kSeeds; ++seed) {
    Rng rng = Rng(static_cast<std::uint64_t>(seed)).split("sensor");
    const ForceSensorFit fit = fit_force_sensor(simulate_readings(rng, 4, 0.1, 0.01), std::nullopt);
    Eigen::Matrix<double, 13, 1> ratio;
    ratio << (fit.mass - kMass) / fit.mass_deviation, (fit.scale - kScale).cwiseQuotient(fit.scale_deviation),
        (fit.com - kCom).cwiseQuotient(fit.com_deviation),
        (fit.force_offset - kForceOffset).cwiseQuotient(fit.force_offset_deviation),
        (fit.torque_offset - kTorqueOffset).cwiseQuotient(fit.torque_offset_deviation);
    squares += ratio.cwiseAbs2() / kSeeds;
  }
  // Each is chi-square of one degree of freedom; noise estimated from 66 residuals raises its mean by 66 / 64.
  for (Eigen::Index i = 0; i < squares.size(); ++i) {
    SCOPED_TRACE(i);
    expect_chi_square_mean(squares(i) * 64.0 / 66.0, 1.0, kSeeds);
  }
}

TEST(ForceSensor, RefusesOrientationsThatDetermineTooLittleAndOutliers) {
  Rng rng = Rng(10).split("bad");
  Table table = simulate_readings(rng, 2, 0.1, 0.01);
  Table flat = table;
  for (auto& row : flat.rows) row[0] = row[1] = row[2] = 0.0;
  expect_refused([&] { (void)fit_force_sensor(flat, std::nullopt); }, "x axis changes by less than half of g");
  Table few = table;
  few.rows.resize(3);
  expect_refused([&] { (void)fit_force_sensor(few, std::nullopt); }, "3 orientations");
  table.rows[4][3] += 20.0;
  expect_refused([&] { (void)fit_force_sensor(table, std::nullopt); }, "line 6");
}

TEST(ForceSensor, RefusesReadingsAgainstGravity) {
  Rng rng = Rng(11).split("sign");
  Table table = simulate_readings(rng, 2, 0.1, 0.01);
  for (auto& row : table.rows)
    for (std::size_t i = 3; i < 9; ++i) row[i] = -row[i];
  expect_refused([&] { (void)fit_force_sensor(table, std::nullopt); }, "check signs and frames");
}

// --- other units, other arms -----------------------------------------------------------------------------------------

TEST(Units, OfPosesAndJointsAreRefusedWithLineAndColumn) {
  Rng rng = Rng(2).split("units");
  const PosePairs pairs = simulate_pairs(nominal(), rng, 12, 1.0, 2.8);
  const auto changed = [&](std::size_t column, double factor) {
    Table table = pairs.table;
    table.columns = {"q1", "q2", "q3", "q4", "q5", "q6", "x", "y", "z", "rx", "ry", "rz"};
    for (std::vector<double>& row : table.rows) row[column] *= factor;
    return table;
  };
  EXPECT_NO_THROW((void)make_pose_pairs(changed(6, 1.0), nominal()));
  expect_refused([&] { (void)make_pose_pairs(changed(6, 1000.0), nominal()); }, "x: ");
  expect_refused([&] { (void)make_pose_pairs(changed(6, 1000.0), nominal()); }, "metres");
  expect_refused([&] { (void)make_pose_pairs(changed(6, 1000.0), nominal()); }, "pairs.csv:2");
  expect_refused([&] { (void)make_pose_pairs(changed(1, 180.0 / std::numbers::pi), nominal()); }, "rad");
  expect_refused([&] { (void)make_pose_pairs(changed(9, 180.0 / std::numbers::pi), nominal()); }, "rotation vector");
}

TEST(Units, OfTouchesAndTheirTipAreRefused) {
  const auto touches = [](double unit, double tip) {
    Table table{"touches.csv", tool_tip_columns(), {}, {}};
    Rng rng = Rng(3).split("touches");
    for (int k = 0; k < 8; ++k) {
      const Matrix3 R = exp_rotation(Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)));
      append(table, pose_cells({R, unit * (Vector3(0.5, 0.1, 0.0) - R * Vector3(0.0, 0.0, tip))}));
    }
    return table;
  };
  EXPECT_NEAR(find_tool_tip(touches(1.0, 0.341)).p_FQ.z(), 0.341, 1e-9);
  expect_refused([&] { (void)find_tool_tip(touches(1000.0, 0.341)); }, "metres");
  expect_refused([&] { (void)find_tool_tip(touches(9.0, 0.341)); }, "a tip at");  // no number by itself is absurd
}

TEST(Units, OfForcesMassAndTorquesAreRefused) {
  const auto readings = [](double force_unit, double torque_unit) {
    Table table{"ft.csv", force_sensor_columns(), {}, {}};
    const double half = std::numbers::pi;
    for (const Vector3& turn : {Vector3(0, 0, 0), Vector3(half, 0, 0), Vector3(half / 2, 0, 0),
                                Vector3(-half / 2, 0, 0), Vector3(0, half / 2, 0), Vector3(0, -half / 2, 0)}) {
      const Vector3 weight = exp_rotation(turn).transpose() * Vector3(0.0, 0.0, -1.2 * 9.81);
      const Vector3 torque = Vector3(0.0, 0.0, 0.1).cross(weight);
      append(table,
             {turn.x(), turn.y(), turn.z(), force_unit * weight.x(), force_unit * weight.y(), force_unit * weight.z(),
              torque_unit * torque.x(), torque_unit * torque.y(), torque_unit * torque.z()});
    }
    return table;
  };
  EXPECT_NEAR(fit_force_sensor(readings(1.0, 1.0), 1.2).com.z(), 0.1, 1e-9);
  expect_refused([&] { (void)fit_force_sensor(readings(1.0, 1000.0), 1.2); }, "torque");                 // Nmm
  expect_refused([&] { (void)fit_force_sensor(readings(1.0, 30.0), 1.2); }, "centre of mass");           // 3 m off
  expect_refused([&] { (void)fit_force_sensor(readings(1.0, 1.0), 1200.0); }, "a mass in kg");           // grams
  expect_refused([&] { (void)fit_force_sensor(readings(1000.0, 1.0), std::nullopt); }, "a force in N");  // mN
}

TEST(SameArm, IsToldFromAnother) {
  robot::ArmModel arm = nominal();
  arm.joints[2].X_SJ.p.x() += 0.003;
  EXPECT_NO_THROW(check_same_arm(arm, nominal(), "file"));
  arm.joints[2].X_SJ.p.x() = -0.425;  // a smaller arm of the same maker
  expect_refused([&] { check_same_arm(arm, nominal(), "file"); }, "elbow_joint");
  arm.joints[2].X_SJ.p.x() = -612.0;
  expect_refused([&] { check_same_arm(arm, nominal(), "file"); }, "metres");
  arm = nominal();
  arm.joints[4].X_SJ.R = exp_rotation(Vector3(0.5, 0.0, 0.0)) * arm.joints[4].X_SJ.R;
  expect_refused([&] { check_same_arm(arm, nominal(), "file"); }, "wrist_2_joint");
}

}  // namespace
}  // namespace snug::calibration
