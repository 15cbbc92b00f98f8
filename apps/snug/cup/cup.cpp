// cup: asks the cup module, by lines of JSON or by the numbers of a data sheet.
#include <fstream>
#include <iostream>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/estimate_text.hpp"
#include "snug/cup/json_lines.hpp"

namespace snug::app {
namespace {

struct CupOptions {
  std::string input = "-";  ///< file of JSON lines; "-": stdin
};

struct CupEstimateOptions {
  double diameter_mm = 0.0;
  double bellows = 1.5;
  std::string material = "silicone", lip = "plain";
  std::string vacuum = "-60kPa";
  std::optional<double> stroke_mm, mass_max;
  std::optional<std::string> output;
  bool json = false;
};

struct CatalogueOptions {
  bool json = false;
};

constexpr std::size_t kLargestLines = std::size_t{16} << 30U;  // read line by line

int run(const CupOptions& options, cup::AnswerLine answer) {
  const std::string input = find_shipped(options.input);
  const auto take = [](const std::string& line) { print_now(line + "\n"); };
  if (input == "-") {
    cup::answer_json_lines(std::cin, "stdin", answer, take);
    return kSuccess;
  }
  check_readable(input, "a file of JSON lines, or - for what comes on stdin", kLargestLines);
  std::ifstream file(input);
  cup::answer_json_lines(file, input, answer, take);
  return kSuccess;
}

int run_cup_evaluate(const CupOptions& options) { return run(options, cup::evaluate_json_line); }

int run_cup_settle(const CupOptions& options) { return run(options, cup::settle_json_line); }

cup::CupSheet sheet_of(const CupEstimateOptions& options) {
  cup::CupSheet sheet;
  sheet.diameter = 1e-3 * options.diameter_mm;
  sheet.bellows = options.bellows;
  sheet.material = cup::cup_material_of(options.material);
  sheet.lip = options.lip == "foam" ? cup::LipKind::Foam : cup::LipKind::Plain;
  sheet.pressure_gauge = cup::parse_gauge_pressure(options.vacuum, "--vacuum");
  if (options.stroke_mm) sheet.stroke = 1e-3 * *options.stroke_mm;
  sheet.mass_max = options.mass_max;
  return sheet;
}

int run_cup_estimate(const CupEstimateOptions& options) {
  const cup::CupSheet sheet = sheet_of(options);
  const cup::CupEstimate estimate = cup::estimate_cup(sheet);
  const std::string block = cup::format_estimate(sheet, estimate);
  if (std::optional<OutputFile> output = reserve({}, options.output)) write_file(std::move(*output), block);
  print(options.json ? cup::format_json(estimate) : block);
  return kSuccess;
}

int run_cup_catalogue(const CatalogueOptions& options) {
  print(options.json ? cup::format_catalogue_json() : cup::format_catalogue_table());
  return kSuccess;
}

constexpr const char* kEvaluateHelp =
    R"(Each line: {"R": 3x3, "o": [3], "K": 6x6, "S_R_S1": 3x3, "S_o_S1": [3]}; matrices as rows, SI units, linear part first.
The answer has the wrench on the package in S and in S1, and the stored energy V.
Example:
  snug cup evaluate scenarios/examples/deformations.jsonl)";

constexpr const char* kSettleHelp =
    R"(Each line: {"W_R_E": 3x3, "mass": kg, "com_S": [3], "K": 6x6, "E_H_S2": {"R", "o"}, "S_H_S1": {"R", "o"}}.
The answer has the pose of the lip, E_R_S and E_o_S, and whether the load stays there: stable.
Example:
  snug cup settle scenarios/examples/loads.jsonl)";

constexpr const char* kEstimateHelp =
    R"(estimate prints the blocks `cup` and `uncertainty` of a scenario, with the range and source of each number. Holds and tilt of
boxes depend on these numbers, filling hardly. Measure first what `snug identify` calls unknown.
Example:
  snug cup estimate --diameter 40 --bellows 1.5 --material silicone --lip foam --vacuum -60kPa --mass-max 5)";

void add_questions(const Verb& verb, const char* name, const char* about, const char* help,
                   int (*run)(const CupOptions&)) {
  const Verb part = verb.part(name, about, help);
  CupOptions& options = part.runs(run);
  part.option("input", options.input, "FILE", "file of JSON lines, - for stdin");
}

void add_cup_estimate(const Verb& verb) {
  const Verb part = verb.part("estimate", "estimate a starting cup from a data sheet", kEstimateHelp);
  CupEstimateOptions& options = part.runs(run_cup_estimate);
  part.option("--diameter", options.diameter_mm, "MM", "diameter of the lip", positive()).required();
  part.option("--bellows", options.bellows, "N", "number of folds: 0 (flat), 1.5 or 2.5");
  part.option("--material", options.material, "NAME", "material of the cup",
              one_of({"silicone", "nitrile", "polyurethane", "natural-rubber"}));
  part.option("--lip", options.lip, "NAME", "what seals the lip", one_of({"plain", "foam"}));
  part.option("--vacuum", options.vacuum, "PRESSURE",
              "gauge pressure while holding, with its unit: kPa, mbar, bar or Pa");
  part.option("--stroke", options.stroke_mm, "MM", "free length minus length under vacuum", finite());
  part.option("--mass-max", options.mass_max, "KG", "mass of the heaviest box, to test the hold", positive());
  part.option("-o,--output", options.output, "FILE.yaml", "also write the block here");
  add_json(part, options.json);
}

void add_cup_catalogue(const Verb& verb) {
  const Verb part = verb.part("catalogue", "list generic cups by size, at -60 kPa");
  add_json(part, part.runs(run_cup_catalogue).json);
}

}  // namespace

void add_cup(CLI::App& app, Action& action) {
  const Verb verb(app, action, "cup", "evaluate the model of the suction cup, or estimate a cup from a data sheet",
                  "`snug cup evaluate --help` and `snug cup settle --help` list the keys of a line.");
  add_questions(verb, "evaluate", "compute the wrench of a deformation", kEvaluateHelp, run_cup_evaluate);
  add_questions(verb, "settle", "compute where a held box hangs at rest", kSettleHelp, run_cup_settle);
  add_cup_estimate(verb);
  add_cup_catalogue(verb);
}

}  // namespace snug::app
