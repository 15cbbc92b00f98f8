// Tables and page of a validation: the same numbers in every form, and names that attack.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scene.hpp"
#include "snug/core/units.hpp"
#include "snug/report/test/sound.hpp"
#include "snug/validation/page.hpp"
#include "snug/validation/reported.hpp"

namespace snug::validation {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Errors errors_of(double position) { return {position, 0.01, 2.0 * position, 0.02, 3.0, 0.5, 1.0, 0.25}; }

/// Two boxes, two repetitions, of which one did not see the second box.
Validation made_up() {
  Validation validation;
  validation.simulated = "run.h5";
  validation.sequence = "1";
  for (const char* name : {"first", "second"}) {
    Measurement measurement;
    measurement.name = name;
    measurement.clocks.push_back({"motion capture", ClockFit{0.35, 0.001, 2e-5, 1e-6, 5.0, 0.98, 4, false}, ""});
    measurement.clocks.push_back({"robot", std::nullopt, "nothing moves"});
    validation.repetitions.push_back(measurement);
  }
  BodyReport a{"BOX016", {"BOX016", 1.0, 2.0}, "packed", {"packed", "lost"}, {}};
  a.errors.clean = {errors_of(0.001), errors_of(0.003)};
  a.errors.report = {errors_of(0.002), errors_of(0.002)};
  BodyReport b{"BOX018", {"BOX018", 2.0, 4.5}, "outside", {"packed", "not measured"}, {}};
  b.errors.clean = {errors_of(0.004), Errors{kNone, kNone, kNone, kNone, kNone, kNone, 0.0, 0.0}};
  b.errors.report = b.errors.clean;
  validation.bodies = {a, b};
  validation.clean = {0.003, 0.01, 0.006, 0.02, 3.0, 0.5, 2};
  validation.report = {0.003, kNone, 0.006, 0.02, 3.0, 0.5, 2};
  return validation;
}

TEST(SpreadOf, IsMeanAndSampleDeviationOfWhatWasMeasured) {
  const Spread two = spread_of({errors_of(0.001), errors_of(0.003)}, &Errors::rest_position);
  EXPECT_NEAR(two.mean, 0.002, 1e-15);
  EXPECT_NEAR(two.deviation, 0.001 * std::sqrt(2.0), 1e-15);
  EXPECT_EQ(two.count, 2);
  const Spread one = spread_of({errors_of(0.001), errors_of(kNone)}, &Errors::rest_position);
  EXPECT_EQ(one.count, 1);
  EXPECT_TRUE(std::isnan(one.deviation));
  EXPECT_TRUE(std::isnan(spread_of({}, &Errors::rest_position).mean));
  Rng rng = Rng(1).split("spread");
  std::vector<Errors> many;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < 50; ++i) {
    many.push_back(errors_of(rng.uniform()));
    sum += many.back().rest_position;
  }
  for (const Errors& error : many) squares += std::pow(error.rest_position - sum / 50.0, 2);
  EXPECT_NEAR(spread_of(many, &Errors::rest_position).deviation, std::sqrt(squares / 49.0), 1e-12);
}

TEST(AsJson, HoldsEveryNumberAndNullForWhatWasNotMeasured) {
  const auto json = nlohmann::json::parse(as_json(made_up()));
  EXPECT_TRUE(json["protective_stop"].is_null());
  const auto& rest = json["bodies"][0]["clean"]["rest_position_mm"];
  EXPECT_NEAR(rest["mean"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(rest["standard_deviation"].get<double>(), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(rest["repetitions"][1].get<double>(), 3.0, 1e-12);
  EXPECT_TRUE(json["bodies"][1]["clean"]["rms_force_N"]["repetitions"][1].is_null());
  EXPECT_NEAR(json["bodies"][0]["clean"]["rms_rotation_deg"]["mean"].get<double>(), 0.02 * kDegrees, 1e-9);
  EXPECT_EQ(json["bodies"][0]["report"]["dropped_percent"][0], 25.0);
  EXPECT_EQ(json["repetitions"][0]["clocks"][1]["failure"], "nothing moves");
  EXPECT_NEAR(json["repetitions"][0]["clocks"][0]["rate_ppm"].get<double>(), 20.0, 1e-9);
  EXPECT_TRUE(json["means"]["report"]["rest_rotation_deg"].is_null());
  EXPECT_EQ(json["means"]["clean"]["bodies"], 2);
}

TEST(AsJson, AClockSetByHandHasNoError) {
  Validation validation = made_up();
  validation.repetitions[0].clocks[0].fit->is_by_hand = true;
  const auto clock = nlohmann::json::parse(as_json(validation))["repetitions"][0]["clocks"][0];
  EXPECT_TRUE(clock["by_hand"].get<bool>());
  EXPECT_TRUE(clock["standard_error_s"].is_null());
  EXPECT_EQ(clock["shift_s"], 0.35);
}

TEST(AsCsv, HasARowForEachBoxFormAndRepetitionAndAsManyCellsAsItsHead) {
  std::istringstream text(as_csv(made_up()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 1u + 2u * 2u * 2u);
  const auto cells = [](const std::string& line) { return std::ranges::count(line, ','); };
  for (const std::string& line : lines) EXPECT_EQ(cells(line), cells(lines[0])) << line;
  EXPECT_TRUE(lines[1].starts_with("BOX016,first,clean,1.000,2.000,packed,packed,1,"));
  EXPECT_NE(lines[6].find(",,,,,,"), std::string::npos) << "empty cells for what was not measured: " << lines[6];
}

TEST(AsCsv, ANameWithACommaIsOneCell) {
  Validation validation = made_up();
  validation.repetitions[0].name = "first, again \"really\"";
  const std::string text = as_csv(validation);
  EXPECT_NE(text.find(",first_ again _really_,"), std::string::npos) << "as csv_cell() says";
}

TEST(AsText, SaysTheSameNumbers) {
  const std::string text = as_text(made_up());
  EXPECT_NE(text.find("Box016"), std::string::npos);
  EXPECT_NE(text.find("2.00 / 0.57"), std::string::npos) << "rest: 2 mm, 0.01 rad\n" << text;
  EXPECT_NE(text.find("not on the simulation's clock: nothing moves"), std::string::npos);
  EXPECT_NE(text.find("3.00 / n.a."), std::string::npos) << "a mean of nothing";
}

TEST(MakePage, HasEveryTableOfTheReportWithItsNumbers) {
  const std::string page = make_page(test::example_run(), made_up());
  report::expect_well_formed(page);
  for (const char* part : {"Clocks", "1. Execution", "2. Rest poses (Table 4)", "3. Poses over the motion (Table 5)",
                           "4. Wrenches (Table 6)", "2.00 <small>± 1.41</small>", "not found: nothing moves", "n.a."}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(report::count(page, "<table>"), 5);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_NE(page.find("published: 8.50 mm"), std::string::npos) << "what is asked first stands first";
}

TEST(MakePage, NamesAreNamesWhateverIsInThem) {
  Validation validation = made_up();
  const std::string attack = "</title></td><script>alert('1')</script>\u202e";
  validation.simulated = validation.sequence = validation.protective_stop = attack;
  validation.repetitions[0].name = attack;
  validation.repetitions[0].clocks[1].failure = attack;
  validation.bodies[0].simulated_state = validation.bodies[0].measured_states[0] = attack;
  const std::string page = make_page(test::example_run(), validation);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("\u202e"), std::string::npos);
  report::expect_well_formed(page);
}

TEST(Reported, AreTheReportsOwnMeansAndMoments) {
  const Means& means = reported_means();
  EXPECT_NEAR(kMm * means.rest_position, 8.50, 1e-9);
  EXPECT_NEAR(kDegrees * means.rms_rotation, 3.12, 1e-9);
  EXPECT_EQ(means.bodies, 54);
  EXPECT_EQ(key_moments().size(), 10u);
}

}  // namespace
}  // namespace snug::validation
