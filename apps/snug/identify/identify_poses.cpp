// identify poses: fits or evaluates the law of a cup on wrenches in many poses, prints numbers and what is missed.
#include <fmt/format.h>
#include <fmt/printf.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/write_file.hpp"
#include "snug/identification/cup_poses.hpp"

namespace snug::app {
namespace {

struct IdentifyPosesOptions {
  std::string input;
  std::optional<std::string> cup;     ///< the law that is evaluated
  std::optional<std::string> output;  ///< the law found
  bool evaluate = false;              ///< fit nothing
  bool json = false;
};

using identification::PoseErrors;
using nlohmann::ordered_json;

std::string verdict_of(const PoseErrors& errors) {
  const std::vector<std::string> names = identification::find_unexplained(errors);
  if (names.empty()) return "this law explains these data";
  return fmt::format("this law does not explain these data: {}", fmt::join(names, ", "));
}

ordered_json pose_json(const std::vector<identification::Parameter>& parameters, const PoseErrors& errors) {
  ordered_json json = {{"parameters", ordered_json::array()},
                       {"normalised_error", errors.normalised},
                       {"linear_error", errors.linear},
                       {"components", ordered_json::object()},
                       {"is_explained", identification::find_unexplained(errors).empty()},
                       {"verdict", verdict_of(errors)}};
  for (const identification::Parameter& parameter : parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"value", parameter.value},
                                  {"standard_error", parameter.standard_error},
                                  {"unit", parameter.unit},
                                  {"verdict", name_of(parameter.verdict)}});
  Eigen::Index i = 0;
  for (const char* name : {"fx", "fy", "fz", "tx", "ty", "tz"}) json["components"][name] = errors.components[i++];
  return json;
}

void show_poses(const char* about, const PoseErrors& errors) {
  print(fmt::sprintf("%s: %.3f standard deviations of a component rms; linear fit %.3f\n ", about, errors.normalised,
                     errors.linear));
  Eigen::Index i = 0;
  for (const char* name : {"fx", "fy", "fz", "tx", "ty", "tz"})
    print(fmt::sprintf(" %s %.3f", name, errors.components[i++]));
  print("\n" + verdict_of(errors) + "\n");
}

int run_identify_poses(const IdentifyPosesOptions& options) {
  NamedFiles inputs = name_all("the input", {options.input});
  add_file(inputs, "--cup", options.cup);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  const identification::CupPoses poses = identification::load_cup_poses(options.input);
  if (options.evaluate) {
    const PoseErrors errors =
        identification::evaluate_pose_law(poses, identification::load_pose_law(find_shipped(*options.cup)));
    if (options.json)
      print(pose_json({}, errors).dump(2) + "\n");
    else
      show_poses("the law of --cup", errors);
    return kSuccess;
  }
  const identification::PoseFit fit = identification::fit_pose_law(poses);
  if (output)
    write_file(std::move(*output),
               identification::format_pose_law(
                   fit, fmt::format("Law from {} ({} poses; held back {:.3f}, linear {:.3f} standard deviations): {}",
                                    std::filesystem::path(options.input).filename().string(), poses.poses.size(),
                                    fit.held_back.normalised, fit.held_back.linear, verdict_of(fit.held_back))));
  if (options.json) {
    print(pose_json(fit.parameters, fit.held_back).dump(2) + "\n");
    return kSuccess;
  }
  for (const identification::Parameter& parameter : fit.parameters)
    print(fmt::sprintf("  %-12s %12.6g +- %-9.2g %-7s %s\n", parameter.name.c_str(), parameter.value,
                       parameter.standard_error, parameter.unit.c_str(), name_of(parameter.verdict)));
  show_poses("held back, each fifth pose predicted from the others", fit.held_back);
  return kSuccess;
}

constexpr const char* kPosesHelp =
    R"(Another make of cup: a robot deforms it, a sensor reads the wrench. The law is the gradient of one potential, so it is passive;
lateral and bending stiffness change with compression. Each fifth pose in turn is predicted from the others, beside a linear
fit. Where it leaves more than half a standard deviation of a component it says that it does not explain the data.
Columns x_mm, y_mm, z_mm, qw .. qz, fx_N .. fz_N, tx_Nmm .. tz_Nmm: docs/formats.md, cup poses; theory: docs/theory/cup.md, section 8.
Examples:
  snug identify poses scenarios/examples/cup-poses.csv --json
  snug identify poses scenarios/examples/cup-poses.csv -o law.yaml
  snug identify poses scenarios/examples/cup-poses.csv --cup scenarios/cups/other-make.yaml --evaluate)";

}  // namespace

void add_identify_poses(const Verb& verb) {
  const Verb part = verb.part("poses", "a cup's law from wrenches in many poses", kPosesHelp);
  IdentifyPosesOptions& options = part.runs(run_identify_poses);
  part.option("poses", options.input, "FILE.csv", "poses and wrenches").required();
  const OptionRow cup = part.option("--cup", options.cup, "CUP.yaml", "the law that is evaluated");
  const OptionRow evaluate =
      part.flag("--evaluate", options.evaluate, "fit nothing: only what the law of --cup predicts");
  cup.needs(evaluate);
  evaluate.needs(cup);
  part.option("-o,--output", options.output, "FILE.yaml", "the law found").excludes(evaluate);
  add_json(part, options.json);
}

}  // namespace snug::app
