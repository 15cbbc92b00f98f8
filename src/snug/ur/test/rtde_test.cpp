// RTDE beside bytes computed by hand, and against broken and hostile frames.
#include "snug/ur/rtde.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "snug/core/rng.hpp"

namespace snug::ur {
namespace {

using namespace std::string_literals;

/// A session and what its client sets.
struct Client {
  explicit Client(InputOwners& owners, int connection = 1, Model model = Model::Ur10)
      : session(facts_of(model), connection, owners) {}
  std::string say(const std::string& bytes) {
    const rtde::NextFrame next = rtde::next_frame(bytes);
    EXPECT_TRUE(next.frame.has_value());
    EXPECT_EQ(next.size, bytes.size());
    return next.frame ? session.answer(*next.frame, inputs).bytes : "";
  }
  std::string say(rtde::Frame type, const std::string& payload) { return say(rtde::encode(type, payload)); }

  RtdeSession session;
  RobotInputs inputs;
};

const std::string k125Hz = "\x40\x5f\x40\x00\x00\x00\x00\x00"s;

TEST(Rtde, HandshakeHasTheBytesComputedByHand) {
  InputOwners owners;
  Client client(owners);
  EXPECT_EQ(client.say("\x00\x05V\x00\x02"s), "\x00\x04V\x01"s);
  EXPECT_EQ(client.say("\x00\x05V\x00\x03"s), "\x00\x04V\x00"s);
  EXPECT_EQ(client.say("\x00\x03v"s), "\x00\x13v\x00\x00\x00\x03\x00\x00\x00\x0f\x00\x00\x00\x08\x00\x01\x9f\x63"s);
}

TEST(Rtde, OutputsHaveTheBytesComputedByHand) {
  InputOwners owners;
  Client client(owners);
  (void)client.say("\x00\x05V\x00\x02"s);
  EXPECT_EQ(client.say(rtde::Frame::Outputs, k125Hz + "timestamp,robot_mode,"),
            "\x00\x10O\x01"s + "DOUBLE,INT32");  // the comma at the end names nothing
  EXPECT_TRUE(client.session.package({}, 1).empty());
  EXPECT_EQ(client.say(rtde::Frame::Start, ""), "\x00\x04S\x01"s);
  RobotData data;
  data.timestamp = 1.5;
  data.robot_mode = RobotMode::Running;
  EXPECT_EQ(client.session.package(data, 1), "\x00\x10U\x01\x3f\xf8\x00\x00\x00\x00\x00\x00\x00\x00\x00\x07"s);
  EXPECT_EQ(client.say(rtde::Frame::Pause, ""), "\x00\x04P\x01"s);
  EXPECT_TRUE(client.session.package(data, 2).empty());
}

TEST(Rtde, VersionOneHasNeitherFrequencyNorRecipe) {
  InputOwners owners;
  Client client(owners);
  EXPECT_EQ(client.say(rtde::Frame::Outputs, "timestamp"), "\x00\x09ODOUBLE"s);
  (void)client.say(rtde::Frame::Start, "");
  RobotData data;
  data.timestamp = 2.0;
  EXPECT_EQ(client.session.package(data, 1), "\x00\x0bU\x40\x00\x00\x00\x00\x00\x00\x00"s);
}

TEST(Rtde, NamesThatAreUnknownAreNotFound) {
  InputOwners owners;
  Client client(owners);
  (void)client.say("\x00\x05V\x00\x02"s);
  EXPECT_EQ(client.say(rtde::Frame::Outputs, k125Hz + "actual_q,no_such,,timestamp"),
            rtde::encode(rtde::Frame::Outputs, "\0VECTOR6D,NOT_FOUND,NOT_FOUND,DOUBLE"s));
  EXPECT_EQ(client.say(rtde::Frame::Start, ""), "\x00\x04S\x00"s);
  EXPECT_EQ(client.say(rtde::Frame::Inputs, "speed_slider_mask,nothing"),
            rtde::encode(rtde::Frame::Inputs, "\0UINT32,NOT_FOUND"s));
}

TEST(Rtde, AnInputIsInUseBetweenConnectionsOnly) {
  InputOwners owners;
  Client first(owners, 1);
  const std::string mine = rtde::encode(rtde::Frame::Inputs, "\x01INT32"s);
  EXPECT_EQ(first.say(rtde::Frame::Inputs, "input_int_register_0"), mine);
  EXPECT_EQ(first.say(rtde::Frame::Inputs, "input_int_register_0,"), rtde::encode(rtde::Frame::Inputs, "\x02INT32"s));
  {
    Client second(owners, 2);
    EXPECT_EQ(second.say(rtde::Frame::Inputs, "input_int_register_0,input_int_register_1"),
              rtde::encode(rtde::Frame::Inputs, "\0IN_USE,INT32"s));
    EXPECT_EQ(second.say(rtde::Frame::Inputs, "input_int_register_1"), mine);
    EXPECT_EQ(first.say(rtde::Frame::Inputs, "input_int_register_1"), rtde::encode(rtde::Frame::Inputs, "\0IN_USE"s));
  }
  EXPECT_EQ(first.say(rtde::Frame::Inputs, "input_int_register_1"), rtde::encode(rtde::Frame::Inputs, "\x03INT32"s));
}

TEST(Rtde, InputsAreReadInTheOrderOfTheirRecipe) {
  InputOwners owners;
  Client client(owners);
  (void)client.say(rtde::Frame::Inputs, "standard_digital_output,standard_digital_output_mask,input_int_register_5");
  EXPECT_EQ(client.say("\x00\x0aU\x01\x03\x07\xff\xff\xff\xfe"s), "");
  EXPECT_EQ(client.inputs.standard, 3);
  EXPECT_EQ(client.inputs.standard_mask, 7);
  EXPECT_EQ(client.inputs.registers.ints[5], -2);
}

TEST(Rtde, DataOfAnotherSizeOrRecipeSetNothing) {
  InputOwners owners;
  Client client(owners);
  (void)client.say(rtde::Frame::Inputs, "input_double_register_0");
  const RobotInputs before = client.inputs;
  for (const std::string& payload :
       {""s, "\x01"s, "\x01\x3f\xf0"s, "\x01\x3f\xf0\0\0\0\0\0\0\0"s, "\x02\x3f\xf0\0\0\0\0\0\0"s,
        "\x00\x3f\xf0\0\0\0\0\0\0"s, "\x01\x7f\xf8\0\0\0\0\0\0"s}) {
    (void)client.say(rtde::Frame::Data, payload);
    EXPECT_EQ(client.inputs, before);
  }
}

TEST(Rtde, CountsHowOftenAnInputIsSet) {
  InputOwners owners;
  Client client(owners);
  EXPECT_EQ(rtde::input_count(client.inputs, "input_double_register_0"), 0U);
  EXPECT_EQ(rtde::input_count(client.inputs, "input_double_register_99"), std::nullopt);
  (void)client.say(rtde::Frame::Inputs, "input_double_register_0");
  for (int i = 0; i < 3; ++i) (void)client.say(rtde::Frame::Data, "\x01\x3f\xf0\0\0\0\0\0\0"s);
  (void)client.say(rtde::Frame::Data, "\x01\x7f\xf8\0\0\0\0\0\0"s);  // no number
  EXPECT_EQ(rtde::input_count(client.inputs, "input_double_register_0"), 3U) << "the same value, too";
  EXPECT_EQ(rtde::input_count(client.inputs, "input_double_register_1"), 0U);
}

TEST(Rtde, FramesAreTakenOnlyWhenTheyAreWhole) {
  EXPECT_FALSE(rtde::next_frame("").frame);
  EXPECT_FALSE(rtde::next_frame("\x00\x05V\x00"s).frame);
  EXPECT_TRUE(rtde::next_frame("\x00\x02V\x00\x02"s).is_broken);
  EXPECT_EQ(rtde::next_frame("\x00\x03v\x00\x03"s).size, 3U);
  EXPECT_FALSE(rtde::next_frame("\xff\xffI"s).is_broken);
  for (const char* request : {"GET /", "POST /", "PUT /", "OPTIONS", "HEAD", "DELETE", "PATCH"}) {
    EXPECT_TRUE(rtde::next_frame(request).is_broken) << request;
  }
}

TEST(Rtde, SlowerClientsGetFewerPackages) {
  for (const double wanted : {1.0, 10.0, 50.0, 124.0, 125.0, 0.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    SCOPED_TRACE(wanted);
    InputOwners owners;
    Client client(owners);
    (void)client.say("\x00\x05V\x00\x02"s);
    ByteWriter setup;
    setup.f64(wanted);
    setup.text("timestamp");
    (void)client.say(rtde::Frame::Outputs, setup.bytes());
    (void)client.say(rtde::Frame::Start, "");
    int count = 0;
    for (int period = 1; period <= 1250; ++period) count += client.session.package({}, period).empty() ? 0 : 1;
    EXPECT_NEAR(count, 10.0 * (wanted >= 1.0 && wanted < 125.0 ? wanted : 125.0), 1.0);
  }
}

/// Bytes that a type has on the wire.
std::size_t size_of(const std::string& type) {
  return type == "BOOL" || type == "UINT8"                   ? 1U
         : type == "UINT32" || type == "INT32"               ? 4U
         : type == "UINT64" || type == "DOUBLE"              ? 8U
         : type == "VECTOR6INT32" || type == "VECTOR6UINT32" ? 24U
         : type == "VECTOR3D"                                ? 24U
         : type == "VECTOR6D"                                ? 48U
                                                             : 0U;
}

TEST(Rtde, EveryFieldHasTheSizeOfItsType) {
  for (const std::string& name : rtde::output_names()) {
    SCOPED_TRACE(name);
    InputOwners owners;
    Client client(owners);
    (void)client.say(rtde::Frame::Outputs, name);
    (void)client.say(rtde::Frame::Start, "");
    EXPECT_EQ(client.session.package({}, 1).size(), 3 + size_of(rtde::output_type(name)));
  }
  for (const std::string& name : rtde::input_names()) {
    SCOPED_TRACE(name);
    InputOwners owners;
    Client client(owners);
    (void)client.say(rtde::Frame::Inputs, name);
    EXPECT_EQ(client.say(rtde::Frame::Data, "\x01"s + std::string(size_of(rtde::input_type(name)), '\0')), "");
  }
}

TEST(Rtde, MutatedFramesAreAnsweredAndAllocateNoMore) {
  Rng rng = Rng(48).split("rtde frames");
  const std::vector<std::string> seeds = {
      "\x00\x05V\x00\x02"s,
      rtde::encode(rtde::Frame::Outputs, k125Hz + "timestamp,actual_q,output_int_register_0"),
      rtde::encode(rtde::Frame::Inputs, "input_int_register_0,speed_slider_fraction"),
      rtde::encode(rtde::Frame::Data, "\x01\0\0\0\x01\x3f\xf0\0\0\0\0\0\0"s),
      rtde::encode(rtde::Frame::Start, ""),
      rtde::encode(rtde::Frame::Pause, "")};
  InputOwners owners;
  Client client(owners);
  for (int i = 0; i < 20000; ++i) {
    std::string frame = seeds[static_cast<std::size_t>(rng.index(static_cast<int>(seeds.size())))];
    for (int changes = 1 + rng.index(3); changes > 0; --changes) {
      frame[static_cast<std::size_t>(rng.index(static_cast<int>(frame.size())))] = static_cast<char>(rng.index(256));
    }
    const rtde::NextFrame next = rtde::next_frame(frame);
    if (!next.frame) continue;
    const std::string reply = client.session.answer(*next.frame, client.inputs).bytes;
    EXPECT_LE(reply.size(), 65535U);
    EXPECT_LE(client.session.package({}, i).size(), 65535U);
    EXPECT_TRUE(std::isfinite(client.inputs.speed_slider_fraction));
  }
}

TEST(Rtde, RecipesAreFewAndShort) {
  InputOwners owners;
  Client client(owners);
  std::string names;
  for (int i = 0; i < 6000; ++i) names += "timestamp,";
  names.resize(65000);
  (void)client.say(rtde::Frame::Outputs, names);
  EXPECT_EQ(client.say(rtde::Frame::Start, ""), "\x00\x04S\x00"s);
  for (int i = 0; i < 300; ++i) (void)client.say(rtde::Frame::Inputs, "input_int_register_0");
  EXPECT_EQ(client.say(rtde::Frame::Inputs, "input_int_register_0").substr(3, 1), "\0"s);
}

}  // namespace
}  // namespace snug::ur
