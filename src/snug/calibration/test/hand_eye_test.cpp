// Hand-eye: a planted camera comes back within the uncertainty that is said; poses that cannot tell are refused.
#include "snug/calibration/hand_eye.hpp"

#include <gtest/gtest.h>

#include "snug/calibration/test/nominal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::calibration {
namespace {

using test::normal3;

/// Rows of a board that the tool holds before a camera 1 m over it, measured with noise.
Table make_table(Rng& rng, const Pose& X_WC, const Pose& X_EB, int rows, double position_noise, double angle_noise,
                 bool one_axis) {
  Table table;
  table.name = "board.csv";
  table.columns = hand_eye_columns();
  for (int i = 0; i < rows; ++i) {
    const Vector3 turn = one_axis ? Vector3(0, 0, rng.uniform(-0.5, 0.5)) : normal3(rng, 0.4);
    const Pose X_WE{exp_rotation(turn), Vector3(0.5, -0.35, 0.0) + normal3(rng, 0.1)};
    const Pose X_CB = X_WC.inverse() * X_WE * X_EB;
    const Pose seen{exp_rotation(normal3(rng, angle_noise)) * X_CB.R, X_CB.p + normal3(rng, position_noise)};
    std::vector<double> cells;
    for (const Pose& X : {X_WE, seen}) {
      const Vector3 r = log_rotation(X.R);
      for (const Vector3& v : {X.p, r}) cells.insert(cells.end(), {v.x(), v.y(), v.z()});
    }
    table.rows.push_back(cells);
    table.lines.push_back(i + 2);
  }
  return table;
}

const Pose kCamera{exp_rotation(Vector3(3.0, 0.2, 0.1)), Vector3(0.5, -0.3, 0.8)};
const Pose kBoard{exp_rotation(Vector3(0.1, -0.2, 0.7)), Vector3(0.02, -0.01, 0.09)};

TEST(HandEye, ExactPosesGiveTheExactCamera) {
  Rng rng = Rng(1).split("hand eye");
  const HandEye found = find_hand_eye(make_table(rng, kCamera, kBoard, 8, 0.0, 0.0, false));
  EXPECT_LT((found.X_WC.p - kCamera.p).norm(), 1e-9);
  EXPECT_LT(angle_between(found.X_WC.R, kCamera.R), 1e-9);
  EXPECT_LT((found.X_EB.p - kBoard.p).norm(), 1e-9);
}

TEST(HandEye, ErrorsAreAsLargeAsIsSaid) {
  double sum = 0.0;
  constexpr int kRuns = 200;
  for (int i = 0; i < kRuns; ++i) {
    Rng rng = Rng(static_cast<std::uint64_t>(i)).split("hand eye noise");
    const HandEye found = find_hand_eye(make_table(rng, kCamera, kBoard, 20, 3e-4, 1e-3, false));
    Vector6 off;
    off << found.X_WC.p - kCamera.p, log_rotation(found.X_WC.R * kCamera.R.transpose());
    sum += off.dot(found.covariance.ldlt().solve(off)) / kRuns;
    EXPECT_NEAR(found.position_noise, 3e-4, 1.5e-4);
  }
  // Chi-square with six degrees of freedom, its scale itself estimated from 54: 4 standard errors of the mean, and 4 %.
  EXPECT_NEAR(sum, 6.0, 4.0 * std::sqrt(12.0 / kRuns) + 0.25);
}

TEST(HandEye, RefusesWhatCannotTell) {
  Rng rng = Rng(2).split("hand eye refused");
  const auto expect_refused = [](const Table& table, const std::string& part) {
    try {
      (void)find_hand_eye(table);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  expect_refused(make_table(rng, kCamera, kBoard, 3, 0.0, 0.0, false), "4");
  expect_refused(make_table(rng, kCamera, kBoard, 10, 0.0, 0.0, true), "two axes");
  Table slip = make_table(rng, kCamera, kBoard, 20, 1e-4, 1e-4, false);
  slip.rows[7][6] += 0.1;
  expect_refused(slip, "9");
  Table millimetres = make_table(rng, kCamera, kBoard, 10, 0.0, 0.0, false);
  millimetres.rows[3][0] = 505.0;
  expect_refused(millimetres, "board.csv:5");
}

}  // namespace
}  // namespace snug::calibration
