// Event logs: they say all that a session came to, come back from their lines, and survive a session that is killed.
#include "snug/session/event_log.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/rng.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/session/fold.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using plant::EndReason;
using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

struct Logged {
  std::vector<SessionEvent> events;
  SessionResult result;
  std::string text;
};

Logged pack_logged(ScriptedPlant& plant) {
  Logged logged;
  SessionOptions options = quick_options();
  options.log = [&](const SessionEvent& one) {
    logged.events.push_back(one);
    logged.text += format_event(one) + "\n";
  };
  logged.result = session::pack(two_boxes(), "1", options, plant);
  return logged;
}

Logged pack_with_trouble() {
  ScriptedPlant plant;
  plant.ends = {EndReason::ForceGuard, EndReason::Completed, EndReason::NoSeal};
  plant.faults = {perception::LookFault::TooFewPoints};
  return pack_logged(plant);
}

void expect_same(const SessionResult& a, const SessionResult& b) {
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.stopped, b.stopped);
  EXPECT_EQ(a.plan, b.plan);
  EXPECT_EQ(a.planned_percent, b.planned_percent);
  EXPECT_EQ(a.duration, b.duration);
  EXPECT_EQ(motion::format_program(a.program), motion::format_program(b.program));
  ASSERT_EQ(a.items.size(), b.items.size());
  for (std::size_t i = 0; i < a.items.size(); ++i) {
    const ItemReport &one = a.items[i], &other = b.items[i];
    EXPECT_EQ(one.id, other.id);
    EXPECT_EQ(one.end, other.end);
    EXPECT_EQ(one.reason, other.reason);
    EXPECT_EQ(one.planned, other.planned);
    EXPECT_EQ(one.X_TP, other.X_TP);
    EXPECT_EQ(one.attempts, other.attempts);
    EXPECT_EQ(one.failed_attempts, other.failed_attempts);
    EXPECT_EQ(one.seconds, other.seconds);
    EXPECT_EQ(one.begin, other.begin);
    EXPECT_EQ(one.done, other.done);
    ASSERT_EQ(one.sends.size(), other.sends.size());
    for (std::size_t s = 0; s < one.sends.size(); ++s) EXPECT_EQ(one.sends[s].end, other.sends[s].end);
    ASSERT_EQ(one.recoveries.size(), other.recoveries.size());
    for (std::size_t r = 0; r < one.recoveries.size(); ++r) {
      EXPECT_EQ(one.recoveries[r].remedy, other.recoveries[r].remedy);
      EXPECT_EQ(one.recoveries[r].detail, other.recoveries[r].detail);
    }
  }
}

TEST(EventLog, SaysAllThatTheSessionCameTo) {
  const Logged logged = pack_with_trouble();
  expect_same(fold(logged.events), logged.result);
  EXPECT_FALSE(logged.result.items[0].recoveries.empty());
  EXPECT_TRUE(std::holds_alternative<event::SessionStarted>(logged.events.front()));
  EXPECT_TRUE(std::holds_alternative<event::Stepped>(logged.events.back()));
}

TEST(EventLog, ComesBackFromItsLinesToTheLastDigit) {
  const Logged logged = pack_with_trouble();
  const EventLog read = parse_log(logged.text, "log.jsonl");
  EXPECT_TRUE(read.is_whole);
  ASSERT_EQ(read.events.size(), logged.events.size());
  for (std::size_t i = 0; i < read.events.size(); ++i) {
    EXPECT_EQ(format_event(read.events[i]), format_event(logged.events[i])) << i;
  }
  expect_same(fold(read.events), logged.result);
}

TEST(EventLog, OfASessionThatWasKilledHasEverythingUpToThen) {
  const Logged logged = pack_with_trouble();
  std::size_t last = 0;
  for (std::size_t length = 0; length < logged.text.size(); length += 37) {
    const EventLog read = parse_log(std::string_view(logged.text).substr(0, length), "log.jsonl");
    EXPECT_GE(read.events.size(), last);
    last = read.events.size();
    EXPECT_EQ(read.is_whole, length == 0 || logged.text[length - 1] == '\n');
    EXPECT_LE(fold(read.events).items.size(), logged.result.items.size());
  }
  EXPECT_GT(last, 10U);
}

TEST(EventLog, SaysTheLineOfWhatItDoesNotUnderstand) {
  const std::string begin = R"({"event":"session started","sequence":"1","agent":"","plant":"","items":["b1"],)"
                            R"("places_are_chosen":false,"tracking":{"kind":"fast","tempo":1.0}})";
  const auto error_of = [&](const std::string& line) {
    try {
      (void)parse_log(begin + "\n" + line + "\n", "log.jsonl");
    } catch (const InputError& error) {
      return error.where + " " + error.key + ": " + error.got + ", " + error.expected;
    }
    return std::string("nothing");
  };
  EXPECT_EQ(error_of("{"), "log.jsonl:2 : , JSON text");
  EXPECT_EQ(error_of("[]"), "log.jsonl:2 event: nothing, this key");
  EXPECT_EQ(error_of(R"({"event":"stoped"})"), "log.jsonl:2 event: 'stoped', 'stopped'");
  EXPECT_EQ(error_of(R"({"event":"stopped","reason":"bored","text":""})").substr(0, 28),
            "log.jsonl:2 reason: 'bored',");
  EXPECT_EQ(error_of(R"({"event":"stopped","reason":"no items"})"), "log.jsonl:2 text: nothing, this key");
  EXPECT_EQ(error_of(R"({"event":"stopped","reason":"no items","text":"","x":1})").substr(0, 14), "log.jsonl:2 x:");
  const auto out_of_order = [](const std::string& expected) { return "log.jsonl:2 event: out of order, " + expected; };
  EXPECT_EQ(error_of(begin), out_of_order("one start of a session"));
  EXPECT_EQ(error_of(R"({"event":"item started","time":0,"item":1,"because_of":null})"),
            out_of_order("an item of the session"));
  EXPECT_EQ(error_of(R"({"event":"item ended","time":0,"item":0,"end":"placed","reason":""})"),
            out_of_order("the item that is under way"));
  EXPECT_THROW((void)parse_log("{\"event\":\"stopped\",\"reason\":\"no items\",\"text\":\"\"}\n", "log.jsonl"),
               InputError);
}

/// Logs with lines left out, doubled, swapped or with a character changed are read or refused, and never break.
TEST(EventLog, OfOthersIsReadOrRefused) {
  const Logged logged = pack_with_trouble();
  std::vector<std::string> lines;
  for (const SessionEvent& one : logged.events) lines.push_back(format_event(one) + "\n");
  Rng rng(11);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<std::string> changed = lines;
    const auto pick = [&] { return static_cast<std::size_t>(rng.index(static_cast<int>(changed.size()))); };
    const std::size_t at = pick();
    switch (rng.index(4)) {
      case 0:
        changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      case 1:
        changed.insert(changed.begin() + static_cast<std::ptrdiff_t>(pick()), changed[at]);
        break;
      case 2:
        std::swap(changed[at], changed[pick()]);
        break;
      default:
        changed[at][static_cast<std::size_t>(rng.index(static_cast<int>(changed[at].size()) - 1))] =
            static_cast<char>(32 + rng.index(95));
    }
    std::string text;
    for (const std::string& line : changed) text += line;
    try {
      (void)fold(parse_log(text, "log.jsonl").events);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_LT(refused, 300);
}

TEST(EventLog, IsInTheFileBeforeTheNextEventHappens) {
  const std::string path = std::string(testing::TempDir()) + "/snug_event_log.jsonl";
  ScriptedPlant plant;
  SessionOptions options = quick_options();
  LogFile file(path);
  std::size_t count = 0;
  options.log = [&](const SessionEvent& one) {
    file.write(one);
    EXPECT_EQ(load_log(path).events.size(), ++count);
  };
  const SessionResult result = session::pack(two_boxes(), "1", options, plant);
  expect_same(fold(load_log(path).events), result);
  EXPECT_THROW(LogFile("/nowhere/log.jsonl"), InputError);
}

/// What is planned ahead in a thread of its own ends before anything that it uses.
TEST(Session, WaitsForThePlanAheadWhereThePlantThrows) {
  struct Throwing : ScriptedPlant {
    std::vector<plant::Event> advance() override {
      const bool is_planning = brought.size() == 2 && brought_on_the_way.size() == 1 && has_perceived;
      if (is_planning) {
        for (int i = 0; i < 20000 && !asked->load(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        throw std::runtime_error("the plant is lost");
      }
      return ScriptedPlant::advance();
    }
    std::atomic<bool>* asked = nullptr;
    bool has_perceived = false;
  };
  std::atomic<bool> asked = false, answered = false;
  Throwing plant;
  plant.passes = true;
  plant.asked = &asked;
  SessionOptions options = quick_options();
  int count = 0;
  options.ask = [&](const std::string& line) -> std::string {
    if (line.find("\"decide\"") == std::string::npos) return "{}";
    if (++count == 1) return R"({"places": [0]})";
    asked = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    answered = true;
    return R"({"places": [0]})";
  };
  options.log = [&](const SessionEvent& one) {
    const auto* step = std::get_if<event::Stepped>(&one);
    if (step != nullptr && step->from == State::LookAhead) plant.has_perceived = true;
  };
  EXPECT_THROW((void)session::pack(two_boxes(), "1", options, plant), std::runtime_error);
  EXPECT_TRUE(asked) << "it was planned ahead";
  EXPECT_TRUE(answered) << "and waited for";
}

}  // namespace
}  // namespace snug::session
