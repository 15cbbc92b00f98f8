// fit_faces: planes measure by how much a belief is off, and say how surely.
#include <gtest/gtest.h>

#include <cmath>

#include "snug/box_estimation/internal/features.hpp"
#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

const Box kFaceBox{"a", Vector3(0.20, 0.15, 0.10), level(-0.05, -0.10, 0.05, 0.3)};

std::vector<FaceFeature> faces_of(const FitScene& scene, const TrackedBox& tracked, const FitStep& step = {}) {
  return fit_faces(scene.context(), scene.predict({tracked}), {tracked}, step);
}

/// The face that looks up most, which is seen whole.
FaceFeature top_of(const std::vector<FaceFeature>& faces) {
  return *std::ranges::max_element(faces, {}, &FaceFeature::points);
}

TEST(FitFaces, NothingIsOffWhereTheBeliefIsTrue) {
  const FitScene scene({kFaceBox});
  const std::vector<FaceFeature> faces = faces_of(scene, scene.tracked(kFaceBox));
  ASSERT_FALSE(faces.empty());
  for (const FaceFeature& face : faces) {
    EXPECT_NEAR(face.rows.measured(0), 0.0, 1e-6) << "single precision of a metre";
    EXPECT_NEAR(face.rows.measured.tail<2>().norm(), 0.0, 1e-4);
    EXPECT_EQ(face.box, 0);
  }
}

TEST(FitFaces, ABeliefTooHighIsMeasuredDown) {
  const FitScene scene({kFaceBox});
  const FaceFeature top = top_of(faces_of(scene, scene.tracked(kFaceBox, Vector3(0, 0, -0.003))));
  EXPECT_NEAR(top.rows.measured(0), -0.003, 1e-5) << "outward is up, toward the camera";
  EXPECT_EQ(top.face, 5) << "+z of the box";
}

/// measured = J twist, to first order, for any small twist between belief and truth.
TEST(FitFaces, MeasuresWhatItsJacobianSaysOfAnySmallTwist) {
  const FitScene scene({kFaceBox});
  Rng rng = Rng(3).split("faces");
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    const TrackedBox tracked = scene.tracked(kFaceBox, normals(rng, 0.001), normals(rng, 0.004));
    const Vector6 twist = difference(tracked.X_CP, scene.tracked(kFaceBox).X_CP);
    for (const FaceFeature& face : faces_of(scene, tracked)) {
      if (face.points < 2000) continue;  // strips of sides: their middle is not where the face's is
      const Vector3 expected = face.rows.J * twist;
      EXPECT_NEAR(face.rows.measured(0), expected(0), 2e-5 + 0.02 * twist.norm() * 0.1);
      EXPECT_NEAR(face.rows.measured(1), expected(1), 3e-4);
      EXPECT_NEAR(face.rows.measured(2), expected(2), 3e-4);
    }
  }
}

TEST(FitFaces, LeavesTheBorderOut) {
  FitScene scene({kFaceBox});
  const int with_two = top_of(faces_of(scene, scene.tracked(kFaceBox))).points;
  scene.settings.faces.border = 8;
  const int with_eight = top_of(faces_of(scene, scene.tracked(kFaceBox))).points;
  scene.settings.faces.border = 0;
  const int all = top_of(faces_of(scene, scene.tracked(kFaceBox))).points;
  EXPECT_LT(with_eight, with_two);
  EXPECT_LT(with_two, all);
  // A border of b pixels takes about b times the perimeter in pixels away, at 1 / fx m each.
  const double perimeter = 2.0 * (0.20 + 0.15) * scene.frame.camera.intrinsics.fx / 0.9;
  EXPECT_NEAR(all - with_two, 2.0 * perimeter, 0.35 * 2.0 * perimeter) << "turned by 0.3: (cos + sin) as long";
}

TEST(FitFaces, TakesOnlyFacesWithEnoughPointsAndOfTheBoxesAskedFor) {
  FitScene scene({kFaceBox});
  FitStep step;
  step.first_box = 1;
  EXPECT_TRUE(faces_of(scene, scene.tracked(kFaceBox), step).empty()) << "held";
  scene.settings.faces.least_points = 1'000'000;
  EXPECT_TRUE(faces_of(scene, scene.tracked(kFaceBox)).empty());
}

TEST(FitFaces, AStripTiltedMoreThanABoxCanBeIsNoFace) {
  FitScene scene({kFaceBox});
  FitStep wide;
  wide.gate = 0.03;
  const TrackedBox tilted = scene.tracked(kFaceBox, Vector3::Zero(), Vector3(0.10, 0, 0));
  EXPECT_FALSE(faces_of(scene, tilted, wide).empty());
  scene.settings.faces.most_tilt = 0.05;
  for (const FaceFeature& face : faces_of(scene, tilted, wide)) {
    EXPECT_LE(face.rows.measured.tail<2>().cwiseAbs().maxCoeff(), 0.05);
  }
}

/// Something that lies on half of the face, 15 mm high: within the wide gate, and not what most points agree on.
TEST(FitFaces, TheOffsetThatMostPointsAgreeOnIsFound) {
  Box lid{"lid", Vector3(0.20, 0.06, 0.015), kFaceBox.X_WP * Pose{Matrix3::Identity(), Vector3(0, 0.045, 0.0575)}};
  const FitScene scene({kFaceBox, lid});
  const TrackedBox too_high = scene.tracked(kFaceBox, Vector3(0, 0, -0.006));
  FitStep step;
  step.wide_gate = 0.025;
  step.gate = 0.003;
  EXPECT_NEAR(top_of(faces_of(scene, too_high, step)).rows.measured(0), -0.006, 2e-4);
}

TEST(FitFaces, CovarianceIsPositiveAndGrowsWithTheNoise) {
  double before = 0.0;
  for (const char* preset : {"ideal", "structured_light", "active_stereo"}) {
    const FitScene scene({kFaceBox}, preset);
    const FaceFeature top = top_of(faces_of(scene, scene.tracked(kFaceBox)));
    const Matrix3& covariance = top.rows.covariance;
    EXPECT_LT((covariance - covariance.transpose()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_GT(Eigen::LLT<Matrix3>(covariance).matrixL().toDenseMatrix().diagonal().minCoeff(), 0.0);
    EXPECT_GT(covariance(0, 0), before) << preset;
    before = covariance(0, 0);
  }
}

/// Over frames of cameras with errors: squares of what is measured beside what is stated. Waves of a camera and its own
/// place stay out: C is where the camera is.
TEST(FitFaces, OffsetsAreOffByAsMuchAsTheirVarianceSays) {
  double sum = 0.0;
  constexpr int kFrames = 60;
  const Cell cell("structured_light");
  for (std::uint64_t seed = 1; seed <= kFrames; ++seed) {
    FitScene scene({kFaceBox}, "structured_light", seed);
    const camera::CameraDraw draw = camera::draw_camera(cell.camera, seed);
    Box as_seen = kFaceBox;
    as_seen.X_WP = cell.camera.X_WC * draw.X_CD.inverse() * cell.camera.X_WC.inverse() * kFaceBox.X_WP;
    const TrackedBox tracked = scene.tracked(as_seen);
    const FaceFeature top = top_of(faces_of(scene, tracked));
    // The scale of lengths acts about the focus; what it does to a depth is known.
    const double scaled = -draw.scale * (tracked.X_CP.p.z() - tracked.half.z() - cell.camera.range.focus);
    sum += std::pow(top.rows.measured(0) - scaled, 2) / (top.rows.covariance(0, 0) * kFrames);
  }
  EXPECT_GT(sum, 0.4) << "of 60 squares, the part of the bias that stays left out";
  EXPECT_LT(sum, 1.8);
}

}  // namespace
}  // namespace snug::box_estimation::internal
