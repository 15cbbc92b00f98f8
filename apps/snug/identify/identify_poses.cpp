// identify poses: fits or evaluates the law of a cup on wrenches in many poses, prints numbers and what is missed.
#include <fmt/format.h>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/write_file.hpp"
#include "snug/identification/fit_text.hpp"

namespace snug::app {
namespace {

struct IdentifyPosesOptions {
  std::string input;
  std::optional<std::string> cup;     ///< the law that is evaluated
  std::optional<std::string> output;  ///< the law found
  bool evaluate = false;              ///< fit nothing
  bool json = false;
};

int run_identify_poses(const IdentifyPosesOptions& options) {
  NamedFiles inputs = name_all("the input", {options.input});
  add_file(inputs, "--cup", options.cup);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  const identification::CupPoses poses = identification::load_cup_poses(options.input);
  if (options.evaluate) {
    const identification::PoseErrors errors =
        identification::evaluate_pose_law(poses, identification::load_pose_law(find_shipped(*options.cup)));
    print(options.json ? format_json(errors) : format_text(errors, "the law of --cup"));
    return kSuccess;
  }
  const identification::PoseFit fit = identification::fit_pose_law(poses);
  if (output)
    write_file(std::move(*output),
               identification::format_pose_law(
                   fit, fmt::format("Law from {} ({} poses; held back {:.3f}, linear {:.3f} standard deviations): {}",
                                    file_name(options.input), poses.poses.size(), fit.held_back.normalised,
                                    fit.held_back.linear, verdict_of(fit.held_back))));
  print(options.json ? format_json(fit) : format_text(fit));
  return kSuccess;
}

constexpr const char* kPosesHelp =
    R"(For cups of another make: a robot deforms the cup, a sensor reads the wrench. The law is the gradient of one potential, so it is passive;
lateral and bending stiffness change with compression. Each fifth pose in turn is predicted from the others, beside a linear
fit. If more than half a standard deviation of a component remains, poses reports that the law does not explain the data.
Columns x_mm, y_mm, z_mm, qw .. qz, fx_N .. fz_N, tx_Nmm .. tz_Nmm: docs/formats.md, cup poses; theory: docs/theory/cup.md, section 8.
Examples:
  snug identify poses scenarios/examples/cup-poses.csv --json
  snug identify poses scenarios/examples/cup-poses.csv -o law.yaml
  snug identify poses scenarios/examples/cup-poses.csv --cup scenarios/cups/other-make.yaml --evaluate)";

}  // namespace

void add_identify_poses(const Verb& verb) {
  const Verb part = verb.part("poses", "estimate the law of a cup from wrenches in many poses", kPosesHelp);
  IdentifyPosesOptions& options = part.runs(run_identify_poses);
  part.option("poses", options.input, "FILE.csv", "poses and wrenches").required();
  const OptionRow cup = part.option("--cup", options.cup, "CUP.yaml", "law to evaluate");
  const OptionRow evaluate =
      part.flag("--evaluate", options.evaluate, "fit nothing, only report what the law of --cup predicts");
  cup.needs(evaluate);
  evaluate.needs(cup);
  part.option("-o,--output", options.output, "FILE.yaml", "write the law that was found").excludes(evaluate);
  add_json(part, options.json);
}

}  // namespace snug::app
