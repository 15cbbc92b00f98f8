// keys: makes the keys by which a served cell and its controllers know each other.
#include "apps/snug/keys/keys.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/click/keys.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

constexpr const char* kController = "controller";

}  // namespace

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

}  // namespace snug::app
