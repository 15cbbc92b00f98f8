// Running: every row once, whatever is killed, and the same bytes at any number of processes.
#include "snug/study/run.hpp"

#include <sys/wait.h>

#include <csignal>
#include <cstdlib>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/study/merge.hpp"
#include "snug/study/slurm.hpp"

namespace snug::study {
namespace {

std::string merged(const Study& study, const Folder& folder, const std::filesystem::path& path) {
  write_csv(study, folder, OutputFile(path));
  return test::read_text(path);
}

std::size_t count_lines(const std::string& text) { return static_cast<std::size_t>(std::ranges::count(text, '\n')); }

TEST(RunStudy, DoesEveryRowOnceAndMergesTheSameBytesAtAnyNumberOfProcesses) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(7, 3, 5);
  std::string first;
  for (const int processes : {1, 2, 7}) {
    const Folder folder(study, scratch / std::to_string(processes), true);
    RunSettings settings;
    settings.processes = processes;
    EXPECT_EQ(run_study(study, folder, test::fake, settings).done, 42U);
    EXPECT_EQ(run_study(study, folder, test::fake, settings).done, 0U) << "what is done is not done again";
    const std::string text = merged(study, folder, scratch / "merged.csv");
    EXPECT_EQ(count_lines(text), 43U);
    if (first.empty()) first = text;
    EXPECT_EQ(text, first);
  }
  EXPECT_EQ(first.substr(0, first.find('\n')), "row,point,repeat,row_seed,x,w,exit,y,z,who,deep.b,error,inputs");
  EXPECT_NE(first.find("\n0,0,0,"), std::string::npos);
}

TEST(MergeCsv, HasNoCellThatASpreadsheetWouldRunAndKeepsLists) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(1, 1, 1, "outputs: [a, b, c, d, list]\n");
  const Folder folder(study, scratch / "f", true);
  const Verb verb = [](const std::vector<std::string>&) {
    std::puts(
        R"j({"a": "=cmd|' /C calc'!A0", "b": "\t=1;=2", "c": "@SUM(1,\"2\")", "d": -1.5, "list": [-1, "x;=y"]})j");
    return 0;
  };
  (void)run_study(study, folder, verb, {});
  const std::string text = merged(study, folder, scratch / "merged.csv");
  EXPECT_NE(text.find(R"j(,_cmd|' /C calc'!A0,_=1_=2,"_SUM(1,""2"")",-1.5,"[-1,""x_=y""]",)j"), std::string::npos)
      << text;
}

TEST(RunStudy, GoesOnAfterAKillAnywhere) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(10, 2, 8);
  const Folder whole(study, scratch / "whole", true), killed(study, scratch / "killed", true);
  (void)run_study(study, whole, test::fake, {});
  // Killed after some time, again and again; rows take a while so that kills fall into them.
  const Verb slow = [](const std::vector<std::string>& words) {
    ::usleep(3000);
    return test::fake(words);
  };
  int kills = 0;
  for (; kills < 300 && status_of(study, killed).done < study.rows(); ++kills) {
    const pid_t child = ::fork();
    if (child == 0) {
      RunSettings settings;
      settings.processes = 2;
      (void)run_study(study, killed, slow, settings);
      ::_exit(0);
    }
    // On slow machines it takes longer until a first row ends.
    ::usleep(static_cast<useconds_t>((1 + kills / 9) * (4000 + 1500 * (kills % 9))));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  EXPECT_GT(kills, 1);
  EXPECT_EQ(merged(study, killed, scratch / "a.csv"), merged(study, whole, scratch / "b.csv"));
}

TEST(RunStudy, FailuresAreResultsAndSayWhy) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(5, 1, 100, "time_limit: 0.5\n");
  const Folder folder(study, scratch / "f", true);
  const Verb verb = [](const std::vector<std::string>& words) {
    const int x = std::stoi(words[2]);
    if (x == 1) throw std::runtime_error("no such luck");
    if (x == 2) std::abort();
    if (x == 3) ::usleep(10'000'000);
    if (x == 4) std::fprintf(stderr, "snug: error: bad\n");
    if (x == 4) return 2;
    return test::fake(words);
  };
  RunSettings settings;
  settings.processes = 4;
  const RunSummary summary = run_study(study, folder, verb, settings);
  EXPECT_EQ(summary.done, 10U);
  EXPECT_EQ(summary.failed, 8U);
  const auto rows = folder.read(0);
  EXPECT_EQ(rows.at(2).error, "no such luck");
  EXPECT_EQ(rows.at(2).exit_code, 1);
  EXPECT_EQ(rows.at(4).exit_code, -1);
  EXPECT_NE(rows.at(4).error.find("signal 6"), std::string::npos);
  EXPECT_EQ(rows.at(6).error, "over its time limit");
  EXPECT_EQ(rows.at(8).error, "error: bad");
  EXPECT_EQ(rows.at(8).exit_code, 2);
  EXPECT_EQ(run_study(study, folder, verb, settings).done, 0U);
}

TEST(RunStudy, LeavesNothingWhereTheFirstRowCannotBeUsedAndOthersEndedBeforeIt) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(5, 1, 2);
  const std::filesystem::path made = scratch / "made", given = scratch / "given";
  std::filesystem::create_directory(given);
  const Verb verb = [](const std::vector<std::string>& words) {
    if (words[2] != "0") return test::fake(words);
    ::usleep(300'000);
    return 2;
  };
  RunSettings settings;
  settings.processes = 4;
  for (const std::filesystem::path& path : {made, given}) {
    const Folder folder(study, path, true);
    EXPECT_THROW((void)run_study(study, folder, verb, settings), InputError);
  }
  EXPECT_FALSE(std::filesystem::exists(made));
  EXPECT_TRUE(std::filesystem::is_empty(given)) << "a folder that was there stays";
  const Study corrected = test::grid(4, 1, 2);
  const Folder folder(corrected, made, true);
  EXPECT_EQ(run_study(corrected, folder, test::fake, settings).failed, 0U);
}

TEST(RunStudy, RemovesNothingOfAStudyThatWasBegunBefore) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(5, 1, 2);
  RunSettings later;
  later.first_chunk = 1;
  (void)run_study(study, Folder(study, scratch / "f", true), test::fake, later);
  const Verb refused = [](const std::vector<std::string>&) { return 2; };
  const Folder folder(study, scratch / "f", true);
  EXPECT_THROW((void)run_study(study, folder, refused, {}), InputError);
  EXPECT_EQ(status_of(study, folder).done, study.rows() - 2);
}

TEST(RunStudy, ARowWhoseProcessIsKilledIsTriedAgainAndNeverAResult) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(3, 1, 100);
  const Folder folder(study, scratch / "f", true);
  const std::filesystem::path mark = scratch / "mark";
  const Verb once = [&](const std::vector<std::string>& words) {
    if (words[2] == "1" && !std::filesystem::exists(mark)) {
      std::ofstream(mark) << "seen";
      ::raise(SIGKILL);
    }
    if (words[2] == "2") ::raise(SIGKILL);
    return test::fake(words);
  };
  const RunSummary summary = run_study(study, folder, once, {});
  EXPECT_EQ(summary.done, 4U);
  EXPECT_EQ(summary.left_out, 2U);
  EXPECT_EQ(status_of(study, folder).done, 4U);
  EXPECT_EQ(run_study(study, folder, test::fake, {}).done, 2U);
}

TEST(RunStudy, ARowWhoseProcessSomebodyEndsIsTriedAgainToo) {
  const test::ScratchFolder scratch;
  const std::filesystem::path mark = scratch / "mark";
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) {
    std::filesystem::remove(mark);
    const Verb once = [&](const std::vector<std::string>& words) {
      if (words[2] == "1" && !std::filesystem::exists(mark)) {
        std::ofstream(mark) << "seen";
        ::raise(number);
      }
      return test::fake(words);
    };
    const RunSummary summary = run_study(test::grid(3, 1, 100), once, {});
    EXPECT_EQ(summary.done, 6U) << number;
    EXPECT_EQ(summary.failed, 0U) << number;
  }
}

TEST(RunStudy, TellsEveryRowInItsOrderHoweverLongEachTakes) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(6, 1, 4);
  const Verb late = [](const std::vector<std::string>& words) {
    ::usleep(static_cast<useconds_t>(words[4] == "left" ? 30000 : 1000));
    std::fprintf(stderr, "of %s\n", words[2].c_str());
    return test::fake(words);
  };
  std::vector<std::uint64_t> told;
  std::vector<std::string> said;
  std::vector<RowResult> results;
  RunSettings settings;
  settings.processes = 4;
  settings.tell = [&](const RowResult& result, const std::string& words) {
    told.push_back(result.row);
    said.push_back(words);
    results.push_back(result);
  };
  const std::vector<std::uint64_t> expected = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  EXPECT_EQ(run_study(study, late, settings).done, 12U) << "without a folder";
  EXPECT_EQ(told, expected);
  EXPECT_EQ(said[6], "of 3\n");
  const std::vector<RowResult> without = results;
  const Folder folder(study, scratch / "f", true);
  RunSettings some;
  some.first_chunk = some.last_chunk = 1;
  (void)run_study(study, folder, late, some);
  told.clear();
  results.clear();
  said.clear();
  EXPECT_EQ(run_study(study, folder, late, settings).done, 8U);
  EXPECT_EQ(told, expected) << "rows of an earlier call are told too";
  EXPECT_EQ(said[6], "") << "what it said is not kept";
  EXPECT_EQ(results, without);
}

TEST(RunStudy, EndsInOrderWhenItIsStopped) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(20, 1, 100);
  const Folder folder(study, scratch / "f", true);
  const Verb slow = [](const std::vector<std::string>& words) {
    ::usleep(words[2] == "0" ? 1000 : 10'000'000);
    return test::fake(words);
  };
  RunSettings settings;
  settings.processes = 2;
  std::size_t told = 0;
  settings.tell = [&](const RowResult&, const std::string&) { ++told; };
  settings.is_stopped = [&] { return told == 2; };
  const RunSummary summary = run_study(study, folder, slow, settings);
  EXPECT_EQ(summary.done, 2U);
  EXPECT_EQ(summary.left_out, 0U);
  EXPECT_EQ(told, 2U);
  EXPECT_EQ(folder.read(0).size(), 2U);
}

TEST(RunStudy, WhatARowSaysWhenItIsStoppedIsToldAndNotKept) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(1, 1, 100);
  const Folder folder(study, scratch / "f", true);
  const Verb orderly = [](const std::vector<std::string>& words) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigprocmask(SIG_BLOCK, &set, nullptr);
    std::fputs("ready\n", stderr);
    int number = 0;
    sigwait(&set, &number);
    return test::fake(words);
  };
  RunSettings settings;
  settings.processes = 2;
  int asked = 0;
  settings.is_stopped = [&] { return ++asked > 8; };  // a tenth of a second each: both are ready by then
  std::size_t told = 0;
  settings.tell = [&](const RowResult& result, const std::string&) { told += result.values.empty() ? 0 : 1; };
  EXPECT_EQ(run_study(study, folder, orderly, settings).done, 0U);
  EXPECT_EQ(told, 2U);
  EXPECT_TRUE(folder.read(0).empty());
}

TEST(RunStudy, AFirstRowThatCannotBeUsedEndsItWithTheReason) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(3, 1, 2);
  const Folder folder(study, scratch / "f", true);
  const Verb verb = [](const std::vector<std::string>&) {
    std::fprintf(stderr, "snug: error: command line: --y: no such option\n");
    return 2;
  };
  try {
    (void)run_study(study, folder, verb, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no such option"), std::string::npos);
  }
  EXPECT_EQ(status_of(study, folder).done, 0U);
}

TEST(RunStudy, OnlyTheChunksAskedFor) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(5, 1, 2);
  const Folder folder(study, scratch / "f", true);
  RunSettings settings;
  settings.first_chunk = 1;
  settings.last_chunk = 3;
  EXPECT_EQ(run_study(study, folder, test::fake, settings).done, 6U);
  EXPECT_TRUE(folder.read(0).empty());
  const ArrayPlan plan = plan_array(study, folder);
  const std::vector<std::pair<std::uint64_t, std::uint64_t>> expected = {{0, 0}, {4, 4}};
  EXPECT_EQ(plan.tasks, expected);
  const ArrayPlan one = plan_array(study, folder, 1);
  ASSERT_EQ(one.tasks.size(), 1U);
  EXPECT_EQ(one.tasks[0].first, 0U);
  EXPECT_EQ(one.tasks[0].second, 4U);
}

TEST(Slurm, TheScriptDoesEachRangeInATaskOfItsOwn) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(5, 1, 2, "slurm: {partition: long, time: '2:00:00'}\n");
  const Folder folder(study, scratch / "it's here", true);
  const std::string script = array_script(study, folder, plan_array(study, folder), "/opt/snug", "study.yaml");
  EXPECT_NE(script.find("#SBATCH --array=0-4\n"), std::string::npos);
  EXPECT_NE(script.find("#SBATCH --partition=long\n"), std::string::npos);
  EXPECT_NE(script.find("set -- 0-0 1-1 2-2 3-3 4-4\n"), std::string::npos);
  EXPECT_NE(script.find("exec /opt/snug study study.yaml --dir '"), std::string::npos);
  EXPECT_NE(script.find("it'\\''s here"), std::string::npos);
}

}  // namespace
}  // namespace snug::study
