// Tests of TemporaryFolder: its own, emptied, gone.
#include "snug/core/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace snug {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryFolder, IsItsOwnCanBeEmptiedAndIsGoneWithTheObject) {
  fs::path was;
  {
    const TemporaryFolder one("snug-test"), other("snug-test");
    was = one.path();
    EXPECT_NE(one.path(), other.path());
    EXPECT_EQ(fs::status(was).permissions() & fs::perms::all, fs::perms::owner_all);
    fs::create_directories(was / "a" / "b");
    std::ofstream(was / "a" / "c") << "x";
    one.empty();
    EXPECT_TRUE(fs::is_empty(was));
    std::ofstream(was / "d") << "x";
  }
  EXPECT_FALSE(fs::exists(was));
}

}  // namespace
}  // namespace snug
