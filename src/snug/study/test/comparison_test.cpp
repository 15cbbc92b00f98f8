// Comparison: rows come back as they were written, sums are those of the textbook, the page holds every session.
#include "snug/study/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/report/test/sound.hpp"

namespace snug::study {
namespace {

SessionRow some_row(const std::string& agent, const std::string& sequence, std::uint64_t plant, double percent) {
  SessionRow row;
  row.point = {agent, sequence, plant, false, {}};
  row.executed_percent = percent;
  row.planned_percent = percent + 1.0;
  row.percent_before_skips = percent;
  row.executed_boxes = 7;
  row.items_sent = 8;
  row.items_as_planned = 6;
  row.boxes_lost = 1;
  row.recoveries = 2;
  row.boxes_per_hour = 350.0;
  row.decision_seconds_median = 0.125;
  row.stop_reason = session::StopReason::NoPlace;
  row.calibration.bins[9] = {4, 3, 3.8};
  row.packed = {{"BOX001", {exp_rotation(Vector3(0.1, 0.2, 0.3)), Vector3(0.1, -0.05, 0.04)}}};
  return row;
}

/// What a process prints, as the runner gives it back, also by way of a table.
SessionRow round_trip(const SessionRow& row, const SessionPoint& point) {
  Study study;
  study.outputs = session_outputs();
  RowResult result;
  static_cast<ResultValues&>(result) = values_of(study, format_row(row));
  const std::optional<RowResult> stored = parse_line(format_line(result).substr(0, format_line(result).size() - 1));
  EXPECT_TRUE(stored && *stored == result);
  return read_row(*stored, point, row.seed);
}

TEST(SessionRow, ComesBackFromItsProcessAndItsTableAsItWas) {
  const SessionRow row = some_row("margin", "1", 3, 71.0625);
  const SessionRow back = round_trip(row, row.point);
  EXPECT_EQ(back.executed_percent, row.executed_percent) << "to the last digit";
  EXPECT_EQ(back.stop_reason, row.stop_reason);
  EXPECT_EQ(back.decision_seconds_median, row.decision_seconds_median) << "a column of the clock";
  EXPECT_EQ(back.point.plant_seed, 3u);
  EXPECT_EQ(back.calibration.bins[9].motions, 4);
  EXPECT_NEAR(back.calibration.bins[9].predicted, 3.8, 1e-12);
  ASSERT_EQ(back.packed.size(), 1u);
  EXPECT_EQ(back.packed[0].X_TP.p, row.packed[0].X_TP.p);
  EXPECT_LT(angle_between(back.packed[0].X_TP.R, row.packed[0].X_TP.R), 1e-9);
}

TEST(SessionRow, EveryReasonToStopComesBack) {
  for (int i = 0; i <= static_cast<int>(session::StopReason::Interrupted); ++i) {
    SessionRow row = some_row("margin", "1", 1, 50.0);
    row.stop_reason = static_cast<session::StopReason>(i);
    const SessionRow back = round_trip(row, row.point);
    EXPECT_EQ(back.stop_reason, row.stop_reason) << row.stop_name();
    EXPECT_EQ(back.is_interrupted(), row.stop_reason == session::StopReason::Interrupted);
  }
}

TEST(SessionRow, OneThatBrokeOffHasItsLastWordsAsFailure) {
  RowResult result;
  result.exit_code = -1;
  result.error = "signal 11: it fell";
  const SessionRow row = read_row(result, {"margin", "1", 1, false, {}}, 5);
  EXPECT_EQ(row.failure, "signal 11: it fell");
  EXPECT_FALSE(row.stop_reason.has_value());
  EXPECT_EQ(row.stop_name(), "");
  EXPECT_FALSE(row.is_interrupted());
}

TEST(SessionRow, BrokenTablesGiveNoNonsense) {
  RowResult result;
  result.values = {{"calibration", std::string("[{")},
                   {"boxes", std::string("7")},
                   {"executed_percent", std::string("x")},
                   {"stop_reason", std::string("a reason of another version")}};
  const SessionRow row = read_row(result, {}, 1);
  EXPECT_TRUE(row.packed.empty());
  EXPECT_EQ(row.executed_percent, 0.0);
  EXPECT_FALSE(row.stop_reason.has_value());
}

TEST(Summarize, IsMeanRangeAndSampleDeviation) {
  Rng rng = Rng(1).split("summary");
  std::vector<SessionRow> rows;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < 20; ++i) {
    rows.push_back(some_row(i % 2 == 0 ? "a" : "b", i < 10 ? "1" : "2", 1, rng.uniform(60.0, 80.0)));
    if (i % 2 == 0) sum += rows.back().executed_percent;
  }
  for (const SessionRow& row : rows)
    if (row.point.agent == "a") squares += std::pow(row.executed_percent - sum / 10.0, 2);
  const AgentSummary all = summarize(rows, "a");
  EXPECT_EQ(all.count, 10);
  EXPECT_NEAR(all.executed, sum / 10.0, 1e-12);
  EXPECT_NEAR(all.deviation, std::sqrt(squares / 9.0), 1e-9);
  EXPECT_LE(all.lowest, all.executed);
  EXPECT_GE(all.highest, all.executed);
  EXPECT_EQ(all.sent, 80);
  EXPECT_EQ(all.calibration.bins[9].motions, 40);
  EXPECT_EQ(summarize(rows, "a", "2").count, 5);
  EXPECT_EQ(summarize(rows, "nobody").count, 0);
}

TEST(MakeListStudy, ItsTextIsReadAsTheSameStudy) {
  const ListDesign design{"compare",
                          "pack",
                          "a cell.yaml",
                          {{"--seed", "5"}, {"--set", "cup.lip_radius=0.03"}, {"--set", "a=\"b\": 'c' #d"}},
                          {"--agent", "--plant-seed"},
                          {{"margin", "1"}, {"mine:Class", "2"}, {"{}[]:,\n\u00e4", "3"}},
                          session_outputs()};
  const Study made = make_list_study(design), read = parse_study(made.text, "compare");
  EXPECT_EQ(read.options, made.options);
  EXPECT_EQ(read.factors, made.factors);
  EXPECT_EQ(read.points, made.points);
  EXPECT_EQ(read.outputs, made.outputs);
  EXPECT_EQ(read.chunk, made.chunk);
  EXPECT_EQ(read.seed_option, made.seed_option);
  EXPECT_EQ(read.design, made.design);
  for (std::uint64_t row = 0; row < made.rows(); ++row) {
    EXPECT_EQ(command_of(read, row_of(read, row)), command_of(made, row_of(made, row)));
  }
}

TEST(RunRows, GivesTypedRowsInOrderAtAnyNumberOfProcesses) {
  ListDesign design{"rows", "pack", "cell.yaml", {}, {"--agent"}, {}, session_outputs()};
  for (int i = 0; i < 12; ++i) design.points.push_back({"agent-" + std::to_string(i)});
  const Study study = make_list_study(design);
  const RowWork work = [](std::uint64_t row) {
    if (row == 5) throw std::runtime_error("it broke");
    std::fputs(format_row(some_row("x", "1", 1, 50.0 + static_cast<double>(row))).c_str(), stdout);
    return 0;
  };
  for (const int processes : {1, 4}) {
    std::vector<double> percents;
    RunSettings settings;
    settings.processes = processes;
    settings.tell = [&](const RowResult& result, const std::string&) {
      EXPECT_EQ(result.row, percents.size());
      percents.push_back(read_row(result, {}, 1).executed_percent);
      if (result.row == 5) {
        EXPECT_EQ(result.error, "it broke");
      }
    };
    const RunSummary summary = run_rows(study, nullptr, work, settings);
    EXPECT_EQ(summary.failed, 1u);
    ASSERT_EQ(percents.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(percents[i], i == 5 ? 0.0 : 50.0 + static_cast<double>(i));
  }
}

model::Scenario some_scenario() {
  model::Scenario scenario;
  scenario.name = "cell";
  scenario.target = "tote";
  model::Container container;
  container.name = "tote";
  container.inner_size = Vector3(0.4, 0.6, 0.25);
  scenario.containers.push_back(container);
  model::Parcel parcel;
  parcel.id = "BOX001";
  parcel.size = Vector3(0.2, 0.1, 0.08);
  scenario.parcels.push_back(parcel);
  return scenario;
}

TEST(FormatComparePage, HasEverySessionWithItsContainerAndWords) {
  std::vector<ComparedSession> sessions;
  for (const char* agent : {"margin", "</script><b>"}) {
    for (std::uint64_t plant = 1; plant <= 2; ++plant) {
      sessions.push_back({some_row(agent, "1", plant, 70.0), "snug pack 'a cell.yaml' --set 'x=\"<i>\"'", {}});
    }
  }
  sessions[0].report = "/runs/the first.html";
  sessions[3].row.stop_reason = session::StopReason::Interrupted;
  const std::string page = format_compare_page(some_scenario(), sessions, "/pages/compare.html");
  report::expect_well_formed(page);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("<b>\""), std::string::npos);
  EXPECT_EQ(report::count(page, "<polygon"), 4);
  EXPECT_NE(page.find("<a href=\"../runs/the%20first.html\">open this run</a>"), std::string::npos);
  EXPECT_NE(page.find("3 sessions compared"), std::string::npos);
  EXPECT_NE(page.find("1 more were interrupted"), std::string::npos);
  EXPECT_EQ(report::count(page, "see this run"), 3);
}

TEST(FormatCompare, JsonInPiecesIsOneDocument) {
  std::string text = format_compare_head(CompareForm::Json);
  std::vector<SessionRow> rows = {some_row("a", "1", 1, 70.0), some_row("a", "2", 1, 72.0)};
  for (std::size_t i = 0; i < rows.size(); ++i) text += format_compare_row(CompareForm::Json, rows[i], i == 0);
  text += format_compare_end(CompareForm::Json, some_scenario(), rows, false);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["rows"].size(), 2u);
  EXPECT_EQ(json["rows"][0]["stop_reason"], "no place");
  EXPECT_NEAR(json["means"][0]["executed_percent"].get<double>(), 71.0, 1e-12);
  EXPECT_EQ(json["interrupted"], 0);
}

}  // namespace
}  // namespace snug::study
