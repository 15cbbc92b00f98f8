// Client: what simulators of other makes say is not believed, and not shown as it is.
#include "snug/click/client.hpp"

#include "snug/click/test/stranger.hpp"
#include "snug/core/text.hpp"

namespace snug::click {
namespace {

using test::Stranger;

TEST(Client, ShowsWhatASimulatorSaysWithoutWhatTerminalsObey) {
  const Stranger stranger(
      [](const Message&) { return Error{"\x1b[2J\nsnug: all is well\r\x07" + std::string(1000, 'x')}; });
  const auto answer = Client(stranger.endpoint()).shake_hands();
  ASSERT_FALSE(answer.has_value());
  EXPECT_TRUE(is_printable(answer.error())) << answer.error();
  EXPECT_LT(answer.error().size(), 400u);
}

TEST(Client, TakesNoNamesThatAreNone) {
  for (const std::string& bad : {std::string("\x1b]0;x\x07"), std::string("a\nb"), std::string(200, 'n')}) {
    for (const int place : {0, 1, 2}) {
      const Stranger stranger([&](const Message&) {
        Handshake handshake;
        handshake.version = kVersion;
        ObjectDescription& object = handshake.objects[place == 0 ? bad : "robot"];
        object.controls = {place == 1 ? bad : "joint"};
        object.control_types = {ValueType::AngularVelocity1D};
        object.events[place == 2 ? bad : "vacuum"] = ValueType::Activated;
        return handshake;
      });
      const auto answer = Client(stranger.endpoint()).shake_hands();
      ASSERT_FALSE(answer.has_value());
      EXPECT_TRUE(is_printable(answer.error())) << answer.error();
      EXPECT_NE(answer.error().find("which is invalid"), std::string::npos) << answer.error();
    }
  }
}

}  // namespace
}  // namespace snug::click
