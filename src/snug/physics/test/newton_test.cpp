// Jammed boxes: the solver's answer held to the laws by other code, where sweeps alone would take far too long.
#include <gtest/gtest.h>

#include "jam_scene.hpp"
#include "second_opinion.hpp"
#include "snug/core/rng.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::test {
namespace {

constexpr int kSweepsBeforeNewton = 6;  // docs/theory/contact.md, 4

/// Whether the last step has contacts that were found at its end: their arms are of there, which reports do not say.
bool has_swept_contacts(Workspace& work) {
  const auto& contacts = work.scratch().contacts;
  return std::any_of(contacts.begin(), contacts.end(), [](const internal::Contact& c) { return c.point < 0; });
}

class Jam : public testing::TestWithParam<double> {};

TEST_P(Jam, IsSolvedToTheLawsWhereTwoHundredSweepsFail) {
  const WorldModel model = jammed_boxes(2e-4);
  const Press press(GetParam());
  Simulation run(model);
  int hard = 0, failed = 0, swept = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const WorldState before = run.state;
    const StepReport report = run.step(press.input());
    ASSERT_EQ(report.status, StepStatus::Converged);
    if (has_swept_contacts(run.work)) {
      ++swept;
      continue;
    }
    const StepProblem problem(model, before, run.work.contacts(), press.input());
    const auto impulses = problem.reported_impulses();
    const auto motion = problem.motion_from(impulses);
    // The tolerance of the solver; the problem is rebuilt from other formulas, whose rounding at 1e-9 m/s is far below.
    ASSERT_LE(problem.violation(impulses, motion), 1.01 * model.settings.tolerance);
    for (std::size_t b = 5; b < 12; ++b) {  // the forces reported are those that moved the bodies
      if (problem.is_located(b)) continue;
      ASSERT_LE((motion[b].v - run.state.bodies[b].velocity).norm(), 1e-9);
      ASSERT_LE((motion[b].w - run.state.bodies[b].angular_velocity).norm(), 1e-8);
    }
    if (report.sweeps <= kSweepsBeforeNewton) continue;
    if (++hard % 4 == 1 && problem.violation_after_sweeps(200) > model.settings.tolerance) ++failed;
  }
  EXPECT_LE(swept, 15);
  EXPECT_GE(hard, 20);
  EXPECT_GE(failed, 3) << "the scene is no test for Newton's method any more";
}

TEST_P(Jam, KeepsEveryForceInsideItsCone) {
  const WorldModel model = jammed_boxes(2e-4);
  const Press press(GetParam());
  Simulation run(model);
  for (int i = 0; i < 300; ++i) {
    (void)run.step(press.input());
    for (const ContactReport& contact : run.work.contacts()) {
      const double normal = contact.n_AB_W.dot(contact.force_W);
      const double friction = (contact.force_W - normal * contact.n_AB_W).norm();
      const double mu = contact.a.index < 5 ? 0.24 : 0.2;  // of the container
      ASSERT_GE(normal, -1e-9);                            // rounding of forces near 1e3 N
      ASSERT_LE(friction, mu * normal + 1e-9);
      if (!contact.slides) continue;
      ASSERT_NEAR(friction, mu * normal, 1e-6 * mu * normal + 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PressedWith, Jam, testing::Values(0.0, 20.0, 100.0, 245.0));

TEST(Drop, IsSolvedToTheLawsInEveryStep) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng = Rng(seed).split("drop");
    std::vector<BodyModel> boxes;
    for (int i = 0; i < 6; ++i) {
      boxes.push_back(box({0.15, 0.12, 0.1}, 0.4, {rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), 0.1 + 0.13 * i}));
      boxes.back().X_WB.R = exp_rotation(Vector3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), 0.0));
    }
    WorldModel model = in_container(boxes);
    for (ContactLaw& law : model.laws) law.restitution = 0.0;
    Simulation run(model);
    for (int i = 0; i < 500; ++i) {
      const WorldState before = run.state;
      ASSERT_EQ(run.step().status, StepStatus::Converged);
      const StepProblem problem(model, before, run.work.contacts());
      const auto impulses = problem.reported_impulses();
      ASSERT_LE(problem.violation(impulses, problem.motion_from(impulses)), 1.01 * model.settings.tolerance) << i;
    }
  }
}

TEST(SecondOpinion, SeesAWrongForce) {
  const WorldModel model = jammed_boxes(2e-4);
  Simulation run(model);
  run.steps(30);
  const WorldState before = run.state;
  (void)run.step();
  const StepProblem problem(model, before, run.work.contacts());
  for (const double factor : {0.99, 1.01, -1.0}) {
    auto impulses = problem.reported_impulses();
    auto largest = std::max_element(impulses.begin(), impulses.end(),
                                    [](const Vector3& a, const Vector3& b) { return a.norm() < b.norm(); });
    *largest *= factor;
    EXPECT_GT(problem.violation(impulses, problem.motion_from(impulses)), 1e-6);
  }
}

}  // namespace
}  // namespace snug::physics::test
