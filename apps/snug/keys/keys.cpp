// keys: makes the keys by which a served cell and its controllers know each other.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/click/keys.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

struct KeysOptions {
  std::string folder;
  std::optional<std::string> name;  ///< one more that may drive; absent: the served cell's and a controller's
};

constexpr const char* kController = "controller";

int run_keys(const KeysOptions& options) {
  const std::filesystem::path folder = options.folder;
  if (options.name) {
    if (!click::has_keys(folder, click::kServerName)) {
      throw InputError(folder.string(), "", "no key of 'server'", "a folder that `snug keys DIR` has made");
    }
    click::make_keys(folder, *options.name);
    print(
        fmt::format("{0}/{1}.key         may drive what is served with --keys {0}\n{0}/{1}.key_secret  for {1} alone, "
                    "with {0}/server.key\n",
                    options.folder, *options.name));
    return kSuccess;
  }
  for (const char* name : {click::kServerName, kController}) {
    if (!click::has_keys(folder, name)) continue;
    throw InputError(folder.string(), "", fmt::format("a key of '{}' already", name),
                     "a new folder, or --add NAME for one more controller");
  }
  for (const char* name : {click::kServerName, kController}) click::make_keys(folder, name);
  print(
      fmt::format("{0}/server.key_secret      for the served cell alone\n"
                  "{0}/controller.key_secret  for the controller, with {0}/server.key\n"
                  "{0}/controller.key         may drive what is served with --keys {0}\n",
                  options.folder));
  return kSuccess;
}

constexpr const char* kKeysExamples = R"(Examples:
  snug keys keys                         # of a served cell and of one controller
  snug keys keys --add camera            # of one more
  snug serve scenarios/box-demonstrator.yaml --click tcp://0.0.0.0:5555 --keys keys
  snug control program.csv --click tcp://127.0.0.1:5555 --keys keys/controller.key_secret     # elsewhere: its address
Another machine needs a folder with server.key and its own NAME.key_secret, never server.key_secret. To exclude a controller,
remove its NAME.key and start the served cell again.)";

}  // namespace

void add_keys(CLI::App& app, Action& action) {
  const Verb verb(app, action, "keys", "make the keys with which a served cell and its controllers identify each other",
                  kKeysExamples);
  KeysOptions& options = verb.runs(run_keys);
  verb.option("folder", options.folder, "DIR", "folder to write; created if missing").required();
  verb.option("--add", options.name, "NAME", "add a pair for one more controller or observer");
}

}  // namespace snug::app
