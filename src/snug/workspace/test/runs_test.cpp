// Tests of runs with a small script in the place of snug: started in order, watched, stopped, told from killed ones.
#include "snug/workspace/runs.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::workspace {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Writes what snug pack does first into its log; then what the order's name says.
constexpr const char* kScript = R"sh(#!/bin/sh
echo "in $(pwd)"
for word in "$@"; do echo "<$word>"; done
while [ $# -gt 0 ]; do
  case "$1" in --log) log="$2";; --sequence) sequence="$2";; report) [ "$2" = good.h5 ] && { echo page > good.html; exit 0; }; echo "snug: no recording"; exit 2;; esac
  shift
done
echo '{"event":"session started","sequence":"mine","agent":"a","plant":"p","items":["A","B"],"places_are_chosen":false,"tracking":{"kind":"fast","tempo":1.0}}' > "$log"
case "$sequence" in
  killed) kill -9 $$;;
  recorded) echo x > a.live; echo x > a.h5;;
  wrong) rm "$log"; echo "snug: wrong words"; exit 2;;
  waits) trap 'echo "snug: interrupted"; echo "{\"event\":\"session ended\",\"time\":1.0,\"failure\":\"none\",\"text\":\"\"}" >> "$log"; exit 1' INT; while true; do sleep 0.02; done;;
  nice) sleep 0.1; echo "nice $(nice)";;
  deaf) trap '' INT; while true; do sleep 0.02; done;;
esac
echo '{"event":"session ended","time":1.0,"failure":"none","text":""}' >> "$log"
)sh";

class RunsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    program_ = scratch_.path() / "snug";
    std::ofstream(program_) << kScript;
    fs::permissions(program_, fs::perms::owner_all);
    cells_ = scratch_.path() / "cells";
    fs::create_directory(cells_);
    std::ofstream(cells_ / "cell.yaml") << "name: cell\n";
    folder_ = std::make_unique<Folder>(cells_);
  }
  static RunRequest request(const std::string& name, const std::string& sequence) {
    RunRequest one;
    one.name = name;
    one.scenario = "cell.yaml";
    one.sequence = sequence;
    return one;
  }
  static bool wait_until(const std::function<bool()>& holds) {
    for (int i = 0; i < 500 && !holds(); ++i) std::this_thread::sleep_for(milliseconds(10));
    return holds();
  }
  static bool reaches(Runs& runs, const std::string& name, RunState state) {
    return wait_until([&] { return runs.status(name).state == state && runs.status(name).progress.items == 2; });
  }

  test::ScratchFolder scratch_;
  fs::path program_, cells_;
  std::unique_ptr<Folder> folder_;
};

TEST_F(RunsTest, StartTheCommandThatIsShownInTheFolder) {
  Runs runs(*folder_, program_, 1);
  RunRequest one = request("a", "it's $(mine)");
  one.tempo = 0.85;
  runs.start(one);
  ASSERT_TRUE(reaches(runs, "a", RunState::Done));
  const RunStatus status = runs.status("a");
  EXPECT_EQ(status.command,
            "snug pack cell.yaml --sequence 'it'\\''s $(mine)' --plant-seed 0 --tempo 0.85 --log a.jsonl "
            "--operator a.operator --program a.program.csv --live a.live -o a.h5");
  const std::string said = read_file(cells_ / "a.txt", "what it printed");
  EXPECT_NE(said.find("in " + fs::canonical(cells_).string() + "\n<pack>\n<cell.yaml>\n<--sequence>\n<it's $(mine)>\n"),
            std::string::npos)
      << said;
  EXPECT_EQ(status.files, (std::vector<std::string>{"a.jsonl", "a.operator", "a.txt"}));
  EXPECT_THROW(runs.start(one), InputError);  // the name is taken
  runs.remove("a");
  EXPECT_THROW((void)runs.status("a"), InputError);
  EXPECT_EQ(folder_->list().size(), 1U);
}

TEST_F(RunsTest, LeaveTheProcessorToThePageUnlessTheyDriveARobot) {
  Runs runs(*folder_, program_, 1);
  runs.start(request("a", "nice"));
  RunRequest served = request("b", "nice");
  served.plant = "click://127.0.0.1:5555";
  runs.start(served);
  ASSERT_TRUE(reaches(runs, "a", RunState::Done));
  ASSERT_TRUE(reaches(runs, "b", RunState::Done));
  const int own = ::getpriority(PRIO_PROCESS, 0);
  const auto says = [&](const std::string& name, int nice) {
    return read_file(cells_ / (name + ".txt"), "what it printed").find("nice " + std::to_string(nice) + "\n") !=
           std::string::npos;
  };
  EXPECT_TRUE(says("a", std::min(19, own + 5)));
  EXPECT_TRUE(says("b", own));
}

TEST_F(RunsTest, WaitForTheirTurnAndStopWhenTold) {
  Runs runs(*folder_, program_, 1);
  runs.start(request("a", "waits"));
  runs.start(request("b", "mine"));
  runs.start(request("c", "mine"));
  ASSERT_TRUE(reaches(runs, "a", RunState::Running));
  EXPECT_EQ(runs.status("b").state, RunState::Waiting);
  EXPECT_THROW(runs.remove("b"), InputError);
  EXPECT_TRUE(runs.stop("b"));
  EXPECT_EQ(runs.status("b").state, RunState::Failed);
  EXPECT_EQ(runs.status("b").message, "stopped before it began");
  EXPECT_TRUE(runs.stop("a"));
  EXPECT_TRUE(reaches(runs, "a", RunState::Done));
  EXPECT_EQ(runs.status("a").message, "interrupted");
  EXPECT_TRUE(reaches(runs, "c", RunState::Done));
  EXPECT_FALSE(runs.stop("c"));
  EXPECT_EQ(runs.list().size(), 3U);
}

TEST_F(RunsTest, EndAtOnceWhenToldTwice) {
  Runs runs(*folder_, program_, 1);
  runs.start(request("a", "deaf"));
  ASSERT_TRUE(reaches(runs, "a", RunState::Running));
  EXPECT_TRUE(runs.stop("a"));
  EXPECT_TRUE(runs.stop("a"));
  EXPECT_TRUE(reaches(runs, "a", RunState::Ended));
}

TEST_F(RunsTest, EndAtOnceWithoutBeingAskedFirst) {
  Runs runs(*folder_, program_, 1);
  runs.start(request("a", "waits"));
  ASSERT_TRUE(reaches(runs, "a", RunState::Running));
  EXPECT_TRUE(runs.stop_now("a"));
  EXPECT_TRUE(reaches(runs, "a", RunState::Ended));
  EXPECT_FALSE(runs.stop_now("a"));
}

TEST_F(RunsTest, TakeWhatWhoOperatesSays) {
  Runs runs(*folder_, program_, 1);
  runs.start(request("a", "waits"));
  ASSERT_TRUE(reaches(runs, "a", RunState::Running));
  RunRequest held = request("h", "mine");
  held.holds = true;
  runs.start(held);
  EXPECT_EQ(read_file(cells_ / "h.operator", "what is said at first"), "next hold\n");
  runs.operate("a", "next   hold");
  runs.operate("a", "\"a \\\"b\" take-out B");
  for (const char* wrong : {"", "# nothing", "next jump", "next go\nnext skip", "next"})
    EXPECT_THROW(runs.operate("a", wrong), InputError) << wrong;
  EXPECT_EQ(read_file(cells_ / "a.operator", "what was said"), "next hold\n\"a \\\"b\" take-out B\n");
  EXPECT_THROW(runs.operate("none", "next hold"), InputError);
  EXPECT_THROW(runs.operate("../a", "next hold"), InputError);
  fs::remove(cells_ / "a.operator");
  fs::create_symlink(program_, cells_ / "a.operator");
  EXPECT_THROW(runs.operate("a", "next hold"), InputError) << "not written through a link";
  EXPECT_TRUE(runs.stop("a"));
  EXPECT_TRUE(reaches(runs, "a", RunState::Done));
  EXPECT_THROW(runs.operate("a", "next hold"), InputError) << "it is over";
}

TEST_F(RunsTest, PackCellsThatOthersServe) {
  RunRequest one = request("a", "first");
  one.plant = "click://127.0.0.1:5555";
  one.perception = "camera";
  EXPECT_EQ(as_shell_line(command_of(one)),
            "snug pack cell.yaml --sequence first --plant 'click://127.0.0.1:5555' --perception camera --log a.jsonl "
            "--operator a.operator --program a.program.csv");
  check(one);
  one.plant = "ur://10.0.0.2";
  one.observe = "tcp://127.0.0.1:5555";
  one.moves_a_robot = true;
  check(one);
  EXPECT_NE(as_shell_line(command_of(one)).find("--yes-this-moves-a-robot"), std::string::npos);
  for (const char* wrong : {"--help", "http://x", "click:/x", "ur://a b", "ur://\n"}) {
    one.plant = wrong;
    EXPECT_THROW(check(one), InputError) << wrong;
  }
  one = request("a", "first");
  one.moves_a_robot = true;
  EXPECT_THROW(check(one), InputError) << "a simulated one";
  EXPECT_EQ(make_command("a", "film")[1], "picture");
  EXPECT_THROW((void)make_command("a", "--help"), InputError);
  EXPECT_THROW((void)make_command("../a", "film"), InputError);
}

TEST_F(RunsTest, MakeProgramsOfRobotsWithTheCellThatTheyPacked) {
  RunRequest one = request("a", "it's \\ mine");
  one.items = "mine.csv";
  const std::string line = as_shell_line(command_of(one));
  EXPECT_EQ(words_of(line), command_of(one));
  EXPECT_EQ(as_shell_line(make_command("a", "urscript", line)),
            "snug export a.program.csv --scenario cell.yaml --items mine.csv --sequence 'it'\\''s \\ mine' --format "
            "urscript -o a.script");
  EXPECT_EQ(make_command("a", "ros", line).back(), "a.ros.yaml");
  // The line is that of NAME.txt, which anybody may have written.
  for (const char* wrong :
       {"", "snug", "snug pack", "snug pack --help", "snug pack ../secret.yaml", "snug pack /etc/passwd",
        "rm -rf cell.yaml", "snug pack cell.yaml --items --set", "snug pack cell.yaml --items /a/b.csv",
        "snug pack cell.yaml --sequence -o", "snug pack cell.yaml --sequence ''"})
    EXPECT_THROW((void)make_command("a", "urscript", wrong), InputError) << wrong;
  EXPECT_EQ(words_of("  a 'b c'  d'e'f 'g"), (std::vector<std::string>{"a", "b c", "def", "g"}));
  EXPECT_TRUE(words_of("").empty());
}

TEST_F(RunsTest, TellWhatGoesOnElsewhereFromWhatWasKilled) {
  Runs runs(*folder_, program_, 2), other(*folder_, program_, 1);
  runs.start(request("a", "waits"));
  runs.start(request("k", "killed"));
  runs.start(request("w", "wrong"));
  ASSERT_TRUE(reaches(other, "a", RunState::Running));
  EXPECT_FALSE(other.status("a").can_be_stopped);
  EXPECT_FALSE(other.stop("a"));
  EXPECT_THROW(other.remove("a"), InputError);
  EXPECT_TRUE(reaches(other, "k", RunState::Ended));
  EXPECT_TRUE(wait_until([&] { return other.status("w").state == RunState::Failed; }));
  EXPECT_EQ(other.status("w").message, "wrong words");
  EXPECT_TRUE(runs.stop("a"));
  EXPECT_TRUE(reaches(other, "a", RunState::Done));
}

TEST_F(RunsTest, AreInterruptedWhenTheirOwnerEnds) {
  auto runs = std::make_unique<Runs>(*folder_, program_, 1);
  runs->start(request("a", "waits"));
  runs->start(request("b", "mine"));
  ASSERT_TRUE(reaches(*runs, "a", RunState::Running));
  runs.reset();
  Runs after(*folder_, program_, 1);
  EXPECT_EQ(after.status("a").state, RunState::Done);
  EXPECT_EQ(after.status("b").state, RunState::NotStarted);
  EXPECT_NE(after.status("b").command, "");
}

TEST_F(RunsTest, AreListedAtOnceAndReadInTheBackground) {
  for (int i = 0; i < 20; ++i) {
    std::ofstream(cells_ / ("r" + std::to_string(i) + ".jsonl"))
        << R"({"event":"session started","sequence":"mine","agent":"a","plant":"p","items":["A"],)"
        << R"("places_are_chosen":false,"tracking":{"kind":"fast","tempo":1.0}})"
        << "\n"
        << R"({"event":"session ended","time":1.0,"failure":"none","text":""})"
        << "\n";
    std::ofstream(cells_ / ("r" + std::to_string(i) + ".txt")) << "$ snug pack cell.yaml\n";
  }
  Runs runs(*folder_, program_, 1);
  const std::vector<RunStatus> first = runs.list(milliseconds(0));
  ASSERT_EQ(first.size(), 20U);
  for (const RunStatus& one : first) EXPECT_EQ(one.state, RunState::Unread);
  EXPECT_EQ(first.front().command, "snug pack cell.yaml");
  EXPECT_TRUE(wait_until([&] {
    return std::ranges::all_of(runs.list(milliseconds(0)),
                               [](const RunStatus& one) { return one.state == RunState::Done; });
  }));
  EXPECT_EQ(runs.status("r0").progress.items, 1);  // who asks for one gets it at once
}

TEST_F(RunsTest, LeaveNoFramesBesideTheirRecording) {
  Runs runs(*folder_, program_, 1);
  runs.start(request("a", "recorded"));
  ASSERT_TRUE(reaches(runs, "a", RunState::Done));
  EXPECT_TRUE(wait_until([&] { return !fs::exists(cells_ / "a.live"); }));
  EXPECT_TRUE(fs::exists(cells_ / "a.h5"));
  runs.start(request("k", "killed"));  // no recording: the frames are what there is
  std::ofstream(cells_ / "k.live") << "x";
  ASSERT_TRUE(reaches(runs, "k", RunState::Ended));
  EXPECT_TRUE(fs::exists(cells_ / "k.live"));
  runs.remove("k");
  EXPECT_FALSE(fs::exists(cells_ / "k.live"));
}

TEST_F(RunsTest, MakeReportsOfRecordingsAndSayWhyNot) {
  Runs runs(*folder_, program_, 1);
  EXPECT_THROW((void)runs.report("good"), InputError);
  std::ofstream(cells_ / "good.h5") << "x";
  std::ofstream(cells_ / "bad.h5") << "x";
  EXPECT_EQ(runs.report("good"), "page\n");
  EXPECT_EQ(folder_->read("good.html"), "page\n");
  try {
    (void)runs.report("bad");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.got, "no recording");
  }
  fs::remove(cells_ / "good.html");
  fs::create_symlink(scratch_.path() / "outside.html", cells_ / "good.html");
  EXPECT_THROW((void)runs.report("good"), InputError);
  EXPECT_FALSE(fs::exists(scratch_.path() / "outside.html"));
}

TEST_F(RunsTest, RefuseWhatIsNoNameAndNoWord) {
  Runs runs(*folder_, program_, 1);
  fs::create_symlink("/etc/hostname", cells_ / "link.yaml");
  const std::vector<std::function<void(RunRequest&)>> wrongs = {
      [](RunRequest& one) { one.name = ""; },
      [](RunRequest& one) { one.name = "../a"; },
      [](RunRequest& one) { one.name = "-a"; },
      [](RunRequest& one) { one.name = std::string(100, 'a'); },
      [](RunRequest& one) { one.scenario = "../cell.yaml"; },
      [](RunRequest& one) { one.scenario = "link.yaml"; },
      [](RunRequest& one) { one.scenario = "a.csv"; },
      [](RunRequest& one) { one.scenario = "none.yaml"; },
      [](RunRequest& one) { one.items = "cell.yaml"; },
      [](RunRequest& one) { one.sequence = ""; },
      [](RunRequest& one) { one.sequence = "--agent"; },
      [](RunRequest& one) { one.sequence = "a\nb"; },
      [](RunRequest& one) { one.sequence = std::string("a\0b", 3); },
      [](RunRequest& one) { one.sequence = "\xff"; },
      [](RunRequest& one) { one.tempo = 0.4; },
      [](RunRequest& one) { one.tempo = std::numeric_limits<double>::quiet_NaN(); },
      [](RunRequest& one) { one.resumes = "../a"; }};
  for (std::size_t i = 0; i < wrongs.size(); ++i) {
    SCOPED_TRACE(i);
    RunRequest one = request("a", "mine");
    wrongs[i](one);
    EXPECT_THROW(runs.start(one), InputError);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(cells_), {}), 2);
}

TEST_F(RunsTest, AreNotOtherPeoplesFiles) {
  Runs runs(*folder_, program_, 1);
  std::ofstream(cells_ / "notes.txt") << "$ echo mine\n";
  std::ofstream(cells_ / "notes.h5") << "mine";
  std::ofstream(cells_ / "data.jsonl") << "{\"a\":1}\n";
  EXPECT_TRUE(runs.list().empty());
  EXPECT_THROW(runs.remove("notes"), InputError);
  EXPECT_THROW(runs.remove("data"), InputError);
  runs.start(request("a", "mine"));
  ASSERT_TRUE(reaches(runs, "a", RunState::Done));
  std::ofstream(cells_ / "a.txt") << "mine";  // the log says that it was a run; these words are somebody else's
  runs.remove("a");
  EXPECT_TRUE(fs::exists(cells_ / "a.txt"));
  EXPECT_FALSE(fs::exists(cells_ / "a.jsonl"));
  EXPECT_TRUE(fs::exists(cells_ / "notes.h5"));
}

// A second opinion: the shell itself.
TEST(ShellLine, IsTakenApartIntoTheSameWords) {
  const std::vector<std::string> words = {"printf", "<%s>", "a b", "it's", "$HOME", "`id`",
                                          "",       "*",    "\\",  "\"",   "a\nb",  "-x"};
  const std::unique_ptr<FILE, int (*)(FILE*)> shell(::popen(as_shell_line(words).c_str(), "r"), ::pclose);
  std::array<char, 400> said{};
  const std::size_t count = std::fread(said.data(), 1, said.size(), shell.get());
  EXPECT_EQ(std::string(said.data(), count), "<a b><it's><$HOME><`id`><><*><\\><\"><a\nb><-x>");
}

}  // namespace
}  // namespace snug::workspace
