// Studies that the program makes itself: comparisons, repeated runs, scenes of a bench; what is said of them.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/study/comparison_design.hpp"
#include "snug/study/factor_runs.hpp"
#include "snug/study/ray.hpp"
#include "snug/study/repeated_runs.hpp"
#include "snug/study/study_text.hpp"
#include "snug/study/trial_report.hpp"

namespace snug::study {
namespace {

model::Scenario three_boxes() {
  model::Scenario scenario =
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml");
  scenario.sequences.resize(2);
  return scenario;
}

TEST(ComparisonDesign, HasEveryAgentSequenceAndPlantAndPlantsOfTheirOwnForRandomSequences) {
  model::Scenario scenario = three_boxes();
  const std::string one = scenario.sequences[0].name, two = scenario.sequences[1].name;
  ComparisonChoice choice;
  choice.agents = "margin,contact-aware";
  choice.sequences = two;
  choice.random = 2;
  choice.plants = 3;
  choice.plant_seed = 10;
  choice.recordings = "runs";
  const ComparisonDesign design = design_comparison(choice, scenario);
  EXPECT_EQ(design.sequences, (std::vector<std::string>{two, "random-1", "random-2"}));
  EXPECT_EQ(scenario.sequences.size(), 4U) << "the random ones are the scenario's now";
  ASSERT_EQ(design.points.size(), 18U);
  const SessionPoint& last = design.points.back();
  EXPECT_EQ(last.agent, "contact-aware");
  EXPECT_EQ(last.plant_seed, 15U) << "10 to 12 of the first two, 13 to 15 of the second random one";
  EXPECT_TRUE(last.is_random);
  EXPECT_EQ(last.recording, "runs/018-contact-aware-random-2-plant-15.h5");
  const Study study = make_comparison_study(choice, "cell.yaml", {{"--seed", "7"}}, design.points);
  EXPECT_EQ(study.rows(), 18U);
  const Study again = parse_study(study.text, "study.yaml");
  EXPECT_EQ(words_of(again, row_of(again, 17)), words_of(study, row_of(study, 17))) << "its text says the same";
}

TEST(ComparisonDesign, RefusesNamesThatThereAreNotAndMoreThanPeopleRead) {
  const auto design = [](auto change) {
    model::Scenario scenario = three_boxes();
    ComparisonChoice choice;
    change(choice);
    return design_comparison(choice, scenario);
  };
  EXPECT_EQ(design([](ComparisonChoice&) {}).sequences.size(), 2U) << "all";
  EXPECT_EQ(design([](ComparisonChoice& c) { c.agents = "my.module:Agent"; }).agents.size(), 1U);
  EXPECT_EQ(design([](ComparisonChoice& c) { c.random = 1; }).sequences, std::vector<std::string>{"random-1"});
  EXPECT_THROW((void)design([](ComparisonChoice& c) { c.agents = "nobody"; }), InputError);
  EXPECT_THROW((void)design([](ComparisonChoice& c) { c.agents = ""; }), InputError);
  EXPECT_THROW((void)design([](ComparisonChoice& c) { c.sequences = "none"; }), InputError);
  EXPECT_THROW((void)design([](ComparisonChoice& c) { c.plants = 10001; }), InputError);
}

TEST(RunFactor, TellsEachValueInItsOrderAndNamesProcessesThatWereKilled) {
  FactorRuns runs{"bench", "fake", "", {"--w", "left"}, "--x", {"3", "1", "2"}, {{"y"}}, 2};
  const Verb verb = [](const std::vector<std::string>& words) {
    const auto at = std::find(words.begin(), words.end(), "--x");
    std::printf("{\"y\": %s}\n", at[1].c_str());
    return 0;
  };
  std::vector<double> told;
  run_factor(runs, verb, "bench", [&](const RowResult& result, const std::string&) {
    told.push_back(std::get<double>(result.values.front().second));
  });
  EXPECT_EQ(told, (std::vector<double>{3.0, 1.0, 2.0}));
  const Verb killed = [](const std::vector<std::string>&) {
    ::raise(SIGKILL);
    return 0;
  };
  try {
    run_factor(runs, killed, "bench", [](const RowResult&, const std::string&) {});
    FAIL() << "no row has a result";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "processes of the bench were killed");
  }
}

TEST(RepeatRuns, AreDrawsOfSimulateFromOne) {
  const Verb verb = [](const std::vector<std::string>& words) {
    const auto at = std::find(words.begin(), words.end(), "--draw");
    std::printf("{\"state_hash\": \"%s-%s\", \"boxes\": []}\n", words[1].c_str(), at[1].c_str());
    return 0;
  };
  const std::vector<RepeatedRun> runs = repeat_runs("cell.yaml", {"--seed", "7"}, 3, 2, verb);
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[2].state_hash, "cell.yaml-3");
}

TEST(Chunks, AreOneOrARangeOfThoseThatThereAre) {
  const Study study = test::grid(4, 1, 2);  // 8 rows in 4 tables
  using Range = std::pair<std::uint64_t, std::uint64_t>;
  EXPECT_EQ(parse_chunks("3", study), Range(3, 3));
  EXPECT_EQ(parse_chunks("0-3", study), Range(0, 3));
  for (const char* words : {"4", "2-4", "3-2", "", "-1", "1-", "1-2-3", "a", "1 "})
    EXPECT_THROW((void)parse_chunks(words, study), InputError) << words;
}

TEST(StudyText, SaysWhatWasDoneAndWhatIsLeft) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 2);
  const Folder folder(study, scratch / "f", true);
  RunSummary summary;
  summary.done = 2;
  summary.failed = 1;
  summary.row_seconds = 4.0;
  EXPECT_EQ(format_run_text(folder, summary, 3.0), "rows done now      2, 1 failed\nfolder             " +
                                                       folder.path().string() +
                                                       "\nwall clock         3.0 s, 4.0 s in rows\n");
  const auto json = nlohmann::json::parse(format_run_json(study, folder, summary, 3.0, 8));
  EXPECT_EQ(json.at("overhead_percent"), 50.0) << "two rows keep two processes busy, however many there may be";
  Status status;
  status.rows = 4;
  status.done = 1;
  status.mean_seconds = 2.5;
  EXPECT_NE(format_status_text(status).find("2.50 s on average, 8 s left on one core"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(format_status_json(study, status)).at("seconds_left_on_one_core"), 7.5);
}

TEST(WriteTable, GoesByTheEndingOfItsName) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(1, 1, 1);
  const Folder folder(study, scratch / "f", true);
  (void)run_study(study, folder, test::fake, {});
  write_table(study, folder, "a.csv", OutputFile(scratch / "a.csv"));
  EXPECT_EQ(test::read_text(scratch / "a.csv").substr(0, 4), "row,");
  write_table(study, folder, "a.hdf5", OutputFile(scratch / "a.hdf5"));
  EXPECT_EQ(test::read_text(scratch / "a.hdf5").substr(1, 3), "HDF");
  EXPECT_THROW(write_table(study, folder, "a.txt", OutputFile(scratch / "a.txt")), InputError);
}

TEST(WriteTasks, AreAScriptOfSlurmOrAProgramOfRay) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 2);
  const Folder folder(study, scratch / "f", true);
  const ArrayPlan plan = plan_array(study, folder);
  EXPECT_EQ(write_tasks(study, folder, plan, "/bin/snug", "study.yaml", {}), folder.path() / "array.sh");
  EXPECT_EQ(test::read_text(folder.path() / "array.sh").substr(0, 2), "#!");
  EXPECT_EQ(write_tasks(study, folder, plan, "/bin/snug", "study.yaml", "local"), folder.path() / "ray-tasks.py");
}

TEST(FindFailure, IsTheFirstThingThatWentWrong) {
  session::SessionResult result;
  EXPECT_EQ(find_failure(result, {}, false), "");
  EXPECT_EQ(find_failure(result, {}, true), "nothing was packed: no program, no recording");
  MonteCarloResult repeated;
  repeated.count = 5;
  repeated.failed = 2;
  EXPECT_EQ(find_failure(result, repeated, true), "2 of 5 repeated runs did not finish");
  result.failure.text = "it stopped";
  EXPECT_EQ(find_failure(result, repeated, true), "it stopped");
}

TEST(RecordingOf, SaysWhichPlantItIsOf) {
  const test::ScratchFolder scratch;
  OutputFile file(scratch / "run.h5");
  simulated_plant::SimulatedPlantOptions plant;
  plant.seed = 7;
  const auto own = nlohmann::json::parse(recording_of(plant, "margin", "1.2", file).settings_json);
  EXPECT_EQ(own.at("plant_seed"), 7);
  EXPECT_EQ(own.at("robot"), "none");
  const auto served = recording_of(plant, "margin", "1.2", file, "click://there");
  EXPECT_EQ(served.version, "1.2");
  EXPECT_EQ(nlohmann::json::parse(served.settings_json).at("plant"), "click://there");
  EXPECT_FALSE(nlohmann::json::parse(served.settings_json).contains("plant_seed"));
}

}  // namespace
}  // namespace snug::study
