// keys: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/keys/keys.hpp"

namespace snug::app {
namespace {

constexpr const char* kKeysExamples = R"(Examples:
  snug keys keys                         # of a served cell and of one controller
  snug keys keys --add camera            # of one more
  snug serve scenarios/box-demonstrator.yaml --click tcp://0.0.0.0:5555 --keys keys
  snug control program.csv --click tcp://127.0.0.1:5555 --keys keys/controller.key_secret     # elsewhere: its address
The folder of another machine needs server.key and its own NAME.key_secret, never server.key_secret. A controller is shut
out by removing its NAME.key and starting the served cell again.)";

}  // namespace

void add_keys(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("keys", "make the keys by which a served cell and its controllers know each other");
  const auto options = std::make_shared<KeysOptions>();
  verb.add_option("folder", options->folder, "where they go; made when it is not there")->required()->type_name("DIR");
  verb.add_option("--add", options->name, "a pair for one more controller or observer")->type_name("NAME");
  verb.footer(kKeysExamples);
  verb.callback([options, &action] { action = [options] { return run_keys(*options); }; });
}

}  // namespace snug::app
