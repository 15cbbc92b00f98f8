// Tests of text from outside: what is UTF-8, how the rest is shown, and which files are read at all.
#include "snug/core/text.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"

namespace snug {
namespace {

TEST(Utf8, AcceptsWhatIsWellFormedAndNamesTheFirstByteThatIsNot) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(
      is_utf8("Stra\xc3\x9f"
              "e \xe2\x82\xac \xf0\x9f\x93\xa6 \xf4\x8f\xbf\xbf"));
  EXPECT_EQ(find_not_utf8("ab\xe9"
                          "c"),
            2U);                                     // Latin-1
  EXPECT_EQ(find_not_utf8("a\xc3"), 1U);             // cut
  EXPECT_EQ(find_not_utf8("\xe2\x82"), 0U);          // cut
  EXPECT_EQ(find_not_utf8("\xc0\xaf"), 0U);          // overlong
  EXPECT_EQ(find_not_utf8("\xe0\x80\xaf"), 0U);      // overlong
  EXPECT_EQ(find_not_utf8("\xf0\x80\x80\xaf"), 0U);  // overlong
  EXPECT_EQ(find_not_utf8("\xed\xa0\x80"), 0U);      // surrogate
  EXPECT_EQ(find_not_utf8("\xf4\x90\x80\x80"), 0U);  // above U+10FFFF
  EXPECT_EQ(find_not_utf8("\x80"), 0U);              // nothing before it
}

TEST(Utf8, IsRefusedWithTheLine) {
  check_utf8("a\nb\n", "x.csv");
  try {
    check_utf8("a\nb\xff\n", "x.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "x.csv:2: got the byte 0xff; expected text in UTF-8");
  }
  try {
    check_utf8("\x89HDF\r\n\x1a\n\x02", "run.h5");
    ADD_FAILURE() << "taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "run.h5: got an HDF5 file, such as a recording; expected text in UTF-8");
  }
}

TEST(Printable, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(printable("a\nb\tc\rd", 99), "a\\nb\\tc\\rd");
  EXPECT_EQ(printable("\x1b[31mred\x07\x7f", 99), "\\x1b[31mred\\x07\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J",
                      99),
            "\\u009b2J");  // C1: the same as ESC [
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "abc\xe2\x81\xa6",
                      99),
            "\\u202eabc\\u2066");  // writes backwards
  EXPECT_EQ(printable("\xff\xc3", 99), "\\xff\\xc3");
  EXPECT_EQ(printable(std::string("a\0b", 3), 99), "a\\x00b");
  EXPECT_EQ(printable("Stra\xc3\x9f"
                      "e \xf0\x9f\x93\xa6",
                      99),
            "Stra\xc3\x9f"
            "e \xf0\x9f\x93\xa6");
}

TEST(Printable, NamesNeedNoEscape) {
  EXPECT_TRUE(is_printable("BOX 13 \xc3\x9f \\"));
  for (const char* name : {"a\nb", "a\x7f", "\xc2\x9b", "\xe2\x80\xae", "\xe9"}) EXPECT_FALSE(is_printable(name));
}

TEST(Printable, IsCutBetweenCharacters) {
  EXPECT_EQ(printable("abcdef", 6), "abcdef");
  EXPECT_EQ(printable("abcdefg", 6), "abc...");
  EXPECT_EQ(printable("\xc3\x9f\xc3\x9f\xc3\x9f\xc3\x9f\xc3\x9f", 4), "\xc3\x9f...");
  EXPECT_EQ(printable_end("/a/long/way/file.yaml:12", 12), "...e.yaml:12");
  EXPECT_EQ(printable_end("short", 12), "short");
}

TEST(InputError, ShowsHostileTextHarmlesslyAndShortly) {
  const std::string huge(1'000'000, 'x');
  const InputError error("dir/" + huge + "/cell.yaml:12", "key\x1b[2J", "'" + huge + "'", "a number > 0");
  const std::string message = error.what();
  EXPECT_LE(message.size(), kLongestMessage);
  EXPECT_NE(message.find("/cell.yaml:12: key\\x1b[2J: got 'xxx"), std::string::npos) << message;
  EXPECT_TRUE(message.ends_with("; expected a number > 0")) << message;  // what would be right is not lost
  EXPECT_LE(std::string(InputError("f:1", "", "", huge).what()).size(), kLongestMessage);
  EXPECT_EQ(error.key, "key\x1b[2J");  // as it was, for programs
}

TEST(FindNearest, DoesNotMeasureTextsThatAreNoWords) {
  const std::vector<std::string> names(100'000, std::string(100, 'a'));
  EXPECT_EQ(find_nearest(std::string(5'000'000, 'a'), names), "");
}

TEST(ReadFile, TakesRegularFilesOfASensibleSizeOnly) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "snug_read_file_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto message = [](const std::filesystem::path& path, std::size_t most) -> std::string {
    try {
      return "read " + std::to_string(read_file(path, "a text", most).size());
    } catch (const InputError& error) {
      return error.got + "; " + error.expected;
    }
  };
  std::ofstream(folder / "empty");
  std::ofstream(folder / "text") << std::string(2000, 'a');
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(message(folder / "empty", 10), "read 0");
  EXPECT_EQ(message(folder / "text", 2000), "read 2000");
  EXPECT_EQ(message(folder / "text", 1024), "more than 1 kB; a text of at most 1 kB");
  EXPECT_EQ(message(folder / "nothing", 10), "no such file; a text");
  EXPECT_EQ(message(folder, 10), "a folder; a text");
  EXPECT_EQ(message(folder / "pipe", 10), "a pipe; a text");  // at once, although nobody writes
  EXPECT_EQ(message("/dev/zero", 10), "a device; a text");
  // Says that it has no bytes, and has some.
  EXPECT_NE(message("/proc/self/status", 1U << 20U), "read 0");
  EXPECT_THROW((void)read_file("/proc/self/status", "a text", 16), InputError);
  EXPECT_THROW(check_readable(folder / "text", "a text", 1024), InputError);
  check_readable(folder / "text", "a text", 2000);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace snug
