// Recordings from tables: one motion for each number, columns in any order, every complaint with its place.
#include "snug/identification/recorded_motion.hpp"

#include <gtest/gtest.h>

#include "snug/identification/test/helpers.hpp"
#include "snug/record/archive.hpp"

namespace snug::identification {
namespace {

constexpr const char* kPoseColumns = "t,x,y,z,qw,qx,qy,qz";

model::SceneTask table_task() {
  model::SceneTask task;
  task.path = "task.yaml";
  task.start.from = model::StartFrom::Scenario;
  task.tracked = {{"parcel", {"x", "y", "z", "qw", "qx", "qy", "qz"}, {}, {}}};
  return task;
}

std::vector<RecordedMotion> read_table(const std::string& rows, const model::SceneTask& task = table_task(),
                                       const std::string& header = kPoseColumns) {
  return parse_motions(task, header + "\n" + rows, "folder/train.csv");
}

void expect_table_refused(const std::string& rows, const std::string& part, const model::SceneTask& task = table_task(),
                          const std::string& header = kPoseColumns) {
  test::expect_refused([&] { (void)read_table(rows, task, header); }, part);
}

TEST(RecordedMotion, IsReadRowByRow) {
  const std::vector<RecordedMotion> motions = read_table("0,1,2,3,1,0,0,0\n0.5,4,5,6,0,1,0,0\n");
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].name, "train.csv");
  EXPECT_EQ(motions[0].times, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(motions[0].tracked[0].body, "parcel");
  EXPECT_EQ(motions[0].tracked[0].poses[1].p, Vector3(4.0, 5.0, 6.0));
  EXPECT_LT((motions[0].tracked[0].poses[1].pose().R - Matrix3(Vector3(1, -1, -1).asDiagonal())).norm(), 1e-15);
  EXPECT_TRUE(motions[0].tracked[0].twists.empty());
  EXPECT_FALSE(motions[0].tracked[0].result);
  EXPECT_EQ(averaged_at(motions[0].tracked[0], 1), 1);
}

TEST(RecordedMotion, LeavesOutColumnsThatTheTaskDoesNotNameAndAsksForNoOrder) {
  const std::vector<RecordedMotion> motions =
      read_table("1,0,0,0,9,3,2,1,0\n1,0,0,0,9,6,5,4,0.5\n", table_task(), "qw,qx,qy,qz,temperature,z,y,x,t");
  EXPECT_EQ(motions, read_table("0,1,2,3,1,0,0,0\n0.5,4,5,6,1,0,0,0\n"));
}

TEST(RecordedMotion, IsOneForEachNumberOfTheRecordingColumn) {
  model::SceneTask task = table_task();
  task.recording_column = "toss";
  const std::string header = std::string("toss,") + kPoseColumns;
  // Rows of two recordings may alternate: time grows in each.
  const std::vector<RecordedMotion> motions = read_table(
      "7,0,1,0,0,1,0,0,0\n3,0,2,0,0,1,0,0,0\n7,0.1,3,0,0,1,0,0,0\n3,0.1,4,0,0,1,0,0,0\n7,0.2,5,0,0,1,0,0,0\n", task,
      header);
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[0].name, "train.csv, toss 7");
  EXPECT_EQ(motions[1].name, "train.csv, toss 3");
  EXPECT_EQ(motions[0].times.size(), 3U);
  EXPECT_EQ(motions[1].tracked[0].poses[1].p.x(), 4.0);
  expect_table_refused("7,0,1,0,0,1,0,0,0\n7,0,1,0,0,1,0,0,0\n", "train.csv:3", task, header);
  expect_table_refused("7,0,1,0,0,1,0,0,0\n,0.1,1,0,0,1,0,0,0\n", "a number in every row", task, header);
  expect_table_refused("7,0,1,0,0,1,0,0,0\n7,0.1,1,0,0,1,0,0,0\n3,0,1,0,0,1,0,0,0\n", "at least two rows of each", task,
                       header);
}

TEST(RecordedMotion, HasTwistsAndResultsWhereTheTaskNamesThem) {
  model::SceneTask task = table_task();
  task.tracked[0].velocities = {"vx", "vy", "vz", "wx", "wy", "wz"};
  task.tracked[0].result = {"ex", "ey", "ez", "ew", "ei", "ej", "ek"};
  const std::string header = std::string(kPoseColumns) + ",vx,vy,vz,wx,wy,wz,ex,ey,ez,ew,ei,ej,ek";
  const std::vector<RecordedMotion> motions = read_table(
      "0,0,0,0,1,0,0,0,1,2,3,4,5,6,7,8,9,0,0,1,0\n0.1,0,0,0,1,0,0,0,1.5,2,3,4,5,6,7,8,9,0,0,1,0\n", task, header);
  const RecordedBody& body = motions[0].tracked[0];
  ASSERT_EQ(body.twists.size(), 2U);
  EXPECT_EQ(body.twists[0].linear, Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(body.twists[1].angular, Vector3(4.0, 5.0, 6.0));
  ASSERT_TRUE(body.result);
  EXPECT_EQ(body.result->p, Vector3(7.0, 8.0, 9.0));
  // The end alone needs one row, where the recording says what it was.
  task.only_final_state = true;
  EXPECT_EQ(read_table("0,0,0,0,1,0,0,0,1,2,3,4,5,6,7,8,9,0,0,1,0\n", task, header).size(), 1U);
}

TEST(RecordedMotion, HasBodiesThatAreDriven) {
  model::SceneTask task = table_task();
  task.kinematic = {{"pusher", {"a", "b", "c", "d", "e", "f", "g"}, {}, {}}};
  const std::vector<RecordedMotion> motions = read_table("0,0,0,0,1,0,0,0,1,2,3,1,0,0,0\n0.1,0,0,0,1,0,0,0,,,,,,,\n",
                                                         task, std::string(kPoseColumns) + ",a,b,c,d,e,f,g");
  EXPECT_EQ(motions[0].kinematic[0].poses[0].p, Vector3(1.0, 2.0, 3.0));
  EXPECT_FALSE(record::is_tracked(motions[0].kinematic[0].poses[1]));
}

TEST(RecordedMotion, ThatCannotBeUsedIsRefusedWithItsPlace) {
  expect_table_refused("", "no rows");
  expect_table_refused("0,1,2,3,1,0,0,0\n", "a single row");
  expect_table_refused("0,1,2,3,1,0,0,0\n0,1,2,3,1,0,0,0\n", "0 after 0");
  expect_table_refused("0,1,2,3,1,0,0,0\n-1,1,2,3,1,0,0,0\n", "train.csv:3");
  expect_table_refused("0,1,2,3,1,0,0,0\n1,1,2,3,1,1,0,0\n", "train.csv:3");
  expect_table_refused("0,1,2,3,1,0,0,0\n1,1,2,3,1,1,0,0\n", "quaternion");
  expect_table_refused("0,1,2,3,1,0,0,0\n1,,2,3,1,0,0,0\n", "nothing beside other numbers");
  expect_table_refused("0,1,2,3,1,0,0,0\n1,x,2,3,1,0,0,0\n", "train.csv:3");
  expect_table_refused("0,1,2,3,1,0,0\n", "qz", table_task(), "t,x,y,z,qw,qx,qy");
  model::SceneTask twice = table_task();
  twice.tracked.push_back({"other", {"x", "b", "c", "d", "e", "f", "g"}, {}, {}});
  expect_table_refused("", "column 'x'", twice);
  expect_table_refused("", "each column of the recording for one thing", twice);
}

TEST(RecordedMotion, NeedsAFirstPoseWhereBodiesStartFromIt) {
  const std::string rows = "0,,,,,,,\n0.1,1,2,3,1,0,0,0\n0.2,1,2,3,1,0,0,0\n";
  EXPECT_NO_THROW((void)read_table(rows));
  model::SceneTask task = table_task();
  task.start.from = model::StartFrom::FirstRow;
  expect_table_refused(rows, "no pose of 'parcel' in its first row", task);
  expect_table_refused(rows, "start: {from: scenario}", task);
}

}  // namespace
}  // namespace snug::identification
