// Simulator: frames that were changed by mistake or on purpose move nothing and end nothing.
#include <gtest/gtest.h>

#include <cstdlib>

#include "cell.hpp"
#include "snug/core/rng.hpp"
#include "snug/served_cell/simulator.hpp"

namespace snug::served_cell {
namespace {

using click::CommandList;
using click::Control;
using click::decode;
using click::encode;
using click::Error;
using click::Handshake;
using click::HandshakeInit;
using click::kAcknowledgeEvent;
using click::kFeedEvent;
using click::kHalfTurnEvent;
using click::kStandEvent;
using click::Reset;
using click::Sensor;
using click::SensorRequest;

using test::control_of;
using test::kStill;
using test::Talk;

/// What a peer may send by mistake or on purpose: frames that were changed a little, cut, lengthened or made up.
std::string mutate(std::string frame, Rng& rng) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(n))); };
  const std::size_t changes = 1 + below(4);
  for (std::size_t i = 0; i < changes; ++i) {
    const std::size_t at = frame.empty() ? 0 : below(frame.size());
    switch (below(6)) {
      case 0:
        if (!frame.empty()) frame[at] = static_cast<char>(frame[at] ^ static_cast<char>(1U << below(8)));
        break;
      case 1:
        if (!frame.empty()) frame[at] = static_cast<char>(below(256));
        break;
      case 2:
        frame.resize(at);
        break;
      case 3:
        frame.insert(at, 1 + below(9), static_cast<char>(below(256)));
        break;
      case 4:
        frame.insert(at, frame.substr(0, below(40)));
        break;
      default:
        frame.erase(at, below(9));
    }
  }
  return frame;
}

std::vector<std::string> good_frames() {
  Control fed = control_of(kStill, {{"vacuum", true}, {"blow_off", false}});
  fed.objects["box027"].events = {{kFeedEvent, true}, {kHalfTurnEvent, true}};
  Control old = control_of(kStill);
  old.objects["ur10"].list = CommandList::AngularVelocities;
  Control still, brought;
  still.objects["ur10"].events = {{kStandEvent, true}, {kAcknowledgeEvent, true}};
  brought.objects["box028"].events = {{kFeedEvent, true}};
  return {encode(still),
          encode(brought),
          encode(HandshakeInit{}),
          encode(SensorRequest{}),
          encode(Reset{}),
          encode(control_of(kStill)),
          encode(fed),
          encode(old),
          encode(Handshake{}),
          encode(Sensor{})};
}

int count_from(const char* variable, int few) {
  const char* text = std::getenv(variable);
  return text == nullptr ? few : std::atoi(text);
}

// The full numbers: SNUG_MUTATED_FRAMES=1000000 SNUG_MUTATED_SESSIONS=10000 build/src/snug/served_cell/served_cell_test
// --gtest_filter=*Mutated*
TEST(Simulator, IsNotMovedByMutatedFramesOfStrangers) {
  Talk talk;
  (void)talk.say(HandshakeInit{}, "controller");
  for (int i = 0; i < 10; ++i) (void)talk.say(control_of({0.1, 0, 0, 0, 0, 0}), "controller");
  const std::uint64_t hash = talk.simulator.hash();
  const std::vector<std::string> frames = good_frames();
  Rng rng = Rng(16).split("mutated frames");
  const int count = count_from("SNUG_MUTATED_FRAMES", 20000);
  for (int i = 0; i < count; ++i) {
    const std::string frame = mutate(frames[static_cast<std::size_t>(i) % frames.size()], rng);
    const auto answer = talk.simulator.answer("stranger", frame);
    ASSERT_TRUE(answer.has_value());
    const auto decoded = decode(*answer);
    ASSERT_TRUE(decoded.has_value());
    const bool looks = std::holds_alternative<Handshake>(*decoded) || std::holds_alternative<Sensor>(*decoded);
    ASSERT_TRUE(looks || std::holds_alternative<Error>(*decoded)) << i;
    ASSERT_TRUE(talk.simulator.is_controller("controller"));
  }
  EXPECT_EQ(talk.simulator.hash(), hash);
}

TEST(Simulator, OutlivesMutatedSessions) {
  const std::vector<std::string> frames = good_frames();
  const int count = count_from("SNUG_MUTATED_SESSIONS", 60);
  Talk talk;
  for (int session = 0; session < count; ++session) {
    Rng rng = Rng(static_cast<std::uint64_t>(session)).split("mutated session");
    (void)talk.simulator.answer("a", frames[0]);
    for (int i = 0; i < 20; ++i) {
      const auto which = static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(frames.size())));
      const bool is_mutated = rng.uniform(0.0, 1.0) < 0.7;
      const std::string frame = is_mutated ? mutate(frames[which], rng) : frames[which];
      const std::uint64_t hash = talk.simulator.hash();
      const std::int64_t steps = talk.simulator.counts().steps;
      const auto answer = talk.simulator.answer("a", frame);
      if (!answer) continue;  // it was an Error, or became one
      const auto decoded = decode(*answer);
      ASSERT_TRUE(decoded.has_value()) << session;
      if (std::holds_alternative<Error>(*decoded) && talk.simulator.counts().steps == steps) {
        ASSERT_EQ(talk.simulator.hash(), hash) << session << " " << i;
      }
    }
    (void)talk.simulator.leave("a");
    ASSERT_EQ(talk.simulator.time(), 0.0);
  }
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{})));
}

}  // namespace
}  // namespace snug::served_cell
