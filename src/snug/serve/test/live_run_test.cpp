// Tests of LiveRun: what watchers are told is what was simulated, and pausing really holds the run.
#include "snug/serve/live_run.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "snug/replay/form.hpp"

namespace snug::serve {
namespace {

using std::chrono::milliseconds;

record::RecordingHeader header_of_two_bodies() {
  record::RecordingHeader header;
  header.record_period = 0.008;
  header.bodies.resize(2);
  header.bodies[0].name = "table";
  header.bodies[0].kind = record::BodyKind::Static;
  header.bodies[1].name = "BOX001";
  return header;
}

record::Frame frame_at(int i) {
  record::Frame frame;
  frame.time = 0.008 * i;
  frame.step = 8 * i;
  frame.bodies.resize(2);
  frame.bodies[1].X_WB.p.x() = 0.01 * i;
  return frame;
}

struct Message {
  std::string event, data;
};

/// All that is in the log now.
std::vector<Message> messages_of(LiveRun& live) {
  std::vector<Message> messages;
  for (std::size_t i = 0;; ++i) {
    const auto text = live.wait_for(i, milliseconds(0));
    if (!text) return messages;
    const std::size_t line = text->find('\n');
    EXPECT_TRUE(text->starts_with("event: "));
    EXPECT_TRUE(text->ends_with("\n\n"));
    messages.push_back({text->substr(7, line - 7), text->substr(line + 7, text->size() - line - 9)});
  }
}

std::string from_base64(const std::string& text) {
  std::string bytes;
  unsigned bits = 0, held = 0;
  for (const char c : text) {
    const std::size_t digit =
        std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
    if (digit == std::string_view::npos) break;
    held = (held << 6U) | static_cast<unsigned>(digit);
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<char>((held >> (bits -= 8)) & 0xFFU));
  }
  return bytes;
}

TEST(LiveRun, ShowsOneRunAfterTheOther) {
  LiveRun live("run", 0.0);
  LiveRun::Place place;
  const auto next = [&] {
    const auto text = live.next(place, milliseconds(0));
    return text ? text->substr(7, text->find('\n') - 7) : "nothing";
  };
  live.begin(header_of_two_bodies());
  EXPECT_TRUE(live.add(frame_at(1)));
  EXPECT_EQ(next(), "header");
  live.finish("", "");
  const auto first = live.whole_form();
  live.begin(header_of_two_bodies());
  EXPECT_FALSE(live.is_over());
  EXPECT_EQ(next(), "end") << "of the run that was watched, which is gone";
  EXPECT_EQ(next(), "nothing");
  for (int i = 1; i <= 5; ++i) EXPECT_TRUE(live.add(frame_at(i)));
  EXPECT_EQ(next(), "header");
  live.finish("", "");
  EXPECT_EQ(next(), "frames");
  EXPECT_EQ(next(), "end");
  EXPECT_EQ(next(), "nothing");
  const replay::Form whole = replay::decode_form(*live.whole_form(), "whole");
  EXPECT_EQ(nlohmann::json::parse(whole.header_json)["frames"], 5) << "the second run alone";
  EXPECT_NE(*first, *live.whole_form());
}

TEST(LiveRun, TellsEveryFrameAndEventOnceAndInOrder) {
  LiveRun live("run", 0.0);
  live.begin(header_of_two_bodies());
  for (int i = 1; i <= 500; ++i) {
    if (i % 100 == 0) live.add(record::Event{0.008 * i, "seal", "BOX001", "t", {{"n", 1.0}}});
    EXPECT_TRUE(live.add(frame_at(i)));
    if (i % 90 == 0) std::this_thread::sleep_for(milliseconds(60));  // several messages
  }
  live.finish("", "");
  const std::vector<Message> messages = messages_of(live);
  ASSERT_GE(messages.size(), 4u);
  EXPECT_EQ(messages.front().event, "header");
  EXPECT_EQ(messages.back().event, "end");
  const replay::Form header = replay::decode_form(from_base64(messages.front().data), "header");
  EXPECT_EQ(nlohmann::json::parse(header.header_json)["bodies"].size(), 2u);
  EXPECT_EQ(replay::find_channel(header, "time")->rows, 0u);
  EXPECT_EQ(replay::find_channel(header, "body.0.pose")->rows, 1u);
  int frames = 0, events = 0;
  for (const Message& message : messages) {
    if (message.event != "frames") continue;
    const replay::Form form = replay::decode_form(from_base64(message.data), "frames");
    events += static_cast<int>(nlohmann::json::parse(form.header_json)["events"].size());
    for (std::size_t row = 0; row < replay::find_channel(form, "time")->rows; ++row) {
      ++frames;
      EXPECT_NEAR(replay::find_channel(form, "time")->at(row, 0), 0.008 * frames, 1e-6);
      EXPECT_NEAR(replay::find_channel(form, "body.1.pose")->at(row, 0), 0.01 * frames, 1e-5);
    }
  }
  EXPECT_EQ(frames, 500);
  EXPECT_EQ(events, 5);
  ASSERT_NE(live.whole_form(), nullptr);
  EXPECT_EQ(replay::find_channel(replay::decode_form(*live.whole_form(), "whole"), "time")->rows, 500u);
}

TEST(LiveRun, HoldsTheRunWhilePausedAndLetsSingleFramesThrough) {
  LiveRun live("run", 0.0);
  live.begin(header_of_two_bodies());
  std::atomic<int> done = 0;
  live.pause();
  std::thread simulation([&] {
    for (int i = 1; live.add(frame_at(i)); ++i) done = i;
  });
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(done, 0);                       // the first frame is shown, and the run waits behind it
  EXPECT_EQ(messages_of(live).size(), 3u);  // header, state, the frame
  for (int i = 1; i <= 3; ++i) {
    live.step();
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_EQ(done, i);
  }
  live.resume();
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_GT(done, 10);
  live.pause();
  live.stop();  // also while paused
  simulation.join();
}

TEST(LiveRun, KeepsToTheSpeedAskedForAndCatchesUpNoPause) {
  LiveRun live("run", 2.0);
  live.begin(header_of_two_bodies());
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (int i = 1; i <= 50; ++i) live.add(frame_at(i));  // 0.4 s at twice the speed
  EXPECT_GE(seconds(), 0.19);
  EXPECT_LT(seconds(), 1.0);  // generous: the machine may be busy
  std::this_thread::sleep_for(milliseconds(500));
  const double before = seconds();
  for (int i = 51; i <= 100; ++i) live.add(frame_at(i));
  EXPECT_GE(seconds() - before, 0.1);  // 0.2 s; a run that caught up would take none
}

TEST(LiveRun, EndsEvenWithoutAFrame) {
  LiveRun live("run", 1.0);
  live.finish("", "the scenario is empty");
  EXPECT_TRUE(live.is_over());
  EXPECT_EQ(live.whole_form(), nullptr);
  const std::vector<Message> messages = messages_of(live);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].data.find("the scenario is empty"), std::string::npos);
}

}  // namespace
}  // namespace snug::serve
