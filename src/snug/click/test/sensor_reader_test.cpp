// Tests of SensorReader: whatever it reads is what decode() reads.
#include "snug/click/internal/sensor_reader.hpp"

#include <gtest/gtest.h>

#include "snug/click/sensor_writer.hpp"
#include "snug/core/rng.hpp"

namespace snug::click::internal {
namespace {

SensorValue position(Rng& rng) { return {ValueType::Position, {rng.normal(), rng.normal(), rng.normal()}, 0.0, false}; }

/// A cell of a robot that moves and boxes of which some do.
void move(Rng& rng, Sensor& sensor) {
  sensor.time += 0.008;
  ObjectSensors& robot = sensor.objects["robot"];
  robot.angles = {rng.normal(), rng.normal()};
  robot.forces = {{rng.normal(), 0.0, -0.0}};
  robot.sensors["holding"] = {{ValueType::Activated, Vector3::Zero(), 0.0, rng.uniform(0.0, 1.0) < 0.5}};
  for (int i = 0; i < 5; ++i) {
    ObjectSensors& box = sensor.objects["box" + std::to_string(i)];
    if (box.object.empty() || rng.uniform(0.0, 1.0) < 0.3) box.object = {position(rng)};
  }
}

Sensor decoded(const std::string& frame) { return std::get<Sensor>(*decode(frame)); }

TEST(SensorReader, ReadsWhatDecodingReads) {
  Rng rng = Rng(1).split("sensor reader");
  Sensor sensor;
  move(rng, sensor);
  SensorReader reader;
  const std::string first = encode(sensor);
  EXPECT_EQ(reader.read(first), nullptr);  // nothing learned
  EXPECT_EQ(reader.learn(first, decoded(first)), sensor);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    move(rng, sensor);
    const std::string frame = encode(sensor);
    const Sensor* read = reader.read(frame);
    ASSERT_NE(read, nullptr);
    EXPECT_EQ(*read, sensor);
  }
}

TEST(SensorReader, LeavesToDecodingWhatIsNotAsBefore) {
  Rng rng = Rng(2).split("sensor reader");
  Sensor sensor;
  move(rng, sensor);
  const std::string first = encode(sensor);
  SensorReader reader;
  (void)reader.learn(first, decoded(first));
  Sensor more = sensor;
  more.objects["zebra"];
  Sensor fewer = sensor;
  fewer.objects.erase("box3");
  Sensor renamed = fewer;
  renamed.objects["box9"] = sensor.objects["box3"];
  for (const Message& message : {Message(more), Message(fewer), Message(renamed), Message(Reset{}),
                                 Message(Error{"no"}), Message(SensorRequest{})}) {
    EXPECT_EQ(reader.read(encode(message)), nullptr) << name_of(message);
  }
  EXPECT_EQ(reader.read(""), nullptr);
  EXPECT_EQ(reader.read(first + "\x28\x01"), nullptr);  // a field that click.proto has not
  const Sensor* read = reader.read(first);
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(*read, sensor);
}

TEST(SensorReader, LearnsNothingOfAnObjectThatIsThereTwice) {
  Rng rng = Rng(3).split("sensor reader");
  Sensor sensor;
  move(rng, sensor);
  const std::string twice = encode(sensor) + wire::write_object("box1", sensor.objects["box2"]);
  SensorReader reader;
  EXPECT_EQ(reader.learn(twice, decoded(twice)).objects.at("box1"), sensor.objects["box2"]);  // the last counts
  EXPECT_EQ(reader.read(twice), nullptr);
}

TEST(SensorReader, NeverReadsAnythingElseFromMutatedFrames) {
  Rng rng = Rng(4).split("sensor reader");
  Sensor sensor;
  move(rng, sensor);
  std::string frame = encode(sensor);
  SensorReader reader;
  (void)reader.learn(frame, decoded(frame));
  int read_count = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string mutated = frame;
    for (int k = 0; k < 1 + i % 3; ++k) {
      const auto at = static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(mutated.size())));
      if (i % 7 == 0) {
        mutated.erase(at, 1);
      } else {
        mutated[at] = static_cast<char>(rng.uniform(0.0, 256.0));
      }
    }
    const Sensor* read = reader.read(mutated);
    const auto whole = decode(mutated);
    if (read == nullptr) {
      (void)reader.learn(frame, decoded(frame));
      continue;
    }
    ++read_count;
    ASSERT_TRUE(whole.has_value() && std::holds_alternative<Sensor>(*whole)) << i;
    ASSERT_EQ(encode(Message(*read)), encode(*whole)) << i;  // NaN is not itself
  }
  EXPECT_GT(read_count, 1000);
}

}  // namespace
}  // namespace snug::click::internal
