// InputLog: every file that is read is told once it is read, with what its bytes are.
#include "snug/core/input_log.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "snug/core/read_file.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug {
namespace {

TEST(InputLog, TellsWhatIsReadWhileItLives) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "a") << "one";
  std::ofstream(folder / "b") << "one";
  std::ofstream(folder / "c") << "two";
  std::map<std::string, std::uint64_t> told;
  (void)read_file(folder / "c", "a text");
  {
    const InputLog log([&](const std::string& path, std::uint64_t hash) { told[path] = hash; });
    (void)read_file(folder / "a", "a text");
    check_readable(folder / "b", "a text", 100);
    (void)read_file("/proc/self/status", "a text");
    EXPECT_THROW((void)read_file(folder / "none", "a text"), std::runtime_error);
  }
  (void)read_file(folder / "c", "a text");
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[(folder / "a").string()], told[(folder / "b").string()]) << "the same bytes";
  EXPECT_EQ(told[(folder / "a").string()], hash_of_file(folder / "b"));
  EXPECT_NE(hash_of_file(folder / "a"), hash_of_file(folder / "c"));
  EXPECT_EQ(hash_of_file(folder / "none"), 0U);
}

}  // namespace
}  // namespace snug
