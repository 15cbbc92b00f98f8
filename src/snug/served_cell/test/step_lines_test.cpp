// StepLines: what a line allows, also when it comes in pieces, and what is none.
#include "snug/served_cell/step_lines.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <vector>

#include "snug/served_cell/server.hpp"

namespace snug::served_cell {
namespace {

class StepLinesTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::pipe(ends_), 0); }
  void TearDown() override {
    ::close(ends_[0]);
    if (ends_[1] >= 0) ::close(ends_[1]);
  }
  int type(const std::string& text) {
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    return lines_.read(ends_[0]);
  }
  int ends_[2] = {-1, -1};
  std::vector<std::string> complaints_;
  StepLines lines_{[this](const std::string& text) { complaints_.push_back(text); }};
};

TEST_F(StepLinesTest, AllowSteps) {
  EXPECT_EQ(type("\n"), 1);
  EXPECT_EQ(type("12\n\n"), 13);
  EXPECT_EQ(type("1"), 0) << "the line has not ended";
  EXPECT_EQ(type("0\n"), 10);
  EXPECT_EQ(type("r\n"), kReset);
  EXPECT_EQ(type("c\n"), -1);
  EXPECT_TRUE(complaints_.empty());
  ::close(ends_[1]);
  ends_[1] = -1;
  EXPECT_EQ(lines_.read(ends_[0]), -1) << "nobody will type any more";
}

TEST_F(StepLinesTest, ComplainOfWhatIsNone) {
  EXPECT_EQ(type("x\n-1\n0\n1000001\n5 \n2\n"), 2);
  ASSERT_EQ(complaints_.size(), 5U);
  EXPECT_EQ(complaints_[0], "'x': an empty line, a number of steps, c or r is expected");
}

}  // namespace
}  // namespace snug::served_cell
