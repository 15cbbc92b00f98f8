// Tests of the folder: what belongs to it is listed, read and written; nothing else is reached.
#include "snug/workspace/folder.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/rng.hpp"

namespace snug::workspace {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOrders =
    "order,article,length_mm,width_mm,height_mm,mass_kg\nmine,A,200,150,100,0.5\nmine,B,180,120,90,0.4\n";

class FolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "snug-workspace-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    top_ = name;
    path_ = top_ / "cells";
    fs::create_directory(path_);
  }
  void TearDown() override { fs::remove_all(top_); }
  static void put(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  [[nodiscard]] static std::string get(const fs::path& path) { return read_file(path, "a file"); }
  [[nodiscard]] static std::string cell() { return get(fs::path(SNUG_SOURCE_DIR) / "scenarios/init/cell.yaml"); }

  fs::path top_, path_;
};

TEST_F(FolderTest, ListsItsOwnFilesByNameAndLeavesOutAllElse) {
  put(path_ / "b.yaml", "x");
  put(path_ / "a.csv", kOrders);
  put(path_ / "run.jsonl", "");
  for (const char* other : {".hidden.yaml", "-o.yaml", "a b.csv", "run.json", "\xff.yaml"}) put(path_ / other, "");
  fs::create_directory(path_ / "folder.yaml");
  put(top_ / "secret.yaml", "secret");
  fs::create_symlink(top_ / "secret.yaml", path_ / "link.yaml");
  ASSERT_EQ(::mkfifo((path_ / "pipe.yaml").c_str(), 0600), 0);
  const std::vector<Entry> expected = {{"a.csv", FileKind::Items, std::string(kOrders).size()},
                                       {"b.yaml", FileKind::Scenario, 1},
                                       {"run.jsonl", FileKind::Log, 0}};
  EXPECT_EQ(Folder(path_).list(), expected);
  EXPECT_EQ(Folder(path_).list(), expected);
}

TEST_F(FolderTest, RefusesNamesThatLeadElsewhere) {
  put(top_ / "secret.yaml", "secret");
  fs::create_directory(path_ / "in");
  put(path_ / "in" / "a.yaml", "secret");
  const Folder folder(path_);
  const std::vector<std::string> names = {"",
                                          ".",
                                          "..",
                                          "../secret.yaml",
                                          "in/a.yaml",
                                          (top_ / "secret.yaml").string(),
                                          std::string("a.yaml\0", 7),
                                          std::string("../secret.yaml\0.csv", 19),
                                          "-o.yaml",
                                          ".a.yaml",
                                          "a.yaml.snug-part",
                                          "a.htm",
                                          "a\n.yaml",
                                          "a\\b.yaml",
                                          "\xc3\xa4.yaml",
                                          std::string(96, 'a') + ".yaml"};
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    EXPECT_THROW((void)folder.read(name), InputError);
    EXPECT_THROW(folder.write(name, kOrders), InputError);
    EXPECT_THROW(folder.remove(name), InputError);
  }
  EXPECT_EQ(kind_of_name(std::string(95, 'a') + ".yaml"), FileKind::Scenario);
  EXPECT_EQ(get(top_ / "secret.yaml"), "secret");
}

TEST_F(FolderTest, RandomNamesNeverMakeAFileOutside) {
  const Folder folder(path_);
  Rng rng(5);
  const std::string letters = "ab./\\-_ \n~%";
  int written = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string name;
    for (int k = static_cast<int>(rng.uniform(0.0, 8.0)); k > 0; --k)
      name += letters[static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(letters.size()) - 1e-9))];
    try {
      folder.write(name + ".csv", kOrders);
      ++written;
      EXPECT_TRUE(fs::is_regular_file(path_ / (name + ".csv")));
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(written, 10);  // not all are refused
  EXPECT_EQ(std::distance(fs::directory_iterator(top_), {}), 1);
  EXPECT_EQ(static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), {})), folder.list().size());
}

TEST_F(FolderTest, FollowsNoLinksPipesOrFolders) {
  put(top_ / "secret.csv", "secret");
  fs::create_symlink(top_ / "secret.csv", path_ / "link.csv");
  fs::create_directory(path_ / "folder.csv");
  ASSERT_EQ(::mkfifo((path_ / "pipe.csv").c_str(), 0600), 0);
  const Folder folder(path_);
  for (const char* name : {"link.csv", "folder.csv", "pipe.csv", "absent.csv"}) {
    SCOPED_TRACE(name);
    EXPECT_THROW((void)folder.read(name), InputError);
    EXPECT_THROW(folder.remove(name), InputError);
    if (std::string(name) != "absent.csv") {
      EXPECT_THROW(folder.write(name, kOrders), InputError);
    }
  }
  EXPECT_EQ(get(top_ / "secret.csv"), "secret");
}

TEST_F(FolderTest, WritesThroughNoDraftThatAStrangerPutThere) {
  put(top_ / "secret", "secret");
  fs::create_symlink(top_ / "secret", path_ / "a.csv.snug-part");
  fs::create_hard_link(top_ / "secret", path_ / "b.csv.snug-part");
  const Folder folder(path_);
  EXPECT_THROW(folder.write("a.csv", kOrders), InputError);
  EXPECT_THROW(folder.write("b.csv", kOrders), InputError);
  EXPECT_EQ(get(top_ / "secret"), "secret");
}

TEST_F(FolderTest, StaysInTheFolderThatWasOpenedWhenItsPathLeadsElsewhere) {
  const Folder folder(path_);
  fs::rename(path_, top_ / "moved");
  fs::create_directory(top_ / "other");
  fs::create_symlink(top_ / "other", path_);
  folder.write("a.csv", kOrders);
  EXPECT_EQ(get(top_ / "moved" / "a.csv"), kOrders);
  EXPECT_TRUE(fs::is_empty(top_ / "other"));
}

TEST_F(FolderTest, WritesWhatTheCommandLineCanReadAndNothingElse) {
  const Folder folder(path_);
  folder.write("cell.yaml", cell());
  folder.write("order.csv", kOrders);
  EXPECT_EQ(folder.read("cell.yaml"), cell());
  const std::string broken = cell() + "sequenzes: []\n";
  try {
    folder.write("cell.yaml", broken);
    ADD_FAILURE() << "a key that there is not";
  } catch (const InputError& error) {
    const auto lines = std::count(broken.begin(), broken.end(), '\n');
    EXPECT_EQ(error.where, "cell.yaml:" + std::to_string(lines));
    EXPECT_NE(error.expected.find("sequences"), std::string::npos) << error.expected;
  }
  try {
    folder.write("order.csv", std::string(kOrders) + "mine,C,-1,1,1,1\n");
    ADD_FAILURE() << "a negative length";
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "order.csv:4");
    EXPECT_EQ(error.key, "length_mm");
  }
  EXPECT_THROW(folder.write("run.jsonl", ""), InputError);
  EXPECT_THROW(folder.write("large.csv", std::string(kLargestUpload + 1, ' ')), InputError);
  EXPECT_EQ(folder.read("cell.yaml"), cell());
  EXPECT_EQ(folder.read("order.csv"), kOrders);
  EXPECT_EQ(folder.list().size(), 2U);
}

TEST_F(FolderTest, TakesOverADraftThatWasLeftButNotOneThatIsHeld) {
  put(path_ / "a.csv.snug-part", std::string(10000, 'x'));
  const Folder folder(path_);
  folder.write("a.csv", kOrders);
  EXPECT_EQ(folder.read("a.csv"), kOrders);
  EXPECT_FALSE(fs::exists(path_ / "a.csv.snug-part"));
  const Descriptor held(::open((path_ / "a.csv.snug-part").c_str(), O_WRONLY | O_CREAT, 0600));
  ASSERT_EQ(::flock(held.get(), LOCK_EX), 0);
  EXPECT_THROW(folder.write("a.csv", kOrders), InputError);
  EXPECT_EQ(folder.read("a.csv"), kOrders);
}

TEST_F(FolderTest, KeepsTheModeOfAFileThatIsReplaced) {
  const Folder folder(path_);
  put(path_ / "a.csv", "");
  fs::permissions(path_ / "a.csv", fs::perms::owner_read | fs::perms::owner_write);
  folder.write("a.csv", kOrders);
  EXPECT_EQ(fs::status(path_ / "a.csv").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  folder.remove("a.csv");
  EXPECT_TRUE(folder.list().empty());
}

TEST_F(FolderTest, TellsWhetherItCanBeWritten) {
  EXPECT_TRUE(Folder(path_).can_be_written());
  const Folder system("/proc/self");  // where not even root makes files
  EXPECT_THROW((void)system.create("a.txt"), OutputError);
  EXPECT_THROW(system.write("a.csv", kOrders), OutputError);
  fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_exec);
  const bool is_root = ::geteuid() == 0;
  EXPECT_EQ(Folder(path_).can_be_written(), is_root);
  fs::permissions(path_, fs::perms::owner_all);
}

TEST_F(FolderTest, IsRefusedWhereThereIsNone) {
  EXPECT_THROW(Folder(path_ / "absent"), InputError);
  put(path_ / "file", "");
  EXPECT_THROW(Folder(path_ / "file"), InputError);
}

}  // namespace
}  // namespace snug::workspace
