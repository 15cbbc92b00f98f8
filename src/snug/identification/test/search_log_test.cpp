// SearchLog: points come back to the last bit, cut lines go, other files stay untouched.
#include "snug/identification/internal/search_log.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "snug/core/file_lock.hpp"
#include "snug/core/rng.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/identification/test/helpers.hpp"

namespace snug::identification::internal {
namespace {

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Eigen::VectorXd point_of(double a, double b) { return Eigen::Vector2d(a, b); }

class SearchLogTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "points.csv"; }
  void write(const std::string& text) const { std::ofstream(path(), std::ios::binary) << text; }
  snug::test::ScratchFolder folder_;
};

TEST_F(SearchLogTest, KeepsPointsInMemoryWithoutAFile) {
  SearchLog log({}, "any");
  EXPECT_FALSE(log.find(point_of(1.0, 2.0)));
  log.add(point_of(1.0, 2.0), 3.5);
  EXPECT_EQ(log.find(point_of(1.0, 2.0)), 3.5);
  EXPECT_FALSE(log.find(point_of(2.0, 1.0)));
  EXPECT_FALSE(log.find(Eigen::VectorXd::Constant(1, 1.0)));
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(SearchLogTest, ReadsBackEveryBitOfWhatItWrote) {
  Rng rng = Rng(11).split("points");
  std::vector<std::pair<Eigen::VectorXd, double>> points;
  for (int i = 0; i < 200; ++i) {
    const double size = std::pow(10.0, rng.index(40) - 20), a = size * rng.normal(), b = rng.normal();
    points.emplace_back(point_of(a, b), rng.uniform());
  }
  points.emplace_back(point_of(0.1, 1.0 / 3.0), 5e-324);
  points.emplace_back(point_of(1e300, -1e-300), HUGE_VAL);
  {
    SearchLog log(path(), "task");
    for (const auto& [point, cost] : points) log.add(point, cost);
    EXPECT_EQ(log.size(), points.size());
  }
  const std::string before = text_of_file(path());
  const SearchLog again(path(), "task");
  EXPECT_EQ(again.size(), points.size());
  for (const auto& [point, cost] : points) EXPECT_EQ(again.find(point), cost);
  EXPECT_EQ(text_of_file(path()), before);
}

TEST_F(SearchLogTest, GoesOnBehindWhatIsThere) {
  {
    SearchLog log(path(), "task");
    log.add(point_of(1.0, 2.0), 3.0);
  }
  {
    SearchLog log(path(), "task");
    log.add(point_of(4.0, 5.0), 6.0);
  }
  const SearchLog log(path(), "task");
  EXPECT_EQ(log.find(point_of(1.0, 2.0)), 3.0);
  EXPECT_EQ(log.find(point_of(4.0, 5.0)), 6.0);
}

TEST_F(SearchLogTest, TakesAwayALineThatWasCutAndNothingElse) {
  {
    SearchLog log(path(), "task");
    log.add(point_of(1.0, 2.0), 3.0);
  }
  const std::string whole = text_of_file(path());
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    write(whole.substr(0, size));
    const SearchLog log(path(), "task");
    EXPECT_EQ(log.size(), size == whole.size() ? 1U : 0U) << size;
    // What is left is whole lines: the title at least.
    const std::string left = text_of_file(path());
    EXPECT_TRUE(whole.starts_with(left) && left.ends_with('\n')) << size;
  }
}

TEST_F(SearchLogTest, RefusesTheLogOfAnotherTaskAndLeavesItAsItIs) {
  {
    SearchLog log(path(), "bounds 0 to 1");
    log.add(point_of(1.0, 2.0), 3.0);
  }
  const std::string before = text_of_file(path());
  identification::test::expect_refused([&] { SearchLog log(path(), "bounds 0 to 2"); }, "another task");
  EXPECT_EQ(text_of_file(path()), before);
  write("name,value\n1,2\n");
  identification::test::expect_refused([&] { SearchLog log(path(), "bounds 0 to 1"); }, "points.csv");
  EXPECT_EQ(text_of_file(path()), "name,value\n1,2\n");
}

TEST_F(SearchLogTest, RefusesLinesThatAreNoPoints) {
  std::string title;
  { SearchLog log(path(), "task"); }
  title = text_of_file(path());
  for (const std::string line : {"3.0,1.0,x\n", "3.0\n", "\n", "3.0;1.0\n", "3.0,,1.0\n", "3.0 1.0\n"}) {
    SCOPED_TRACE(line);
    write(title + line);
    identification::test::expect_refused([&] { SearchLog log(path(), "task"); }, "numbers: cost, parameters");
    EXPECT_EQ(text_of_file(path()), title + line);
  }
}

TEST_F(SearchLogTest, IsWrittenByOneSearchAtATime) {
  const SearchLog first(path(), "task");
  identification::test::expect_refused([&] { SearchLog second(path(), "task"); }, "another run is writing");
}

TEST_F(SearchLogTest, RefusesWhatIsNoFile) {
  identification::test::expect_refused([&] { SearchLog log(folder_.path(), "task"); }, folder_.path().string());
  identification::test::expect_refused([&] { SearchLog log(folder_ / "none/points.csv", "task"); },
                                       "a place for the log");
}

TEST_F(SearchLogTest, KeepsTheFirstCostOfAPointThatIsTriedAgain) {
  SearchLog log(path(), "task");
  log.add(point_of(1.0, 2.0), 3.0);
  log.add(point_of(1.0, 2.0), 4.0);
  EXPECT_EQ(log.find(point_of(1.0, 2.0)), 3.0);
  EXPECT_EQ(log.size(), 1U);
}

}  // namespace
}  // namespace snug::identification::internal
