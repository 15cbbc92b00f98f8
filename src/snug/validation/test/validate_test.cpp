// A whole validation: what was put into a virtual experiment comes out of it.
#include "snug/validation/validate.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/validation/measure.hpp"
#include "snug/validation/page.hpp"

namespace snug::validation {
namespace {

using test::ScratchFolder;

model::Sensors demonstrator() {
  return model::load_sensors(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/sensors/demonstrator.yaml");
}

std::vector<Measurement> experiment(const SimulatedRun& simulated, const SimulatedRun& real,
                                    const model::Sensors& sensors, std::uint64_t seed = 5) {
  std::vector<Measurement> repetitions;
  for (int k = 1; k <= 3; ++k) {
    MeasureOptions options;
    options.seed = seed;
    options.repetition = k;
    repetitions.push_back(align(simulated, measure(real, sensors, options).recording, {}, "b.h5"));
  }
  return repetitions;
}

TEST(Validate, WindowsAreWhereBoxesAreHandled) {
  const std::vector<Window> windows = find_windows(test::example_run());
  ASSERT_EQ(windows.size(), 3U);
  EXPECT_EQ(windows[0].body, "BOX013");
  EXPECT_NEAR(windows[0].start, 2.0, 1e-9);
  EXPECT_NEAR(windows[0].end, 18.0, 1e-9);  // both times it was held
  EXPECT_NEAR(windows[2].start, 32.0, 1e-9);
}

TEST(Validate, TrueParametersGiveErrorsOfTheSensorsOnly) {
  const SimulatedRun run = test::example_run();
  model::Sensors sensors = demonstrator();
  sensors.motion_capture.lost_probability = 0.0;
  const Validation result = validate(run, experiment(run, run, sensors));
  // The frame of a body was set to 0.3 mm in each coordinate: 0.5 mm; 3 boxes.
  EXPECT_LT(result.clean.rest_position, 1.0e-3);
  EXPECT_LT(result.clean.rest_rotation, 0.6 * 3.1416 / 180.0);
  EXPECT_LT(result.clean.rms_position, 1.5e-3);
  EXPECT_LT(result.clean.rms_force, 1.5);
  EXPECT_EQ(result.bodies[0].simulated_state, "packed");
  EXPECT_EQ(result.bodies[0].measured_states, (std::vector<std::string>{"packed", "packed", "packed"}));
}

TEST(Validate, ClocksOfAllSourcesAreFoundWithErrorsThatCover) {
  const SimulatedRun run = test::example_run();
  int covered = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    MeasureOptions options;
    options.seed = seed;
    const VirtualMeasurement measured = measure(run, demonstrator(), options);
    const Measurement aligned = align(run, measured.recording, {}, "b.h5");
    ASSERT_EQ(aligned.clocks.size(), 3U);
    const ClockTruth truths[] = {measured.truth.motion_capture, measured.truth.force_torque, measured.truth.encoders};
    for (std::size_t k = 0; k < 3; ++k) {
      SCOPED_TRACE(aligned.clocks[k].source);
      ASSERT_TRUE(aligned.clocks[k].fit) << aligned.clocks[k].failure;
      const ClockFit& fit = *aligned.clocks[k].fit;
      const double error = fit.shift - (truths[k].offset + truths[k].rate * fit.middle);
      EXPECT_LT(std::abs(error), 2e-3);
      ++found;
      covered += std::abs(error) < 3.0 * fit.shift_error + 1e-4 ? 1 : 0;
    }
  }
  EXPECT_GE(covered, found - 2);
}

TEST(Validate, APlantedErrorComesOut) {
  const SimulatedRun real = test::example_run();
  SimulatedRun simulated = real;
  for (record::PoseSample& pose : simulated.bodies[1]) pose.p.x() += 7e-3;
  for (Wrench& wrench : simulated.wrench) wrench.force *= 1.5;
  model::Sensors sensors = demonstrator();
  sensors.motion_capture.lost_probability = 0.0;
  const Validation result = validate(simulated, experiment(simulated, real, sensors));
  const double rest = spread_of(result.bodies[1].errors.clean, &Errors::rest_position).mean;
  EXPECT_NEAR(rest, 7e-3, 1.2e-3);
  EXPECT_LT(spread_of(result.bodies[0].errors.clean, &Errors::rest_position).mean, 1.5e-3);
  EXPECT_GT(result.clean.rms_force, 2.0);
}

TEST(Validate, ShiftsByHandAreTaken) {
  const SimulatedRun run = test::example_run();
  const VirtualMeasurement measured = measure(run, demonstrator(), {});
  HandShifts shifts;
  shifts.motion_capture = measured.truth.motion_capture.offset + 0.1;
  const Measurement aligned = align(run, measured.recording, shifts, "b.h5");
  EXPECT_TRUE(aligned.clocks[0].fit->is_by_hand);
  EXPECT_NEAR(aligned.pose_times.front(), -0.1, 1e-3);
  EXPECT_FALSE(aligned.clocks[1].fit->is_by_hand);
}

TEST(Validate, MeasurementsOfOtherThingsAreRefused) {
  const SimulatedRun run = test::example_run();
  SimulatedRun other = run;
  for (auto& body : other.header.bodies) body.name = "X" + body.name;
  const ScratchFolder folder;
  record::save_archive(folder / "b.h5", {{measure(other, {}, {}).recording}});
  EXPECT_THROW((void)load_repetitions(folder / "b.h5", run, {}), InputError);
  record::ArchiveRecording empty = measure(run, {}, {}).recording;
  empty.motion_capture = {};
  record::save_archive(folder / "c.h5", {{empty}});
  EXPECT_THROW((void)load_repetitions(folder / "c.h5", run, {}), InputError);
  EXPECT_THROW((void)load_repetitions(folder / "d.h5", run, {}), InputError);
}

TEST(Validate, PageAndTablesHoldWhatWasMeasured) {
  const SimulatedRun run = test::example_run();
  model::Sensors sensors = demonstrator();
  sensors.motion_capture.lost_probability = 1.0;
  sensors.motion_capture.lost_depth = 0.0;
  const Validation result = validate(run, experiment(run, run, sensors));
  EXPECT_EQ(result.bodies[1].measured_states[0], "lost");
  const auto json = nlohmann::json::parse(as_json(result));
  EXPECT_EQ(json["bodies"].size(), 3U);
  EXPECT_TRUE(json["bodies"][1]["clean"]["rest_position_mm"]["mean"].is_null());
  EXPECT_NEAR(json["means"]["reported_of_the_real_cell"]["rest_position_mm"].get<double>(), 8.5, 1e-9);
  EXPECT_EQ(json["repetitions"][0]["clocks"].size(), 3U);
  const std::string csv = as_csv(result);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3 * 3 * 2);
  const std::string page = make_page(run, result);
  EXPECT_NE(page.find("n.a."), std::string::npos);
  EXPECT_NE(page.find("data:image/svg+xml"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  ASSERT_EQ(result.moments.size(), 2U);  // one flip and the last box packed: no sequence of the report
  EXPECT_EQ(result.moments[0].what, "flipping");
  EXPECT_EQ(make_figures(run, result, false).size(), 6U);
}

TEST(Validate, IsTheSameEveryTime) {
  const SimulatedRun run = test::example_run();
  EXPECT_EQ(as_json(validate(run, experiment(run, run, demonstrator()))),
            as_json(validate(run, experiment(run, run, demonstrator()))));
}

TEST(Windows, AreReadForTheSequenceOfTheRun) {
  const ScratchFolder folder;
  std::ofstream(folder / "w.csv") << "# spans\nsequence,body,start_s,end_s\nsmall,Box013,1,2\nother,Box099,3,4\n";
  const std::vector<Window> windows = load_windows(folder / "w.csv", test::example_run());
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0], (Window{"BOX013", 1.0, 2.0}));
}

TEST(Windows, SlipsAreRefusedWithLineAndNearestBody) {
  const struct {
    const char* text;
    const char* part;
  } slips[] = {{"body,start_s\nBox013,1\n", "end_s"},
               {"body,start_s,end_s,colour\n", "colour"},
               {"body,start_s,end_s\nBox012,1,2\n", "w.csv:2"},
               {"body,start_s,end_s\nBox012,1,2\n", "did you mean Box013?"},
               {"body,start_s,end_s\nBox013,2,1\n", "an end after the start"},
               {"body,start_s,end_s\nBox013,a,1\n", "'a'"},
               {"body,start_s,end_s\nBox013,1\n", "2 cells"},
               {"body,start_s,end_s\n", "no window"}};
  for (const auto& slip : slips) {
    SCOPED_TRACE(slip.text);
    const ScratchFolder folder;
    std::ofstream(folder / "w.csv") << slip.text;
    try {
      (void)load_windows(folder / "w.csv", test::example_run());
      ADD_FAILURE() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(slip.part), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace snug::validation
