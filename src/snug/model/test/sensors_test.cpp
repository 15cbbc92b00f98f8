// SENSORS.yaml is read strictly, and every key of it is documented.
#include "snug/model/sensors.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "scenario_text.hpp"
#include "snug/core/input_error.hpp"
#include "snug/model/internal/fields.hpp"

namespace snug::model {
namespace {

TEST(Sensors, ShippedFileHasTheRatesOfTheDemonstrator) {
  const Sensors sensors = load_sensors(test::project_file("scenarios/sensors/demonstrator.yaml"));
  EXPECT_EQ(sensors.motion_capture.rate, 360.0);
  EXPECT_EQ(sensors.force_torque.rate, 500.0);
  EXPECT_EQ(sensors.encoders.rate, 125.0);
  EXPECT_GT(sensors.motion_capture.clock.offset, 0.0);
  EXPECT_NEAR(sensors.motion_capture.rotation_noise, 0.1 * std::numbers::pi / 180.0, 1e-12);
}

TEST(Sensors, WithoutKeysAreIdeal) {
  const Sensors sensors = parse_sensors("motion_capture: {rate: 100.0, when_lost: held}", "s.yaml");
  EXPECT_EQ(sensors.motion_capture.rate, 100.0);
  EXPECT_EQ(sensors.motion_capture.when_lost, WhenLost::Held);
  EXPECT_EQ(sensors.force_torque, ForceTorqueParams{});
}

struct Slip {
  const char* text;
  const char* part;
};

TEST(Sensors, SlipsAreRefusedWithLineKeyAndNearestName) {
  const Slip slips[] = {
      {"motion_capture:\n  rte: 100.0", "s.yaml:2"},
      {"motion_capture: {position_nois: 0.1}", "position_noise"},
      {"motion_captur: {rate: 100.0}", "motion_capture"},
      {"motion_capture: {rate: 0}", "rate"},
      {"motion_capture: {rate: 20000}", "at most 10000"},
      {"motion_capture: {rotation_noise: 0.1}", "rotation_noise_deg"},
      {"motion_capture: {lost_probability: 1.5}", "lost_probability"},
      {"motion_capture: {when_lost: hold}", "held"},
      {"motion_capture: {clock: {offset: -1}}", "offset"},
      {"force_torque: {clock: {offset: 100.0}}", "at most 60"},
      {"force_torque: {force_noise: .nan}", "force_noise"},
      {"encoders: {clock: {rate_ppm: 5000}}", "rate_ppm"},
      {"encoders: 7", "encoders"},
      {"[1, 2]", "s.yaml:1"},
      {"motion_capture: {rate: 100.0", "s.yaml"},
  };
  for (const Slip& slip : slips) {
    SCOPED_TRACE(slip.text);
    try {
      (void)parse_sensors(slip.text, "s.yaml");
      ADD_FAILURE() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(slip.part), std::string::npos) << error.what();
    }
  }
}

TEST(Sensors, EveryKeyIsInTheFormatsDocument) {
  const std::string text = test::read_text(test::project_file("docs/formats.md"));
  std::vector<std::string> keys = {"when_lost"};
  for (const auto& more : {internal::field_keys<MotionCaptureParams>(), internal::field_keys<ForceTorqueParams>(),
                           internal::field_keys<EncoderParams>(), internal::field_keys<ClockParams>()})
    keys.insert(keys.end(), more.begin(), more.end());
  for (const std::string& key : keys) EXPECT_NE(text.find('`' + key + '`'), std::string::npos) << key;
}

}  // namespace
}  // namespace snug::model
