// Shake: closed forms of sliding and tipping, symmetry, profiles, files that are broken.
#include "snug/runs/shake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/runs/shake_report.hpp"

namespace snug::runs {
namespace {

/// A pallet 1 m square with friction mu, and one box of this size in its middle. `law`: what else contacts have.
model::Scenario pallet(double friction, const Vector3& size, const std::string& law = "") {
  const std::string text =
      "name: pallet\ntime_step: 0.001\nmaterials: [{name: box}, {name: slab}]\n"
      "contacts:\n  pairs:\n"
      "    - {between: [box, slab], friction: " +
      std::to_string(friction) + ", restitution: 0" + law +
      "}\n"
      "    - {between: [box, box], friction: " +
      std::to_string(friction) + ", restitution: 0" + law +
      "}\n"
      "parcel_types: [{name: b, size: [" +
      std::to_string(size.x()) + ", " + std::to_string(size.y()) + ", " + std::to_string(size.z()) +
      "], mass: 2.0}]\n"
      "parcels: [{id: A, type: b, material: box}, {id: B, type: b, material: box}]\n"
      "containers: [{name: slab, inner_size: [1.0, 1.0, 0.5], material: slab, walls: false}]\ntarget: "
      "slab\n";
  return model::parse_scenario(text, "pallet.yaml");
}

std::vector<model::PlacementEntry> in_the_middle(const Vector3& size) {
  return {{"A", {Matrix3::Identity(), Vector3(0.0, 0.0, 0.5 * size.z())}, 0}};
}

/// Straight up to `acceleration`, held for a second.
std::vector<ShakeMotion> pulse(const Vector3& acceleration) {
  return {{"pulse", {{0.0, Vector3::Zero()}, {0.001, acceleration}, {0.4, acceleration}}}};
}

ShakeOptions exact() {
  ShakeOptions options;
  options.draws = 0;
  options.time_step = 0.001;
  return options;
}

TEST(Shake, ABoxStaysBelowTheFrictionsAccelerationAndSlidesBeyondItAsNewtonSays) {
  const Vector3 size(0.4, 0.4, 0.1);
  const model::Scenario scenario = pallet(0.3, size);
  for (const Vector3& axis : {Vector3(Vector3::UnitX()), Vector3(-Vector3::UnitY())}) {
    const ShakeResult below = shake(scenario, in_the_middle(size), pulse(0.29 * 9.81 * axis), exact());
    EXPECT_TRUE(below.holds());
    EXPECT_LT(below.runs.back().boxes[0].shift, 1e-4);
    const ShakeResult beyond = shake(scenario, in_the_middle(size), pulse(0.4 * 9.81 * axis), exact());
    EXPECT_FALSE(beyond.holds());
    // a - mu g for 0.4 s: 78 mm; the ramp and a step of 1 ms are worth 0.5 mm.
    EXPECT_NEAR(beyond.runs.back().boxes[0].shift, 0.5 * 0.1 * 9.81 * 0.4 * 0.4, 1.5e-3);
    EXPECT_LT(beyond.runs.back().boxes[0].tilt, 0.01);
  }
}

TEST(Shake, ASlenderBoxTipsWhereItsLeverIsTooShort) {
  const Vector3 size(0.1, 0.1, 0.4);  // tips at g / 4
  const model::Scenario scenario = pallet(0.8, size);
  const ShakeResult stands = shake(scenario, in_the_middle(size), pulse({0.22 * 9.81, 0.0, 0.0}), exact());
  EXPECT_TRUE(stands.holds());
  const ShakeResult falls = shake(scenario, in_the_middle(size), pulse({0.35 * 9.81, 0.0, 0.0}), exact());
  EXPECT_FALSE(falls.holds());
  EXPECT_GT(falls.runs[falls.worst].boxes[0].tilt, 0.105);
  EXPECT_EQ(falls.runs[falls.worst].motion, "pulse");
}

TEST(Shake, ATiltSlidesABoxWhereItsTangentIsBeyondTheFriction) {
  const Vector3 size(0.4, 0.4, 0.1);
  const model::Scenario scenario = pallet(0.3, size);
  ShakeProfileOptions options;
  for (const double level : {0.27, 0.4}) {
    options.level = level;
    const ShakeResult result = shake(scenario, in_the_middle(size), make_shake_profile("tilt", options), exact());
    EXPECT_EQ(result.holds(), level < 0.3) << level;
  }
}

TEST(Shake, FilmAndStrapsHoldMore) {
  const Vector3 size(0.4, 0.4, 0.1);
  const model::Scenario scenario = pallet(0.3, size);
  const auto profile = pulse({0.5 * 9.81, 0.0, 0.0});
  ShakeOptions options = exact();
  EXPECT_FALSE(shake(scenario, in_the_middle(size), profile, options).holds());
  for (const LoadHold hold : {LoadHold::Film, LoadHold::Straps}) {
    options.hold = hold;
    EXPECT_TRUE(shake(scenario, in_the_middle(size), profile, options).holds()) << name_of(hold);
  }
}

TEST(Shake, FilmWithoutFrictionSwaysAsFarAsASpringDoes) {
  const Vector3 size(0.4, 0.4, 0.1);
  ShakeOptions options = exact();
  options.hold = LoadHold::Film;
  options.time_step = 0.002;
  const ShakeMotion motion{"push", {{0.0, Vector3::Zero()}, {0.002, {0.5, 0.0, 0.0}}, {4.0, {0.5, 0.0, 0.0}}}};
  const ShakeRun run = shake(pallet(0.0, size), in_the_middle(size), {motion}, options).runs.back();
  // One band, in shear against the pallet over half of its height: two sides of 0.4 m, 2.2 kN/m. A pull that lags would
  // make far more than 2 m a / k of it in 4 s.
  const double stiffness = 2.0 * 0.4 * 2.2e3 / 0.05;
  EXPECT_NEAR(run.boxes[0].shift, 2.0 * 2.0 * 0.5 / stiffness, 1e-6);
}

TEST(Shake, FilmDrawsALoadTogetherBeforeItIsDriven) {
  const Vector3 size(0.4, 0.4, 0.1);
  const std::vector<model::PlacementEntry> load{{"A", {Matrix3::Identity(), Vector3(-0.215, 0.0, 0.05)}, 0},
                                                {"B", {Matrix3::Identity(), Vector3(0.215, 0.0, 0.05)}, 0}};
  ShakeOptions options = exact();
  options.hold = LoadHold::Film;
  const ShakeResult result = shake(pallet(0.3, size), load, pulse({1.0, 0.0, 0.0}), options);
  ASSERT_EQ(result.runs.size(), 3U);
  EXPECT_EQ(result.runs[1].motion, "wound");
  // 2 x 35 N against 5.9 N of friction: the gap of 30 mm closes. That shift does not count.
  EXPECT_NEAR(result.runs[1].boxes[0].remaining + result.runs[1].boxes[1].remaining, 0.030, 5e-4);
  EXPECT_LT(result.runs[1].worst, 0.1);
  EXPECT_TRUE(result.holds());
  EXPECT_LT(result.runs[2].boxes[0].shift, 1e-3) << "from where the film has drawn it";
}

TEST(Shake, WindsAsFewLayersOfFilmAsHold) {
  const Vector3 size(0.4, 0.4, 0.1);
  ShakeOptions options = exact();
  options.hold = LoadHold::Film;
  options.time_step = 0.002;
  options.shift = 0.0007;
  const std::vector<ShakeMotion> push{{"push", {{0.0, Vector3::Zero()}, {0.002, {5.0, 0, 0}}, {1.0, {5.0, 0, 0}}}}};
  // Without friction it sways to 2 m a / k; a layer has two sides of 0.4 m, 0.55 kN/m, over half a band: 8.8 kN/m.
  // 2.27 mm with one layer, 0.57 mm with four, 0.76 mm with three.
  const ShakeResult result = shake_with_least_film(pallet(0.0, size), in_the_middle(size), push, options, 6);
  EXPECT_TRUE(result.holds());
  EXPECT_EQ(result.film_layers, 4);
  const ShakeResult nearest = shake_with_least_film(pallet(0.0, size), in_the_middle(size), push, options, 2);
  EXPECT_FALSE(nearest.holds());
  EXPECT_EQ(nearest.film_layers, 2) << "where none holds, the one that came nearest";
}

TEST(Shake, JudgesByTheHeightOfALoadAsEumos40509Does) {
  const Vector3 size(0.4, 0.4, 0.5);
  const model::Scenario scenario = pallet(0.3, size);
  // mu g for the time at which it slides by 18 mm and 32 mm: 5 % of 0.5 m are 25 mm, 10 % are 50 mm.
  for (const double way : {0.018, 0.032}) {
    const double time = std::sqrt(2.0 * way / (0.1 * 9.81));
    const std::vector<ShakeMotion> motion{
        {"slides", {{0.0, Vector3::Zero()}, {0.001, {0.4 * 9.81, 0.0, 0.0}}, {time, {0.4 * 9.81, 0.0, 0.0}}}}};
    ShakeOptions options = exact();
    options.limits = ShakeLimits::Eumos40509;
    const ShakeResult result = shake(scenario, in_the_middle(size), motion, options);
    EXPECT_NEAR(result.shift, 0.05, 1e-12);
    EXPECT_NEAR(result.remaining, 0.025, 1e-12);
    EXPECT_NEAR(result.runs.back().worst, way / 0.025, 0.05);
    EXPECT_EQ(result.holds(), way < 0.025);
  }
}

TEST(Shake, SaysOfALoadThatDoesNotStandThatItFellAtRest) {
  const Vector3 size(0.4, 0.4, 0.1);
  auto load = in_the_middle(size);
  load.push_back({"B", {Matrix3::Identity(), Vector3(0.25, 0.0, 0.15)}, 0});  // hangs over by 65 %
  const ShakeResult result = shake(pallet(0.3, size), load, pulse(Vector3::Zero()), exact());
  EXPECT_FALSE(result.holds());
  EXPECT_EQ(result.runs[0].motion, "at rest");
  EXPECT_GT(result.runs[0].worst, 1.0);
}

TEST(Shake, TakesNoStepsWhileTheLoadRestsAndSeesWhereItBeginsToSlide) {
  const Vector3 size(0.4, 0.4, 0.1);
  const model::Scenario scenario = pallet(0.3, size);
  const Vector3 half(0.15 * 9.81, 0.0, 0.0);
  const ShakeMotion motion{
      "slow", {{0.0, Vector3::Zero()}, {10.0, half}, {30.0, half}, {31.0, 1.8 * half}, {60.0, 1.8 * half}}};
  const ShakeRun rests = shake(scenario, in_the_middle(size), {motion}, exact()).runs.back();
  EXPECT_LT(rests.boxes[0].shift, 1e-4);
  EXPECT_LT(rests.steps, 200);  // of 60 000
  // From rest up to 0.4 g in a second: beyond 0.3 g from 0.75 s on, 0.4 g (0.25 s)^3 / 6 = 10.2 mm; a step is worth
  // 0.1.
  const ShakeMotion ramp{"ramp", {{0.0, Vector3::Zero()}, {1.0, {0.4 * 9.81, 0.0, 0.0}}}};
  const ShakeRun slides = shake(scenario, in_the_middle(size), {ramp}, exact()).runs.back();
  EXPECT_NEAR(slides.boxes[0].shift, 0.4 * 9.81 * 0.25 * 0.25 * 0.25 / 6.0, 2e-4);
  EXPECT_GT(slides.steps, 900);
}

/// Sliding by these parts of the limit with the least friction, after half a second at rest.
std::vector<ShakeRun> runs_that_slide(double part, bool all_frictions) {
  const Vector3 size(0.4, 0.4, 0.1);
  const double mu = 0.3, seconds = 0.4;
  ShakeOptions options = exact();
  options.draws = 3;
  options.all_frictions = all_frictions;
  const auto shake_with = [&](double acceleration) {
    const ShakeMotion motion{
        "m", {{0.0, Vector3::Zero()}, {0.001, {acceleration, 0.0, 0.0}}, {seconds, {acceleration, 0.0, 0.0}}}};
    return shake(pallet(mu, size), in_the_middle(size), {motion}, options).runs;
  };
  const double least = shake_with(0.1).front().friction;
  return shake_with(least * mu * 9.81 + 2.0 * part * options.shift / (seconds * seconds));
}

TEST(Shake, RunsMoreFrictionsWhereTheLeastDoesNotDecide) {
  EXPECT_EQ(runs_that_slide(0.3, false).size(), 2U) << "at rest, and the motion once: it moves little";
  const std::vector<ShakeRun> moves = runs_that_slide(0.6, false);
  ASSERT_EQ(moves.size(), 4U) << "with the least and with the most friction, each with its rest";
  EXPECT_NEAR(moves[2].worst, 0.6, 0.05);
  EXPECT_LT(moves[3].worst, 0.1);
  EXPECT_EQ(runs_that_slide(0.95, false).size(), 8U) << "near the limit: all four";
  EXPECT_EQ(runs_that_slide(1.5, false).size(), 2U) << "it does not hold, whatever others do";
}

TEST(Shake, RunsEveryFrictionWhereAllAreAskedFor) {
  for (const double part : {0.3, 8.0}) {
    const std::vector<ShakeRun> all = runs_that_slide(part, true);
    ASSERT_EQ(all.size(), 8U) << "four frictions, each with its rest";
    for (std::size_t i = 5; i < all.size(); ++i) {
      EXPECT_GT(all[i].friction, all[i - 1].friction);
      EXPECT_LT(all[i].worst, all[i - 1].worst) << "less slides with more friction";
    }
    EXPECT_EQ(all[4].boxes, runs_that_slide(part, false)[1].boxes);
  }
}

TEST(Shake, TakesLargerStepsWhereAllFacesGiveWay) {
  const Vector3 size(0.4, 0.4, 0.1);
  const double mu = 0.3, acceleration = 0.33 * 9.81, seconds = 0.4;
  const std::string soft = ", stiffness: 1.5e4, damping: 50.0";
  ShakeOptions options = exact();
  options.time_step.reset();
  const auto profile = pulse({acceleration, 0.0, 0.0});
  const ShakeRun rigid = shake(pallet(mu, size), in_the_middle(size), profile, options).runs.back();
  const ShakeRun gives = shake(pallet(mu, size, soft), in_the_middle(size), profile, options).runs.back();
  EXPECT_NEAR(static_cast<double>(rigid.steps), 200.0, 2.0);
  EXPECT_NEAR(static_cast<double>(gives.steps), 100.0, 2.0);
  EXPECT_NEAR(gives.boxes[0].shift, 0.5 * (acceleration - mu * 9.81) * seconds * seconds, 1e-3);
  options.hold = LoadHold::Film;
  const auto wound = shake(pallet(mu, size, soft), in_the_middle(size), profile, options).runs;
  EXPECT_EQ(wound[1].steps, 1250) << "film is wound in steps of 2 ms";
}

TEST(Shake, GivesTheSameBytesAtAnyNumberOfThreads) {
  const Vector3 size(0.3, 0.2, 0.1);
  ShakeOptions options;
  options.draws = 3;
  const auto run = [&](int threads) {
    options.threads = threads;
    return shake(pallet(0.3, size), in_the_middle(size), pulse({3.2, 0.0, 0.0}), options).runs;
  };
  EXPECT_EQ(run(1), run(3));
}

TEST(Shake, RefusesLoadsAndOptionsThatCannotBe) {
  const Vector3 size(0.3, 0.2, 0.1);
  const model::Scenario scenario = pallet(0.3, size);
  EXPECT_THROW((void)shake(scenario, {}, {}, exact()), InputError);
  ShakeOptions options = exact();
  options.shift = 0.0;
  EXPECT_THROW((void)shake(scenario, in_the_middle(size), {}, options), InputError);
  options = exact();
  options.time_step = std::nan("");
  EXPECT_THROW((void)shake(scenario, in_the_middle(size), {}, options), InputError);
}

TEST(ShakeProfile, GoesStraightBetweenItsSamples) {
  const auto motions = parse_shake_profile("# a comment\ntime_s,ay,roll_deg\n0,0,0\n2, 4,90\n", "a.csv");
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].at(0.5).acceleration_T, Vector3(0.0, 1.0, 0.0));
  EXPECT_DOUBLE_EQ(motions[0].at(1.0).roll, 0.25 * std::numbers::pi);
  EXPECT_EQ(motions[0].at(7.0).acceleration_T, Vector3(0.0, 4.0, 0.0));
  EXPECT_EQ(motions[0].at(-1.0).acceleration_T, Vector3(Vector3::Zero()));
}

TEST(ShakeProfile, SaysWhereAFileIsWrong) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      (void)parse_shake_profile(text, "p.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* text : {"", "time_s,ax\n", "time_s,ax\n0,1\n", "ax\n1\n2\n", "time_s,ax\n0,0\n0,1\n",
                           "time_s,ax\n0,0\n1,nan\n", "time_s,ax\n0,0\n1,1,1\n", "time_s,ax,ax\n0,0,0\n1,1,1\n",
                           "time_s,ax\n0,0\n1,1e9\n", "time_s,bx\n0,0\n1,1\n", "time_s,ax\n1,0\n2,0\n"}) {
    EXPECT_NE(message(text).find("p.csv"), std::string::npos) << text;
  }
  EXPECT_NE(message("time_s,ax\n0,0\n1,x\n").find("p.csv:3"), std::string::npos);
}

TEST(ShakeProfile, KnowsItsNamesAndTheLongerSideLooksForward) {
  ShakeProfileOptions options;
  for (const std::string& name : shake_profile_names()) EXPECT_EQ(make_shake_profile(name, options).size(), 4U) << name;
  EXPECT_THROW((void)make_shake_profile("trukc", options), InputError);
  options.size = Vector3(0.37, 0.57, 0.25);
  EXPECT_NEAR(make_shake_profile("truck", options)[0].at(0.5).acceleration_T.y(), -0.8 * 9.81, 1e-12);
}

TEST(ShakeReport, NamesTheWorstBoxOfAMotionAndWhatEachLimitWas) {
  ShakeResult result;
  result.boxes = {"A", "B"};
  result.sizes = {Vector3::Constant(0.1), Vector3::Constant(0.1)};
  result.inner_size = Vector3(0.6, 0.4, 0.3);
  result.shift = 0.020;
  result.remaining = std::numeric_limits<double>::infinity();
  const std::vector<Pose> poses(2);
  result.runs = {
      {"stop", 1.0, {{"A", 0.001, 0.0, 0.0, false}, {"B", 0.030, 0.02, 0.01, false, 1.5}}, 1.5, 0.2, poses, true},
      {"stop", 0.8, {{"A", 0.050, 0.05, 0.0, false, 2.5}, {"B", 0.0, 0.0, 0.0, true}}, 9.0, 0.4, poses, true}};
  result.worst = 1;
  const ShakeWords words{"load.yaml", "conveyor", "none", 6.0};
  EXPECT_EQ(shake_verdict(result, words),
            "does not hold: 2 of 2 boxes beyond 20 mm or 6 degrees in 'stop', friction x 0.80; worst B (falls)");
  const std::string text = format_shake_text(result, words);
  EXPECT_EQ(text.find("     1.00"), std::string::npos) << "of each motion the worst friction alone";
  EXPECT_NE(format_shake_json(result, words).find("\"max_shift_mm\": 20.0"), std::string::npos);
  EXPECT_NE(format_shake_page(result, words).find("friction x 0.80"), std::string::npos);
  result.runs.clear();
  EXPECT_EQ(shake_verdict(result, words), "holds: 2 boxes within 20 mm and 6 degrees");
  result.shift = 0.1795;
  result.remaining = 0.060;
  EXPECT_EQ(shake_verdict(result, words), "holds: 2 boxes within 179.5 mm (60 mm in the end) and 6 degrees");
}

}  // namespace
}  // namespace snug::runs
