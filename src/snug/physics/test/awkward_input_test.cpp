// Awkward input: what is not a number is traced to the body that brought it in, and numbers of things have no limit.
#include <gtest/gtest.h>

#include <limits>

#include "scene.hpp"

namespace snug::physics::test {
namespace {

TEST(NotFinite, NamesTheBodyInAStackThatBroughtItInAndNotAVictim) {
  const WorldModel model = tall_stack();
  for (int culprit = 1; culprit <= 3; ++culprit) {
    for (int part = 0; part < 4; ++part) {
      SCOPED_TRACE(testing::Message() << "body " << culprit << ", part " << part);
      Simulation run(model);
      run.steps(5);
      if (part == 0) run.body(culprit).velocity.y() = kNaN;
      if (part == 1) run.body(culprit).angular_velocity.y() = kNaN;
      if (part == 2) run.body(culprit).p_WBcm.y() = kNaN;
      if (part == 3) run.body(culprit).quat_WB.x() = kNaN;
      const StepReport report = step_until_wrong(run);
      EXPECT_EQ(report.status, StepStatus::NotFinite);
      EXPECT_EQ(report.culprit, BodyId{culprit});
    }
  }
}

TEST(NotFinite, LeavesTheStateAndTheContactsOfTheLastStepReadable) {
  const WorldModel model = tall_stack();
  Simulation run(model);
  run.steps(5);
  const std::size_t contacts = run.work.contacts().size();
  ASSERT_GT(contacts, 0u);
  ExternalWrench wrench{BodyId{2}, {}};
  wrench.wrench_W.force.x() = kNaN;
  WorldInput input;
  input.wrenches = {&wrench, 1};
  const std::uint64_t before = hash_of(run.state);
  EXPECT_EQ(run.step(input).status, StepStatus::NotFinite);
  EXPECT_EQ(hash_of(run.state), before);
  EXPECT_EQ(run.work.contacts().size(), contacts);
}

TEST(NotFinite, NamesAKinematicBodySentNowhere) {
  WorldModel model = tall_stack();
  BodyModel pusher = fixed_box({0.1, 0.1, 0.05}, {-0.1501, 0.0, 0.05});  // beside body 1
  pusher.kind = BodyKind::Kinematic;
  model.bodies.push_back(pusher);
  model.finalize();
  Simulation run(model);
  run.steps(5);
  const KinematicTarget target{BodyId{5}, {Matrix3::Identity(), Vector3(kNaN, 0.0, 0.05)}};
  WorldInput input;
  input.kinematic = {&target, 1};
  const StepReport report = step_until_wrong(run, input);
  EXPECT_EQ(report.status, StepStatus::NotFinite);
  EXPECT_EQ(report.culprit, BodyId{5});
}

struct NoForce final : ForceElement {
  [[nodiscard]] ElementResponse evaluate(const ElementQuery&) const noexcept override { return {}; }
};

WorldModel row_of_boxes(int count) {
  WorldModel model = world({}, {});
  BodyModel carrier = fixed_box({0.01, 0.01, 0.01}, {0.0, 0.0, 3.0});
  carrier.kind = BodyKind::Kinematic;
  model.bodies = {carrier};
  for (int i = 0; i < count; ++i) model.bodies.push_back(box({0.1, 0.1, 0.1}, 1.0, {0.1 * i, 0.0, 0.0}));
  model.finalize();
  return model;
}

TEST(ForceElements, OnNineBodiesThatTouchDoNotEndTheProgram) {
  const NoForce element;
  const WorldModel model = row_of_boxes(9);
  Simulation run(model);
  std::vector<ElementUse> uses;
  for (int i = 1; i <= 9; ++i) uses.push_back({&element, BodyId{0}, {}, BodyId{i}});
  WorldInput input;
  input.elements = uses;
  EXPECT_EQ(run.step(input).status, StepStatus::Converged);
}

TEST(ForceElements, MoreThanSixtyFourOfThemStayInsideTheScratchMemory) {
  const NoForce element;
  const WorldModel model = row_of_boxes(1);
  Simulation run(model);
  const std::vector<ElementUse> uses(100, {&element, BodyId{0}, {}, BodyId{1}});
  WorldInput input;
  input.elements = uses;
  EXPECT_EQ(run.step(input).status, StepStatus::Converged);
}

TEST(NotFinite, NamesTheBodyWhoseForceElementAnswersWithoutANumber) {
  struct Broken final : ForceElement {
    [[nodiscard]] ElementResponse evaluate(const ElementQuery&) const noexcept override {
      ElementResponse response;
      response.wrench[1] = kNaN;
      return response;
    }
  };
  const Broken element;
  const WorldModel model = row_of_boxes(3);
  Simulation run(model);
  const ElementUse use{&element, BodyId{0}, {}, BodyId{2}};
  WorldInput input;
  input.elements = {&use, 1};
  const StepReport report = run.step(input);
  EXPECT_EQ(report.status, StepStatus::NotFinite);
  EXPECT_EQ(report.culprit, BodyId{2});
}

}  // namespace
}  // namespace snug::physics::test
