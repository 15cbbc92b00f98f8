// Outputs: no output is an input or another output, under whatever name; a standard output that fails is said.
#include "snug/commands/outputs.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/core/temporary_folder.hpp"

namespace snug::commands {
namespace {

namespace fs = std::filesystem;

std::string complaint_of(const NamedFiles& inputs, const NamedFiles& outputs) {
  try {
    expect_distinct(inputs, outputs);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ExpectDistinct, KnowsAFileByOtherNames) {
  const TemporaryFolder folder("snug-outputs");
  const fs::path file = folder.path() / "run.h5", link = folder.path() / "link.h5";
  std::ofstream(file) << "x";
  fs::create_symlink(file, link);
  EXPECT_EQ(complaint_of({{"the recording", file}}, {{"-o", folder.path() / "other.h5"}}), "");
  EXPECT_NE(complaint_of({{"the recording", file}}, {{"-o", link}}).find("the same file as the recording"),
            std::string::npos);
  EXPECT_NE(complaint_of({{"the recording", file}}, {{"-o", folder.path() / "." / "run.h5"}}), "");
}

TEST(ExpectDistinct, RefusesTwoOutputsThatAreOneAndDraftsThatAreInputs) {
  const TemporaryFolder folder("snug-outputs");
  const fs::path one = folder.path() / "a.csv", same = folder.path() / "b" / ".." / "a.csv";
  EXPECT_NE(complaint_of({}, {{"-o", one}, {"--csv", same}}).find("'"), std::string::npos) << "neither is there yet";
  std::ofstream(draft_of(one)) << "x";
  EXPECT_NE(
      complaint_of({{"the input", draft_of(one)}}, {{"-o", one}}).find("whose draft is the same file as the input"),
      std::string::npos);
}

TEST(MakeFolder, SaysWhyNothingCanBePutThere) {
  const TemporaryFolder folder("snug-outputs");
  make_folder("--dir", folder.path() / "new" / "deep");
  EXPECT_TRUE(fs::is_directory(folder.path() / "new" / "deep"));
  std::ofstream(folder.path() / "file") << "x";
  EXPECT_THROW(make_folder("--dir", folder.path() / "file"), InputError);
  EXPECT_THROW(make_folder("--dir", folder.path() / "file" / "in"), InputError);
}

TEST(PrintOrWrite, WritesTheFileThatWasGiven) {
  const TemporaryFolder folder("snug-outputs");
  print_or_write("text\n", reserve(NamedFiles{}, (folder.path() / "out.txt").string()));
  std::ifstream file(folder.path() / "out.txt");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "text\n");
}

TEST(StandardOutput, ThatIsFullIsSaidOnce) {
  const auto run = [](bool flushes_at_once) {
    if (std::freopen("/dev/full", "w", stdout) == nullptr) std::exit(9);
    try {
      if (flushes_at_once) print_now("x");
      print("x");
    } catch (const OutputError& error) {
      std::fprintf(stderr, "thrown: %s\n", error.what());
    }
    std::exit(flush_stdout() ? 0 : 3);
  };
  EXPECT_EXIT(run(false), testing::ExitedWithCode(3), "failed: .*standard output");
  EXPECT_EXIT(run(true), testing::ExitedWithCode(3), "^thrown: [^\n]*\n$");
}

}  // namespace
}  // namespace snug::commands
