// Keys: certificates of CurveZMQ as files.
#include "snug/click/keys.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <string_view>

#include "snug/core/descriptor.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"

namespace snug::click {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPublic = ".key";
constexpr const char* kSecret = ".key_secret";
constexpr std::size_t kKeyLength = 40;
constexpr std::size_t kLargestFile = std::size_t{64} << 10U;
constexpr std::size_t kMostKeys = 1000;

[[noreturn]] void refuse(const fs::path& where, const std::string& key, const std::string& got,
                         const std::string& expected) {
  throw InputError(where.string(), key, got, expected);
}

bool is_name(const std::string& name) {
  const auto is_fine = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, is_fine);
}

std::string certificate_of(const std::string& name, const KeyPair& pair, bool is_secret) {
  std::string text = is_secret
                         ? "# CurveZMQ certificate of '" + name + "' with its SECRET key: only its owner may read it\n"
                         : "# CurveZMQ certificate of '" + name + "': its public key\n";
  text += "metadata\ncurve\n    public-key = \"" + pair.public_key + "\"\n";
  if (is_secret) text += "    secret-key = \"" + pair.secret_key + "\"\n";
  return text;
}

/// Never over something that is there, and never readable by others, not even for a moment.
void write_new(const fs::path& path, const std::string& text, mode_t mode) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
  if (!file.is_open()) refuse(path, "", std::strerror(errno), "a file that can be made");
  const bool is_written = ::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (is_written && ::fsync(file.get()) == 0) return;
  const std::string why = std::strerror(errno);
  ::unlink(path.c_str());
  throw OutputError(path.string(), why);
}

/// The value of `key = "..."`.
std::string value_of(const std::string& text, const char* key, const fs::path& path) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view trimmed = trim(line);
    if (!trimmed.starts_with(key)) continue;
    const std::string_view rest = trim(trimmed.substr(std::strlen(key)));
    if (!rest.starts_with('=')) continue;
    std::string_view value = trim(rest.substr(1));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
    std::array<std::uint8_t, 32> bytes{};
    // The decoder takes any character for one of its table: what it would write again is compared.
    std::array<char, kKeyLength + 1> again{};
    const std::string word(value);
    const bool is_key = word.size() == kKeyLength &&
                        std::ranges::all_of(word, [](char c) { return c > ' ' && c < '\x7f'; }) &&
                        zmq_z85_decode(bytes.data(), word.c_str()) != nullptr &&
                        zmq_z85_encode(again.data(), bytes.data(), bytes.size()) != nullptr && word == again.data();
    if (!is_key) refuse(path, key, "", "a key of 40 characters (Z85), as `snug keys` writes it");
    return word;
  }
  refuse(path, key, "nothing", "a certificate of CurveZMQ, as `snug keys` writes it");
}

std::string read_public(const fs::path& path) {
  return value_of(read_file(path, "a public key that `snug keys` makes", kLargestFile), "public-key", path);
}

KeyPair read_secret(const fs::path& path) {
  const std::string text = read_file(path, "a secret key that `snug keys` makes", kLargestFile);
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & 077U) != 0) {
    refuse(path, "", "a secret key that others on this machine can read", "chmod 600, or new keys");
  }
  KeyPair pair{value_of(text, "public-key", path), value_of(text, "secret-key", path)};
  std::array<char, kKeyLength + 1> derived{};
  if (zmq_curve_public(derived.data(), pair.secret_key.c_str()) != 0 || pair.public_key != derived.data()) {
    refuse(path, "public-key", "not that of the secret key", "a pair that `snug keys` makes");
  }
  return pair;
}

/// Names in the folder that have a file of this ending, in order; without the server's.
std::vector<std::string> names_in(const fs::path& folder, const char* ending) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) refuse(folder, "--keys", error.message(), "a folder that `snug keys DIR` makes");
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : entries) {
    if (entry.path().extension() != ending || entry.path().stem() == kServerName) continue;
    if (names.size() == kMostKeys) refuse(folder, "--keys", "more than 1000 keys", "at most as many");
    names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

bool has_keys(const fs::path& folder, const std::string& name) {
  std::error_code error;
  return fs::exists(fs::symlink_status(folder / (name + kPublic), error)) ||
         fs::exists(fs::symlink_status(folder / (name + kSecret), error));
}

void make_keys(const fs::path& folder, const std::string& name) {
  if (!is_name(name)) refuse("command line", "--add", "'" + name + "'", "letters, digits, - and _");
  std::error_code error;
  if (!fs::exists(folder, error) && ::mkdir(folder.c_str(), 0700) != 0) {
    refuse(folder, "", std::strerror(errno), "a folder that can be made");
  }
  if (has_keys(folder, name))
    refuse(folder, "", "a key of '" + name + "' already", "a name without one, or a new folder");
  std::array<char, kKeyLength + 1> public_key{}, secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    throw std::runtime_error(std::string("ZeroMQ makes no keys here: ") + zmq_strerror(errno));
  }
  const KeyPair pair{public_key.data(), secret_key.data()};
  write_new(folder / (name + kSecret), certificate_of(name, pair, true), 0600);
  write_new(folder / (name + kPublic), certificate_of(name, pair, false), 0644);
}

ServerKeys load_server_keys(const fs::path& folder) {
  const std::vector<std::string> names = names_in(folder, kPublic);
  ServerKeys keys;
  keys.own = read_secret(folder / (std::string(kServerName) + kSecret));
  for (const std::string& name : names) keys.allowed.push_back(read_public(folder / (name + kPublic)));
  if (keys.allowed.empty())
    refuse(folder, "--keys", "no public key but the server's", "that of a controller: NAME.key");
  return keys;
}

ClientKeys load_client_keys(const fs::path& place) {
  std::error_code error;
  const bool is_folder = fs::is_directory(place, error);
  fs::path secret = place;
  if (is_folder) {
    const std::vector<std::string> names = names_in(place, kSecret);
    if (names.size() != 1) {
      refuse(place, "--keys",
             names.empty() ? "no secret key" : "secret keys of '" + names[0] + "' and '" + names[1] + "'",
             names.empty() ? "NAME.key_secret beside server.key"
                           : "one of the files, such as " + (place / (names[0] + kSecret)).string());
    }
    secret = place / (names.front() + kSecret);
  }
  const fs::path folder = is_folder ? place : place.parent_path();
  return {read_public(folder / (std::string(kServerName) + kPublic)), read_secret(secret)};
}

std::optional<ClientKeys> find_client_keys(const std::optional<std::string>& place) {
  if (!place) return std::nullopt;
  return load_client_keys(*place);
}

}  // namespace snug::click
