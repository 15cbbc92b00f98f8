// bench: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/bench/bench.hpp"

namespace snug::app {

void add_bench(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("bench", "measure speed and accuracy, beside their targets");
  const auto options = std::make_shared<BenchOptions>();
  verb.add_flag("--json", options->json, "print the figures as JSON");
  verb.add_option("--only", options->only, "only figures whose name starts so, such as s3")->type_name("NAME");
  verb.add_option("figures", options->only, "the same as --only")->type_name("NAME")->excludes("--only");
  verb.add_option("--drops", options->drops, "random drops to run for the figures drops.*; a thousand take minutes")
      ->type_name("N")
      ->check(CLI::Range(4, 1000000))
      ->capture_default_str();
  verb.footer(
      "Examples:\n  snug bench\n  snug bench --json --only s1\n  snug bench camera\n  snug bench --only packing\n  "
      "snug bench --only "
      "identification\n  snug bench piles\n  snug bench heaps.3000\n  snug bench drops --drops 1000");
  verb.callback([options, &action] { action = [options] { return run_bench(*options); }; });
}

}  // namespace snug::app
