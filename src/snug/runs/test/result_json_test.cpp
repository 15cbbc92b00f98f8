// Results as JSON: what is written is read again, and pages have the same keys.
#include "snug/runs/result_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

#include "snug/cell/test/demonstrator.hpp"

namespace snug::runs {
namespace {

using cell::BoxResult;
using cell::BoxState;
using cell::FailureKind;
using cell::kSource;
using cell::ProtectiveStop;
using cell::StopCause;

RunResult some_result() {
  RunResult result;
  result.duration = 12.5;
  result.wall = 0.25;
  result.real_time_factor = 50.0;
  result.filling_degree_percent = 74.21;
  BoxResult box;
  box.id = "BOX027";
  box.state = BoxState::Packed;
  box.X_TP = {Vector3(-1.0, -1.0, 1.0).asDiagonal(), Vector3(0.1, 0.2, 0.05)};
  box.up = 'Y';
  box.outside = 0.0015;
  box.events = {{4.5, "seal", "BOX027", "Box(BOX027): sealed", {{"offset_mm", 1.5}, {"row", 3.0}}}};
  result.boxes = {box};
  result.bodies = {{"cube", Pose{Matrix3::Identity(), Vector3(1.0, 2.0, 3.0)}, 0.5}};
  result.events = box.events;
  result.repicks = {{"BOX027", 0.004, 'Z', 'X', 'X'}, {"BOX028", 0.002, 'Z', 'X', 'Y'}};
  result.solver.steps = 12345678901;
  result.solver.worst_penetration = 1e-5;
  result.state_hash = 0xfedcba9876543210U;
  result.contacts = {{"a", "b", Vector3(0.1, 0.2, 0.3), Vector3::UnitX(), Vector3(0.0, 0.0, 9.81), -1e-6, true}};
  result.lost = {{"stray", 3.0, Vector3(0.0, 0.0, -5.0), Vector3(0.0, 0.0, -9.0)}};
  result.stop = ProtectiveStop{StopCause::SensorForce, "wrist", 160.0, 150.0, "N", 8.0, 4, "Place(BOX027)", "tote", ""};
  result.is_interrupted = true;
  result.ended_by = "who watched it";
  result.warnings = {"rough"};
  result.failure = {FailureKind::ProtectiveStop, "protective stop at 8.000 s"};
  return result;
}

TEST(ResultJson, IsReadAsItWasWritten) {
  const RunResult result = some_result();
  const std::optional<RunResult> read = read_result(format_result(result));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->duration, result.duration);
  ASSERT_EQ(read->boxes.size(), 1U);
  EXPECT_EQ(read->boxes[0].state, BoxState::Packed);
  EXPECT_EQ(read->boxes[0].up, 'Y');
  EXPECT_NEAR(read->boxes[0].outside, result.boxes[0].outside, 1e-18);  // by way of millimetres
  EXPECT_EQ(read->boxes[0].X_TP.p, result.boxes[0].X_TP.p);
  EXPECT_EQ(read->boxes[0].X_TP.R, result.boxes[0].X_TP.R);
  EXPECT_EQ(read->boxes[0].events, result.boxes[0].events) << "numbers with names of their own, too";
  EXPECT_EQ(read->solver.steps, result.solver.steps);
  EXPECT_EQ(read->state_hash, result.state_hash);
  EXPECT_EQ(read->contacts[0].body_b, "b");
  EXPECT_TRUE(read->contacts[0].slides);
  EXPECT_EQ(read->lost[0].v_W, result.lost[0].v_W);
  ASSERT_TRUE(read->stop.has_value());
  EXPECT_EQ(read->stop->cause, StopCause::SensorForce);
  EXPECT_EQ(read->stop->row, 4);
  EXPECT_EQ(read->ended_by, result.ended_by);
  EXPECT_EQ(read->warnings, result.warnings);
  EXPECT_EQ(read->failure, result.failure);
  EXPECT_EQ(format_result(*read), format_result(result)) << "nothing is lost";
}

TEST(ResultJson, HasPosesToTheRoundingOfAQuaternion) {
  RunResult result = some_result();
  result.boxes[0].X_TP.R = exp_rotation(Vector3(0.1, -0.2, 3.0));
  const std::optional<RunResult> read = read_result(format_result(result));
  ASSERT_TRUE(read.has_value());
  EXPECT_LT((read->boxes[0].X_TP.R - result.boxes[0].X_TP.R).norm(), 1e-14);
}

TEST(ResultJson, OfAnEmptyResultIsOneToo) {
  const std::optional<RunResult> read = read_result(format_result({}));
  ASSERT_TRUE(read.has_value());
  EXPECT_FALSE(read->stop.has_value());
  EXPECT_FALSE(read->failure);
}

TEST(ResultJson, OfAnotherVersionIsReadAsFarAsItSays) {
  const auto read = read_result(R"({"duration_s": 2.0, "boxes": [{"id": "A", "state": "held"}], "speed": "of light"})");
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->duration, 2.0);
  EXPECT_EQ(read->boxes[0].state, BoxState::Held);
  EXPECT_EQ(read->failure.kind, FailureKind::None);
}

TEST(ResultJson, IsNotReadFromAnythingElse) {
  for (const char* text :
       {"", "[1, 2", "[]", "3", R"({"boxes": 3})", R"({"boxes": [3]})", R"({"duration_s": "2"})",
        R"({"boxes": [{"state": "flying"}]})", R"({"boxes": [{"up": "XY"}]})", R"({"state_hash": "nothing"})",
        R"({"solver": []})", R"({"warnings": [1]})", R"({"boxes": [{"X_TP": {"p": [1, 2]}}]})",
        R"({"boxes": [{"X_TP": {"quat_wxyz": [2, 0, 0, 0]}}]})", R"({"events": [{"offset_mm": "near"}]})"}) {
    EXPECT_FALSE(read_result(text).has_value()) << text;
  }
  EXPECT_FALSE(read_result(std::string(100, '[') + std::string(100, ']')).has_value()) << "too deep";
  EXPECT_FALSE(read_result("\"" + std::string((std::size_t{4} << 20U) + 1, 'a') + "\"").has_value()) << "too long";
}

/// Numbers that are not finite have no form in JSON.
TEST(ResultJson, HasNullForWhatIsNotFinite) {
  RunResult result;
  result.real_time_factor = std::numeric_limits<double>::infinity();
  const std::optional<RunResult> read = read_result(format_result(result));
  ASSERT_TRUE(read.has_value());
  EXPECT_TRUE(std::isnan(read->real_time_factor));
}

/// To write the file anew: SNUG_WRITE_TYPES=1 in the environment.
TEST(ResultJson, IsWhatTheViewerReads) {
  const std::filesystem::path path = kSource / "viewer/src/replay/result.ts";
  if (std::getenv("SNUG_WRITE_TYPES") != nullptr) std::ofstream(path) << format_result_types();
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), format_result_types());
}

}  // namespace
}  // namespace snug::runs
