// Tests of the progress of a run: at every event of a log, and of logs that are broken.
#include "snug/workspace/run_progress.hpp"

#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::workspace {
namespace {

/// Two items: the first is placed, the second has no place; then the first is gone.
session::EventLog small_log() {
  namespace event = session::event;
  event::SessionStarted started;
  started.sequence = "mine";
  started.agent = "margin";
  started.plant = "by hand";
  started.items = {model::ParcelId("A"), model::ParcelId("B")};
  const model::ItemIndex first(0), second(1);
  event::Counted one, two;
  one.time = 5.0;
  one.planned_percent = 12.5;
  two.time = 7.0;
  two.planned_percent = 12.5;
  event::SessionEnded over;
  over.time = 8.0;
  session::EventLog log;
  log.events = {started,
                event::ItemStarted{0.0, first, {}},
                event::ItemEnded{5.0, first, session::ItemEnd::Placed, ""},
                one,
                event::ItemStarted{5.0, second, {}},
                event::ItemEnded{7.0, second, session::ItemEnd::NoPlace, "too large"},
                two,
                event::ItemLost{first, session::ItemEnd::Gone, "not seen"},
                over};
  return log;
}

TEST(RunProgress, FollowsEveryEventOfALog) {
  const session::EventLog whole = small_log();
  const std::vector<std::array<int, 3>> expected = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 1, 0}, {1, 1, 0},
                                                    {1, 1, 0}, {2, 1, 0}, {2, 1, 0}, {2, 0, 1}, {2, 0, 1}};
  for (std::size_t count = 0; count <= whole.events.size(); ++count) {
    SCOPED_TRACE(count);
    session::EventLog part;
    part.events.assign(whole.events.begin(), whole.events.begin() + static_cast<std::ptrdiff_t>(count));
    const RunProgress progress = progress_of(part);
    EXPECT_EQ((std::array{progress.done, progress.packed, progress.lost}), expected[count]);
    EXPECT_EQ(progress.items, count > 0 ? 2 : 0);
    EXPECT_EQ(progress.is_over, count == whole.events.size());
    EXPECT_EQ(progress.planned_percent, count > 3 ? 12.5 : 0.0);
  }
  EXPECT_EQ(progress_of(whole).time, 8.0);
  EXPECT_EQ(progress_of(whole).plant, "by hand");
}

TEST(RunProgress, OfATextThatEndsAnywhereIsThatOfItsWholeLines) {
  std::string text;
  session::EventLog part;
  for (const session::SessionEvent& one : small_log().events) {
    const RunProgress before = progress_of(part);
    const std::string line = session::format_event(one);
    for (std::size_t cut = 0; cut <= line.size(); cut += 7)
      EXPECT_EQ(read_progress(text + line.substr(0, cut), "log"), before) << cut;
    text += line + "\n";
    part.events.push_back(one);
    EXPECT_EQ(read_progress(text, "log"), progress_of(part));
  }
}

TEST(RunProgress, IsRefusedWithTheLineOfWhatIsNoEvent) {
  const std::string first = session::format_event(small_log().events.front()) + "\n";
  for (const char* wrong : {"nonsense\n", "{}\n", "{\"event\":\"dance\"}\n", "[1]\n"}) {
    SCOPED_TRACE(wrong);
    try {
      (void)read_progress(first + wrong, "log");
      ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
      EXPECT_TRUE(error.where.starts_with("log:2")) << error.where;
    }
  }
}

// Motions and plans make up most of a log: they are passed over, and nothing is missed.
TEST(LogReader, PassesOverWhatSaysNothingOfTheProgress) {
  namespace event = session::event;
  const test::ScratchFolder scratch;
  const Folder folder(scratch.path());
  session::EventLog log;
  for (const session::SessionEvent& one : small_log().events) {
    log.events.push_back(one);
    if (log.events.size() == 1) continue;
    event::Stepped stepped;
    stepped.item = model::ItemIndex(0);
    log.events.emplace_back(stepped);
    log.events.emplace_back(event::Perceived{});
    log.events.emplace_back(event::MotionStarted{});
  }
  std::string text;
  for (const session::SessionEvent& one : log.events) text += session::format_event(one) + "\n";
  std::ofstream(scratch / "a.jsonl") << text;
  LogReader reader;
  reader.read(folder, "a.jsonl");
  EXPECT_EQ(reader.progress(), progress_of(log));
  EXPECT_EQ(reader.progress(), progress_of(small_log()));
  EXPECT_EQ(reader.offset(), text.size());
}

// Files of others: items that there are not, ends of what was not begun.
TEST(LogReader, RefusesEventsThatCannotBe) {
  namespace event = session::event;
  const test::ScratchFolder scratch;
  const Folder folder(scratch.path());
  const std::string start = session::format_event(small_log().events[0]) + "\n";
  const model::ItemIndex stranger(7);
  const std::vector<session::SessionEvent> hostile = {event::ItemStarted{0.0, stranger, {}},
                                                      event::ItemStarted{0.0, model::ItemIndex(-5), {}},
                                                      event::ItemEnded{},
                                                      event::ItemLost{stranger, session::ItemEnd::Gone, ""},
                                                      event::Operated{0.0, stranger, 1, "x hold", true, ""},
                                                      small_log().events[0]};
  for (std::size_t i = 0; i < hostile.size(); ++i) {
    std::ofstream(scratch / "a.jsonl") << start << session::format_event(hostile[i]) << "\n";
    LogReader reader;
    EXPECT_THROW(reader.read(folder, "a.jsonl"), InputError) << i;
    std::ofstream(scratch / "a.jsonl") << session::format_event(event::ItemStarted{}) << "\n";
    EXPECT_THROW(LogReader().read(folder, "a.jsonl"), InputError) << "without a start";
  }
}

TEST(LogReader, SaysWhichItemIsUnderWayAndHeld) {
  namespace event = session::event;
  session::EventLog log;
  const model::ItemIndex item(1);
  log.events = {small_log().events[0], event::ItemStarted{0.0, item, {}},
                event::Operated{1.0, item, 1, "B hold", true, ""}};
  EXPECT_EQ(progress_of(log).now, "B");
  EXPECT_EQ(progress_of(log).held, "B");
  log.events.emplace_back(event::Operated{1.0, item, 2, "B go", true, ""});
  EXPECT_EQ(progress_of(log).held, "");
  log.events.emplace_back(event::ItemEnded{2.0, item, session::ItemEnd::Placed, ""});
  EXPECT_EQ(progress_of(log).now, "");
}

// Read piece by piece, as it grows, it is the same as read at once.
TEST(LogReader, IsTheSameInPiecesAndBeginsAgainWithAShorterFile) {
  const test::ScratchFolder scratch;
  const Folder folder(scratch.path());
  std::string text;
  for (const session::SessionEvent& one : small_log().events) text += session::format_event(one) + "\n";
  LogReader reader;
  std::ofstream file(scratch / "a.jsonl", std::ios::binary);
  for (std::size_t at = 0; at < text.size(); at += 37) {
    file << text.substr(at, 37) << std::flush;
    reader.read(folder, "a.jsonl");
    EXPECT_EQ(reader.progress(), read_progress(text.substr(0, at + 37), "a.jsonl")) << at;
  }
  EXPECT_EQ(reader.progress(), progress_of(small_log()));
  EXPECT_EQ(reader.progress().boxes.size(), 2U);
  file.close();
  const std::string first = text.substr(0, text.find('\n') + 1);
  std::ofstream(scratch / "a.jsonl") << first;
  reader.read(folder, "a.jsonl");
  EXPECT_EQ(reader.progress(), read_progress(first, "a.jsonl"));
  std::ofstream(scratch / "a.jsonl", std::ios::app) << "{\"event\":\"nothing\"}\n";
  EXPECT_THROW(reader.read(folder, "a.jsonl"), InputError);
}

}  // namespace
}  // namespace snug::workspace
