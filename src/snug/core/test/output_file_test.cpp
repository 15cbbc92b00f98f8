// Files written whole: what was there stays until the new one is whole, whatever happens; one writer at a time.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <thread>

#include "snug/core/csv_cell.hpp"
#include "snug/core/file_lock.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/core/write_file.hpp"

namespace snug {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;
using Names = std::set<std::string>;

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void put(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

mode_t mode_of(const fs::path& path) {
  struct stat status = {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_mode & 07777U : 0U;
}

/// What the file at `path` is refused for, or "".
std::string complaint(const fs::path& path) {
  try {
    const OutputFile file(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// Runs `work` in a process of its own; what it ended with, as waitpid tells it.
template <class Work>
int status_of_child(Work work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(OutputFile, LeavesWhatWasThereUntilItIsPublished) {
  const ScratchFolder folder;
  put(folder / "a", "old");
  {
    OutputFile file(folder / "a");
    EXPECT_TRUE(file.replaces_file());
    file.write("new");
    EXPECT_EQ(content_of(folder / "a"), "old");
    file.publish();
    EXPECT_EQ(content_of(folder / "a"), "new");
  }
  EXPECT_EQ(content_of(folder / "a"), "new");
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST(OutputFile, LeavesNothingWhenItIsNotPublished) {
  const ScratchFolder folder;
  put(folder / "a", "old");
  for (const char* name : {"a", "b"}) {
    OutputFile file(folder / name);
    file.write(std::string(100'000, 'x'));
  }
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST(OutputFile, KeepsTheModeOfTheFileItReplaces) {
  const ScratchFolder folder;
  for (const mode_t mode : {0600U, 0640U, 0664U, 0755U}) {
    put(folder / "a", "old");
    ASSERT_EQ(::chmod((folder / "a").c_str(), mode), 0);
    OutputFile file(folder / "a");
    EXPECT_EQ(mode_of(file.location()), mode) << "what is private is so from the first byte on";
    file.publish();
    EXPECT_EQ(mode_of(folder / "a"), mode);
  }
  const mode_t mask = ::umask(027);
  write_file(folder / "new", "");
  ::umask(mask);
  EXPECT_EQ(mode_of(folder / "new"), 0640U);
}

TEST(OutputFile, FollowsSymbolicLinksAndLeavesThem) {
  const ScratchFolder folder;
  fs::create_directory(folder / "far");
  put(folder / "far/a", "old");
  fs::create_symlink("far/a", folder / "first");
  fs::create_symlink("first", folder / "second");
  write_file(folder / "second", "new");
  EXPECT_EQ(content_of(folder / "far/a"), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "first") && fs::is_symlink(folder / "second"));
  fs::create_symlink(folder / "far/b", folder / "dangling");
  write_file(folder / "dangling", "made");
  EXPECT_EQ(content_of(folder / "far/b"), "made");
  fs::create_symlink("circle", folder / "circle");
  EXPECT_TRUE(has(complaint(folder / "circle"), "symbolic links"));
}

TEST(OutputFile, RefusesPlacesThatCannotBeWrittenAndLeavesNothing) {
  const ScratchFolder folder;
  fs::create_directory(folder / "folder");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(has(complaint(folder / "no/such/a"), "No such file"));
  EXPECT_TRUE(has(complaint(folder / "folder"), "not a regular file"));
  EXPECT_TRUE(has(complaint(folder / "pipe"), "not a regular file"));
  EXPECT_TRUE(has(complaint("/dev/full"), "not a regular file"));
  EXPECT_TRUE(has(complaint(folder / "a.snug-part"), "ends in"));
  EXPECT_NE(complaint(""), "");
  EXPECT_NE(complaint(folder / "new/"), "");
  EXPECT_NE(complaint(folder / std::string(300, 'x')), "");
  EXPECT_EQ(folder.names(), (Names{"folder", "pipe"}));
}

TEST(OutputFile, RefusesAWriteProtectedFile) {
  if (::geteuid() == 0 && ::access("/usr/bin/setpriv", X_OK) != 0) GTEST_SKIP() << "root may write everything";
  const ScratchFolder folder;
  put(folder / "a", "old");
  ASSERT_EQ(::chmod((folder / "a").c_str(), 0444), 0);
  ASSERT_EQ(::chmod((folder / "").c_str(), 0777), 0);
  const int status = status_of_child([&] {
    if (::geteuid() == 0 && ::setuid(65534) != 0) return 2;
    return has(complaint(folder / "a"), "Permission denied") ? 7 : 1;
  });
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(content_of(folder / "a"), "old");
}

TEST(OutputFile, RefusesASecondWriterOfTheSameFileUnderAnyName) {
  const ScratchFolder folder;
  fs::create_symlink("a", folder / "link");
  OutputFile first(folder / "a");
  for (const char* name : {"a", "link", "./a"}) EXPECT_TRUE(has(complaint(folder / name), "another run")) << name;
  EXPECT_EQ(WEXITSTATUS(status_of_child([&] { return has(complaint(folder / "a"), "another run") ? 7 : 1; })), 7);
  first.write("first");
  first.publish();
  EXPECT_TRUE(has(complaint(folder / "a"), "another run")) << "it may go on writing";
  EXPECT_EQ(content_of(folder / "a"), "first");
  first = OutputFile(folder / "b");
  EXPECT_EQ(complaint(folder / "a"), "");
  EXPECT_EQ(folder.names(), (Names{"a", "b.snug-part", "link"}));
}

TEST(OutputFile, HasExactlyOneWriterHoweverManyCome) {
  const ScratchFolder folder;
  constexpr int kRounds = 40, kWriters = 8;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<pid_t> children;
    int gate[2], done[2];
    ASSERT_EQ(::pipe(gate) + ::pipe(done), 0);
    for (int i = 0; i < kWriters; ++i) {
      children.push_back(::fork());
      if (children.back() != 0) continue;
      char byte = 0;
      ::close(gate[1]), ::close(done[1]);
      (void)!::read(gate[0], &byte, 1);  // all at once
      int code = 1;
      try {
        OutputFile file(folder / "a");
        file.write(std::to_string(i));
        (void)!::read(done[0], &byte, 1);  // until the others had their try
        file.publish();
        code = 7;
      } catch (const InputError&) {
      }
      ::_exit(code);
    }
    ::close(gate[0]), ::close(done[0]);
    ::close(gate[1]);
    int writers = 0;
    for (int others = 0; others < kWriters - 1; ++others) {
      int status = 0;
      ::waitpid(-1, &status, 0);
      writers += WEXITSTATUS(status) == 7 ? 1 : 0;
    }
    ::close(done[1]);
    int status = 0;
    ::waitpid(-1, &status, 0);
    writers += WEXITSTATUS(status) == 7 ? 1 : 0;
    EXPECT_EQ(writers, 1);
    EXPECT_EQ(folder.names(), Names{"a"});
  }
}

TEST(OutputFile, TakesOverTheDraftOfAKilledProcess) {
  const ScratchFolder folder;
  put(folder / "a", "old");
  const int status = status_of_child([&] {
    OutputFile file(folder / "a");
    file.write(std::string(100'000, 'x'));
    return ::raise(SIGKILL);
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(content_of(folder / "a"), "old");
  write_file(folder / "a", "new");
  EXPECT_EQ(content_of(folder / "a"), "new");
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST(OutputFile, DoesNotWriteThroughALinkInThePlaceOfItsDraft) {
  const ScratchFolder folder;
  put(folder / "precious", "kept");
  fs::create_symlink("precious", folder / "a.snug-part");
  EXPECT_NE(complaint(folder / "a"), "");
  fs::remove(folder / "a.snug-part");
  fs::create_hard_link(folder / "precious", folder / "a.snug-part");
  write_file(folder / "a", "new");
  EXPECT_EQ(content_of(folder / "precious"), "kept");
  EXPECT_EQ(folder.names(), (Names{"a", "precious"}));
}

TEST(OutputFile, ReplacesWhatItWroteInOneStepBeforeAndAfterItIsPublished) {
  const ScratchFolder folder;
  const fs::path path = folder / "list";
  OutputFile file(path);
  for (int i = 0; i < 100; ++i) {
    const std::string text(static_cast<std::size_t>(1 + 37 * i), static_cast<char>('a' + i % 26));
    file.replace(text);
    EXPECT_EQ(content_of(file.location()), text);
    EXPECT_THROW(OutputFile{path}, InputError) << "it is still written";
    if (i == 50) file.publish();
  }
  EXPECT_EQ(file.location(), path);
  file.replace("");
  EXPECT_EQ(content_of(path), "");
  file.replace("head\n");
  file.write("tail\n");
  file = OutputFile(folder / "other");
  EXPECT_EQ(content_of(path), "head\ntail\n");
  EXPECT_EQ(folder.names(), (Names{"list", "other.snug-part"}));
}

TEST(OutputFile, ReplacingKeepsTheModeAndWhatIsThereUntilItIsPublished) {
  const ScratchFolder folder;
  const fs::path path = folder / "list";
  std::ofstream(path) << "old";
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  OutputFile file(path);
  file.replace("new");
  EXPECT_EQ(content_of(path), "old");
  file.publish();
  file.replace("newer");
  EXPECT_EQ(content_of(path), "newer");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

/// Killed a hundred times, at any instant: one of the texts is there, whole.
TEST(OutputFile, OneThatIsKilledWhileItReplacesLeavesAWholeFile) {
  const ScratchFolder folder;
  const fs::path path = folder / "list";
  for (int run = 0; run < 100; ++run) {
    const pid_t child = ::fork();
    if (child == 0) {
      OutputFile file(path);
      file.replace(std::string(100'000, 'a'));
      if (!file.replaces_file()) file.publish();
      for (char c = 'b';; c = c == 'z' ? 'a' : static_cast<char>(c + 1)) file.replace(std::string(100'000, c));
    }
    ::usleep(static_cast<useconds_t>(100 * (run % 50)));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    for (const fs::path& left : {path, draft_of(path)}) {
      const std::string text = content_of(left);
      if (text.empty()) continue;  // before its first text
      EXPECT_EQ(text, std::string(100'000, text.front())) << left;
    }
    if (run % 2 == 0) fs::remove(path);
  }
}

TEST(OutputFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const ScratchFolder folder;
  put(folder / "a", "old");
  const int status = status_of_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10'000, 10'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    for (const std::size_t size : {10'001U, 1'000'000U}) {  // fails when it is flushed; when it is written
      try {
        write_file(folder / "a", std::string(size, 'x'));
        return 1;
      } catch (const OutputError& error) {
        if (!has(error.what(), "File too large") || !has(error.what(), "/a: ")) return 2;
      }
    }
    return 7;
  });
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST(OutputFile, RemovesDraftsWhenTheProgramIsInterrupted) {
  const ScratchFolder folder;
  put(folder / "a", "old");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = status_of_child([&] {
      remove_drafts_when_interrupted();
      OutputFile replacing(folder / "a"), fresh(folder / "b"), published(folder / "c");
      published.publish();
      OutputFile moved = std::move(fresh);
      ::raise(signal);
      return 1;
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
    EXPECT_EQ(folder.names(), (Names{"a", "c"}));
  }
  const int status = status_of_child([] {
    ::signal(SIGINT, SIG_IGN);
    remove_drafts_when_interrupted();
    ::raise(SIGINT);
    return 7;
  });
  EXPECT_EQ(WEXITSTATUS(status), 7) << "a program that was started to ignore the signal does";
}

TEST(OutputFile, RemovesDraftsWheneverTheInterruptComes) {
  const ScratchFolder folder;
  for (int round = 0; round < 120; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      remove_drafts_when_interrupted();
      if (round % 2 == 1) std::thread([] { ::pause(); }).detach();  // takes signals that the first thread holds back
      for (int i = 0;; ++i) {
        OutputFile file(folder / "a");
        if (i % 2 == 0) file.publish();
      }
    }
    while (!fs::exists(folder / "a")) ::usleep(100);
    ::usleep(static_cast<useconds_t>(37 * (round / 2)));
    ::kill(child, SIGTERM);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    ASSERT_EQ(folder.names(), Names{"a"}) << "round " << round;
    fs::remove(folder / "a");
  }
}

TEST(OutputFile, SaysSoWhenItsDraftOrFolderIsGone) {
  const ScratchFolder folder;
  fs::create_directory(folder / "sub");
  OutputFile file(folder / "sub/a");
  file.write("text");
  fs::remove_all(folder / "sub");
  EXPECT_THROW(file.publish(), OutputError);
  OutputFile stolen(folder / "b");
  fs::remove(stolen.location());
  put(stolen.location(), "of somebody else");
  EXPECT_THROW(stolen.publish(), OutputError);
  EXPECT_FALSE(fs::exists(folder / "b"));
}

TEST(FileLock, SharedLocksGoTogetherAndExclusiveOnesDoNot) {
  const ScratchFolder folder;
  put(folder / "a", "");
  const auto open = [&] { return ::open((folder / "a").c_str(), O_RDWR | O_CLOEXEC); };
  const int a = open(), b = open(), c = open();
  EXPECT_TRUE(try_lock(a, LockByte::Commit, LockKind::Shared));
  EXPECT_TRUE(try_lock(b, LockByte::Commit, LockKind::Shared));
  EXPECT_FALSE(try_lock(c, LockByte::Commit, LockKind::Exclusive));
  EXPECT_TRUE(is_locked(c, LockByte::Commit));
  EXPECT_FALSE(is_locked(c, LockByte::Writer));
  EXPECT_TRUE(try_lock(c, LockByte::Writer, LockKind::Exclusive));
  unlock(a, LockByte::Commit);
  ::close(b);
  EXPECT_TRUE(try_lock(c, LockByte::Commit, LockKind::Exclusive));
  EXPECT_FALSE(is_locked(c, LockByte::Commit)) << "its own";
  ::close(a), ::close(c);
}

TEST(CsvCell, TakesFromNamesWhatASpreadsheetWouldRunAndNothingElse) {
  for (const char* name : {"BOX001", "order 7", "a=b", "x-1", "Größe", "a@b", "'quoted'", "1e5"}) {
    EXPECT_EQ(csv_cell(name), name);
  }
  EXPECT_EQ(csv_cell("=cmd|' /C calc'!A0"), "_cmd|' /C calc'!A0");
  EXPECT_EQ(csv_cell("+1"), "_1");
  EXPECT_EQ(csv_cell("-1"), "_1");
  EXPECT_EQ(csv_cell("@SUM(A1)"), "_SUM(A1)");
  EXPECT_EQ(csv_cell("\t=1"), "_=1");
  EXPECT_EQ(csv_cell("\r=1"), "_=1");
  EXPECT_EQ(csv_cell(" =1"), "_=1");
  EXPECT_EQ(csv_cell("a;=1,\"b\"\nc"), "a_=1__b__c");
  EXPECT_EQ(csv_cell("\uFF1D1"), "_1");
  EXPECT_EQ(csv_cell(""), "");
}

}  // namespace
}  // namespace snug
