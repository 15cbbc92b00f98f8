// identify release: loads recorded releases, fits or evaluates a cup, prints numbers and what is missed.
#include <fmt/format.h>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/identification/fit_text.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {
namespace {

struct IdentifyReleaseOptions : IdentifyOptions {
  std::vector<std::string> inputs;
  bool evaluate = false;  ///< only what the cup of the scenario predicts
};

int run_identify_release(const IdentifyReleaseOptions& options) {
  const std::string scenario = find_scenario(options.scenario.value_or("box-demonstrator"));
  const model::CupParams cup = model::load_scenario(scenario).cup;
  if (options.evaluate && options.output)
    throw InputError("command line", "--output", "with --evaluate", "nothing to write: --evaluate fits nothing");
  NamedFiles inputs = name_all("the input", options.inputs);
  add_file(inputs, "--scenario", options.scenario);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  std::vector<identification::RecordedRelease> releases;
  for (const std::string& input : options.inputs)
    for (identification::RecordedRelease& release : identification::load_recorded_releases(input))
      releases.push_back(std::move(release));
  if (options.evaluate) {
    const identification::ReleaseErrors errors = identification::evaluate_release(releases, cup);
    print(options.json ? format_json(errors) : format_text(errors, "the scenario's cup"));
    return kSuccess;
  }
  const identification::CupReleaseFit fit = identification::identify_release(releases, cup);
  if (output)
    write_file(std::move(*output),
               identification::format_release_block(
                   fit, fmt::format("Release from {} ({} recordings; {:.2f} mm rms, {:.2f} mm on masses left out)",
                                    file_name(options.inputs.front()), releases.size(), 1e3 * fit.errors.rms,
                                    1e3 * fit.held_back.rms)));
  print(options.json ? format_json(fit) : format_text(fit));
  return kSuccess;
}

constexpr const char* kReleaseHelp =
    R"(Each recording: a box at rest under a vertical cup, from the moment at which the vacuum is switched off (blow-off on).
Columns mass_kg, rep, t_s, E_z_m (gripper), B_z_m (box), and S_z_m (lip) if it was tracked; further ones are ignored.
Three masses or more. Each mass in turn is left out and predicted; standard errors are the jackknife over masses.
The model: docs/theory/cup.md, section 6. Units: docs/scenario.md, cup.
Examples:
  snug identify release scenarios/examples/releases.csv --json
  snug identify release scenarios/examples/releases.csv -o cup.yaml
  snug identify release scenarios/examples/releases.csv --evaluate)";

}  // namespace

void add_identify_release(const Verb& verb) {
  const Verb part = verb.part("release", "estimate how the cup lets go from recorded releases", kReleaseHelp);
  IdentifyReleaseOptions& options = part.runs(run_identify_release);
  part.option("recordings", options.inputs, "FILE.csv", "recorded releases").required();
  part.flag("--evaluate", options.evaluate, "fit nothing, only report what the cup predicts");
  part.option("--scenario", options.scenario, "SCENARIO.yaml",
              "scenario with the cup to evaluate, or the first guess (default: scenarios/box-demonstrator.yaml)");
  add_identify_result(part, options);
}

}  // namespace snug::app
