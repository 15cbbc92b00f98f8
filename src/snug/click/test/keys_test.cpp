// Keys as files: what is made is read again, what is wrong is refused and nothing is written over.
#include "snug/click/keys.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::click {
namespace {

namespace fs = std::filesystem;

using snug::test::ScratchFolder;

class Keys : public ::testing::Test {
 protected:
  void make() {
    for (const char* name : {"server", "controller"}) make_keys(folder_, name);
  }
  void write(const fs::path& path, const std::string& text) {
    std::ofstream(path) << text;
    ::chmod(path.c_str(), 0600);
  }
  ScratchFolder scratch_;
  fs::path folder_ = scratch_.path() / "keys";
};

TEST_F(Keys, AreReadAsTheyWereMade) {
  make();
  const ServerKeys server = load_server_keys(folder_);
  const ClientKeys client = load_client_keys(folder_);
  EXPECT_EQ(client.server_public_key, server.own.public_key);
  EXPECT_EQ(server.allowed, std::vector<std::string>{client.own.public_key});
  EXPECT_NE(server.own, client.own);
}

TEST_F(Keys, SecretsAreForTheirOwnerAlone) {
  make();
  struct stat status = {};
  ASSERT_EQ(::stat((folder_ / "server.key_secret").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  ASSERT_EQ(::stat(folder_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
  ::chmod((folder_ / "server.key_secret").c_str(), 0644);
  EXPECT_THROW((void)load_server_keys(folder_), InputError);
}

TEST_F(Keys, AreNeverWrittenOver) {
  make();
  const std::string before = read_file(folder_ / "server.key_secret", "");
  EXPECT_THROW(make_keys(folder_, "server"), InputError);
  EXPECT_EQ(read_file(folder_ / "server.key_secret", ""), before);
  fs::create_symlink(scratch_.path() / "elsewhere", folder_ / "camera.key_secret");
  EXPECT_THROW(make_keys(folder_, "camera"), InputError);
  EXPECT_FALSE(fs::exists(scratch_.path() / "elsewhere"));
}

TEST_F(Keys, NamesThatLeadElsewhereAreRefused) {
  for (const char* name : {"", "../x", "a/b", ".", "a b", "x\n"})
    EXPECT_THROW(make_keys(folder_, name), InputError) << name;
}

TEST_F(Keys, OneOfSeveralIsNamedByItsFile) {
  make();
  make_keys(folder_, "camera");
  EXPECT_THROW((void)load_client_keys(folder_), InputError);
  EXPECT_EQ(load_server_keys(folder_).allowed.size(), 2U);
  const ClientKeys camera = load_client_keys(folder_ / "camera.key_secret");
  EXPECT_NE(camera.own, load_client_keys(folder_ / "controller.key_secret").own);
}

TEST_F(Keys, FilesThatAreNoKeysAreRefused) {
  make();
  const fs::path secret = folder_ / "controller.key_secret";
  const std::string right = read_file(secret, "");
  const std::string other = read_file(folder_ / "server.key_secret", "");
  const auto key = [](const std::string& text, const char* name) { return text.substr(text.find(name) + 14, 40); };
  std::string mixed = right;
  mixed.replace(mixed.find("secret-key") + 14, 40, key(other, "secret-key"));
  std::string odd = right;
  odd[odd.find("secret-key") + 20] = '\\';
  for (const std::string& text : {std::string(), std::string("curve\n"), right.substr(0, right.size() - 10), mixed, odd,
                                  std::string(100, '\0'), "secret-key = \"\"\npublic-key = \"\"\n" + right}) {
    write(secret, text);
    EXPECT_THROW((void)load_client_keys(folder_), InputError) << text;
  }
  write(secret, right);
  EXPECT_NO_THROW((void)load_client_keys(folder_));
}

TEST_F(Keys, FoldersThatLackThemAreRefused) {
  EXPECT_THROW((void)load_server_keys(folder_), InputError);
  EXPECT_THROW((void)load_client_keys(folder_), InputError);
  make_keys(folder_, "server");
  EXPECT_THROW((void)load_server_keys(folder_), InputError);  // nobody may come
}

}  // namespace
}  // namespace snug::click
