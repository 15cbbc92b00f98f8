// RealPrograms: the demonstrator's own packing programs, from file to boxes in the container.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/run.hpp"

namespace snug::runs {
namespace {

using cell::BoxResult;
using cell::BoxState;
using cell::demonstrator;
using cell::kPackedAboveRim;
using cell::kPackedBeyondWall;
using cell::kSource;
using cell::Repick;

const std::filesystem::path kPrograms = kSource / "../shared/data/waypoints";

/// m; contacts give way: 12 kN/m a patch under at most ten boxes of 1 kg, on one patch.
constexpr double kThroughTheFloor = 10.0 * 9.81 / 1.2e4;

struct RealProgram {
  std::string file;
  std::string sequence;
  std::string corrections;
  double duration = 0.0;        ///< s, of the demonstrator
  std::size_t packed = 0;       ///< by the report
  double filling_degree = 0.0;  ///< %, eq. 1 for those boxes with 570 x 370 x 250 mm
};

const std::vector<RealProgram>& with_corrections() {
  static const std::vector<RealProgram> programs{{"poses1real.csv", "1", "seq1", 248.0, 12, 74.22},
                                                 {"poses2real.csv", "2", "seq2-5", 232.0, 12, 66.14},
                                                 {"poses3real.csv", "3", "seq2-5", 292.0, 13, 68.69}};
  return programs;
}

const std::vector<RealProgram>& for_simulation() {
  static const std::vector<RealProgram> programs{{"poses1.csv", "1", "", 248.0, 12, 74.22},
                                                 {"poses2sim.csv", "2", "", 232.0, 12, 66.14},
                                                 {"poses3sim.csv", "3", "", 292.0, 13, 68.69}};
  return programs;
}

/// As they ran on the real cell, whose cup has phases: without what stands in for them in a simulation (record 0040).
std::vector<RealProgram> as_they_ran() {
  std::vector<RealProgram> programs = with_corrections();
  for (RealProgram& program : programs) program.corrections.clear();
  return programs;
}

std::vector<RunResult> run_all(const std::vector<RealProgram>& programs,
                               const model::Scenario& scenario = demonstrator()) {
  std::vector<RunResult> results;
  for (const RealProgram& program : programs) {
    RunOptions options;
    options.program = motion::load_program(kPrograms / program.file);
    options.sequence = program.sequence;
    options.corrections = program.corrections;
    results.push_back(run(scenario, options));
  }
  return results;
}

std::size_t count_packed(const RunResult& result) {
  const auto packed = std::count_if(result.boxes.begin(), result.boxes.end(),
                                    [](const BoxResult& box) { return box.state == BoxState::Packed; });
  return static_cast<std::size_t>(packed);
}

void expect_time_of_the_demonstrator(const RealProgram& program, const RunResult& result) {
  EXPECT_FALSE(result.failure) << result.failure.text;
  EXPECT_NEAR(result.duration, program.duration, 0.04 * program.duration);
}

void expect_flips_on_the_intended_face(const RunResult& result) {
  bool has_flip = false;
  for (const Repick& repick : result.repicks) {
    EXPECT_EQ(repick.up_after, repick.up_intended) << repick.id;
    has_flip = has_flip || repick.up_after != repick.up_before;
  }
  EXPECT_TRUE(has_flip);
}

void expect_filling_degree_of_what_is_packed(const RealProgram& program, const RunResult& result) {
  double volume = 0.0;
  for (const BoxResult& box : result.boxes) {
    if (box.state == BoxState::Packed) volume += model::find_parcel(demonstrator(), box.id)->size.prod();
  }
  // Second opinion on eq. 1; 1e-9: rounding of a sum of thirteen volumes.
  EXPECT_NEAR(result.filling_degree_percent, 100.0 * volume / (0.570 * 0.370 * 0.250), 1e-9);
  if (count_packed(result) != program.packed) return;
  EXPECT_NEAR(result.filling_degree_percent, program.filling_degree, 0.005);  // the number has two decimals
}

/// Corner by corner, with the sizes that boxes collide with: a second opinion on what counts as packed (1e-9:
/// rounding).
void expect_packed_boxes_inside(const RunResult& result) {
  const model::Container& tote = *model::find_container(demonstrator(), demonstrator().target);
  for (const BoxResult& box : result.boxes) {
    ASSERT_TRUE(box.X_TP.p.allFinite()) << box.id;
    if (box.state != BoxState::Packed) continue;
    const Vector3 half = 0.5 * model::collision_size(demonstrator(), *model::find_parcel(demonstrator(), box.id));
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
      const Vector3 p_TQ = box.X_TP * Vector3(sign.cwiseProduct(half));
      EXPECT_LE(std::abs(p_TQ.x()), 0.5 * tote.inner_size.x() + kPackedBeyondWall + 1e-9) << box.id;
      EXPECT_LE(std::abs(p_TQ.y()), 0.5 * tote.inner_size.y() + kPackedBeyondWall + 1e-9) << box.id;
      EXPECT_LE(p_TQ.z(), tote.inner_size.z() + kPackedAboveRim + 1e-9) << box.id;
      EXPECT_GE(p_TQ.z(), -kThroughTheFloor) << box.id;
    }
  }
}

class RealPrograms : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kPrograms)) GTEST_SKIP() << "the demonstrator's programs are not at " << kPrograms;
  }
};

// One test for all checks: the runs take seconds, and each test is a process of its own.
TEST_F(RealPrograms, PackAtLeast36Of37BoxesWithTheirCorrectionsInTimeAndOnTheIntendedFaces) {
  const std::vector<RunResult> results = run_all(with_corrections());
  std::size_t packed = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    SCOPED_TRACE(with_corrections()[i].file);
    expect_time_of_the_demonstrator(with_corrections()[i], results[i]);
    expect_flips_on_the_intended_face(results[i]);
    expect_filling_degree_of_what_is_packed(with_corrections()[i], results[i]);
    expect_packed_boxes_inside(results[i]);
    RecordProperty("packed_" + with_corrections()[i].sequence, static_cast<int>(count_packed(results[i])));
    packed += count_packed(results[i]);
  }
  EXPECT_GE(packed, 36U);
}

// The push was found on the re-picks of sequences 1 and 2; how far off those of sequence 3 are was not looked at then.
TEST_F(RealPrograms, PackAtLeast36Of37BoxesAsTheyRanWhereACupWithPhasesPushes) {
  model::Scenario scenario = demonstrator();
  scenario.cup.release_push = 0.7;
  const std::vector<RealProgram> programs = as_they_ran();
  const std::vector<RunResult> results = run_all(programs, scenario);
  std::size_t packed = 0;
  double offset = 0.0, repicks = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    SCOPED_TRACE(programs[i].file);
    expect_time_of_the_demonstrator(programs[i], results[i]);
    expect_flips_on_the_intended_face(results[i]);
    expect_packed_boxes_inside(results[i]);
    packed += count_packed(results[i]);
    for (const Repick& repick : results[i].repicks) offset += repick.offset;
    repicks += static_cast<double>(results[i].repicks.size());
  }
  EXPECT_GE(packed, 36U);
  EXPECT_EQ(repicks, 10.0);
  EXPECT_LE(offset / repicks, 0.008);
  for (const Repick& repick : results.back().repicks) EXPECT_LE(repick.offset, 0.008) << repick.id;
}

TEST_F(RealPrograms, PackAtLeast33Of37BoxesInTheFilesForSimulation) {
  const std::vector<RunResult> results = run_all(for_simulation());
  std::size_t packed = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    SCOPED_TRACE(for_simulation()[i].file);
    EXPECT_FALSE(results[i].failure) << results[i].failure.text;
    expect_packed_boxes_inside(results[i]);
    RecordProperty("packed_" + for_simulation()[i].sequence, static_cast<int>(count_packed(results[i])));
    std::printf("%s: %zu of %zu packed\n", for_simulation()[i].file.c_str(), count_packed(results[i]),
                for_simulation()[i].packed);
    packed += count_packed(results[i]);
  }
  EXPECT_GE(packed, 33U);
}

}  // namespace
}  // namespace snug::runs
