// items: tables of boxes, few boxes that stand for many real ones, and sequences of them.
#include <fmt/format.h>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/model/items_sheet.hpp"
#include "snug/model/typical_orders.hpp"
#include "snug/packing/item_text.hpp"

namespace snug::app {
namespace {

struct ItemsReduceOptions {
  std::string orders;
  int count = 4;
  double group_percent = 10.0;
  double cover_percent = 20.0;
  bool json = false;
  std::optional<std::string> output;
};

struct ItemsSequenceOptions {
  std::string scenario;
  std::optional<std::string> types;  ///< file with parcel types: new boxes of these, as many as it takes
  std::string name = "drawn";
  int sequences = 1;
  double fill_percent = 90.0;
  double repeat = 0.4;
  bool any_side_up = false;
  bool all = false;  ///< every box of the scenario once
  std::uint64_t seed = 1;
  std::optional<std::string> output;
};

struct ItemsReadOptions {
  std::string sheet;
  model::SheetAnswers answers;
  std::optional<std::string> output;
};

struct ItemsDrawOptions {
  model::TypicalOrders wanted;
  std::optional<std::string> output;
};

int run_items_draw(const ItemsDrawOptions& options) {
  print_or_write(model::draw_typical_orders(options.wanted), reserve({}, options.output));
  return kSuccess;
}

int run_items_read(const ItemsReadOptions& options) {
  std::optional<OutputFile> output = reserve({{"the sheet", options.sheet}}, options.output);
  const std::string text = read_file(options.sheet, "a table of boxes (CSV)");
  const model::ItemsSheet sheet = model::read_items_sheet(text, options.sheet, options.answers);
  print_or_write(model::require_orders(sheet, options.sheet), std::move(output));
  return kSuccess;
}

int run_items_reduce(const ItemsReduceOptions& options) {
  std::optional<OutputFile> output = reserve({{"the orders", options.orders}}, options.output);
  const packing::ReductionSettings settings{options.count, 0.01 * options.group_percent, 0.01 * options.cover_percent};
  const packing::Reduction reduction =
      packing::reduce_items(model::load_orders(find_shipped(options.orders)), settings);
  if (output) write_file(std::move(*output), packing::format_yaml(reduction));
  print(options.json ? packing::format_json(reduction) : packing::format_table(reduction, options.cover_percent));
  return kSuccess;
}

int run_items_sequence(const ItemsSequenceOptions& options) {
  const model::Scenario scenario = model::load_scenario(find_scenario(options.scenario));
  NamedFiles inputs = {{"the scenario", find_scenario(options.scenario)}};
  add_file(inputs, "--types", options.types);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  const model::Scenario drawn_from =
      options.types ? packing::with_boxes_of_types(scenario, *options.types, options.fill_percent) : scenario;
  const packing::SequenceSettings settings{options.fill_percent, options.all ? 0.0 : options.repeat,
                                           options.any_side_up, options.all};
  std::vector<model::Sequence> sequences;
  for (int i = 1; i <= options.sequences; ++i) {
    const std::string name = options.name + "-" + std::to_string(i);
    const Rng rng = Rng(options.seed).split("sequence " + name);
    sequences.push_back(packing::draw_sequence(drawn_from, name, settings, rng));
  }
  std::string text = options.all ? fmt::format("# all boxes of {}, seed {}\n", scenario.name, options.seed)
                                 : fmt::format("# boxes of {} to {:g} % of its container, seed {}\n", scenario.name,
                                               options.fill_percent, options.seed);
  if (options.types) {
    const auto material = static_cast<std::size_t>(scenario.parcels.front().material.index);
    text += packing::format_boxes_yaml(drawn_from, sequences, scenario.materials[material].name);
  }
  print_or_write(text + packing::format_sequences_yaml(sequences), std::move(output));
  return kSuccess;
}

constexpr const char* kReadHelp =
    R"(read converts a table into a CSV of orders (docs/formats.md). Columns may be separated by commas, semicolons or tabs; headings
may be English, German, Dutch or French, in any order; units stand in headings or after numbers. If the sheet leaves
something open, the error names the options and what each would mean for the first box.
Example:
  snug items read scenarios/examples/sheet.csv --length-unit cm --mass-unit g -o orders.csv)";

constexpr const char* kReduceHelp =
    R"(Report section 3.1.1: reduce joins boxes of nearly equal size and mass, keeps the most frequent of these, and reports
how many of all boxes have a representative near their size. ORDERS is a CSV with a header or JSON in the BED-BPP form.
Example:
  snug items reduce scenarios/orders-example.csv --count 4 -o types.yaml)";

constexpr const char* kSequenceHelp =
    R"(Report section 3.1.2: boxes of the scenario in random order, as few as reach the theoretical filling degree.
Examples:
  snug items sequence scenarios/box-demonstrator.yaml --fill 90 --sequences 5 --seed 7 -o sequences.yaml
  snug items reduce scenarios/orders-example.csv --count 4 -o types.yaml
  snug items sequence scenarios/box-demonstrator.yaml --types types.yaml --fill 90 -o sequences.yaml
  snug pack scenarios/box-demonstrator.yaml --items sequences.yaml --sequence drawn-1
  snug items sequence scenarios/box-demonstrator.yaml --all --name random --sequences 50 -o random.yaml)";

constexpr const char* kDrawHelp =
    R"(Ten sizes of folding boxes that shops stock, smaller ones more frequent, 120 to 350 kg/m^3: assumed, to begin with where
there are no orders yet. An order has a third more or less boxes than wanted. The same seed gives the same orders.
Example:
  snug items draw --orders 3 --boxes 20 --seed 1 -o typical-1.csv)";

constexpr const char* kItemsHelp =
    R"(Examples:
  snug items draw --orders 3 --boxes 20 --seed 1 -o typical-1.csv
  snug items read scenarios/examples/sheet.csv --length-unit cm --mass-unit g -o orders.csv
  snug items reduce scenarios/orders-example.csv --count 4 -o types.yaml
  snug items sequence scenarios/box-demonstrator.yaml --types types.yaml --fill 90 -o sequences.yaml
  snug pack scenarios/box-demonstrator.yaml --items sequences.yaml --sequence drawn-1
See also `snug items draw --help`, `snug items read --help`, `snug items reduce --help` and `snug items sequence --help`.)";

void add_result(const Verb& verb, std::optional<std::string>& output, const char* value) {
  verb.option("-o,--output", output, value, "file to write instead of stdout");
}

void add_draw(const Verb& items) {
  const Verb verb = items.part("draw", "draw typical orders by a seed", kDrawHelp);
  ItemsDrawOptions& options = verb.runs(run_items_draw);
  verb.option("--orders", options.wanted.orders, "N", "number of orders", whole(1, model::kMostTypicalOrders));
  verb.option("--boxes", options.wanted.boxes, "N", "boxes of an order, as a mean", whole(1, model::kMostTypicalBoxes));
  verb.option("--seed", options.wanted.seed, "N", "", whole(0));
  add_result(verb, options.output, "FILE.csv");
}

void add_read(const Verb& items) {
  const Verb verb = items.part("read", "convert a table of boxes into a CSV of orders", kReadHelp);
  ItemsReadOptions& options = verb.runs(run_items_read);
  verb.option("sheet", options.sheet, "SHEET.csv", "table with a header").required();
  verb.option("--length-unit", options.answers.length, "UNIT",
              "unit of edges for which the sheet has none: mm, cm, m or in", one_of({"mm", "cm", "m", "in"}));
  verb.option("--mass-unit", options.answers.mass, "UNIT", "unit of masses for which the sheet has none: kg, g or lb",
              one_of({"kg", "g", "lb"}));
  verb.option("--decimal", options.answers.decimal, "MARK",
              "decimal mark, if the sheet leaves it unclear: point or comma", one_of({"point", "comma"}));
  add_result(verb, options.output, "FILE.csv");
}

void add_reduce(const Verb& items) {
  const Verb verb = items.part("reduce", "find a few boxes that represent those of many orders", kReduceHelp);
  ItemsReduceOptions& options = verb.runs(run_items_reduce);
  verb.option("orders", options.orders, "ORDERS", "orders").required();
  verb.option("--count", options.count, "N", "number of representatives", whole(1, kMostRuns));
  verb.option("--group", options.group_percent, "PERCENT", "join boxes whose edges and mass differ by at most this",
              within(1e-3, 1000.0));
  verb.option("--cover", options.cover_percent, "PERCENT", "a box is represented if its edges differ by at most this",
              positive());
  verb.flag("--json", options.json, "print JSON");
  verb.option("-o,--output", options.output, "FILE.yaml", "file for the representatives as parcel types of a scenario");
}

void add_sequence(const Verb& items) {
  const Verb verb = items.part("sequence", "draw random orders of a scenario's boxes", kSequenceHelp);
  ItemsSequenceOptions& options = verb.runs(run_items_sequence);
  add_scenario(verb, options.scenario);
  verb.option("--fill", options.fill_percent, "PERCENT", "volume of the boxes, in percent of the target container's",
              within(1e-3, 1000.0));
  const OptionRow all = verb.flag("--all", options.all,
                                  "use every box of the scenario once, whatever they fill; with --name random and the "
                                  "same seed these are the sequences of compare --random");
  const OptionRow types =
      verb.option("--types", options.types, "FILE.yaml",
                  "draw new boxes of these types (written by items reduce) instead of the scenario's boxes");
  all.excludes(types);
  verb.option("--sequences", options.sequences, "N", "number of orders", whole(1, kMostSequences));
  verb.option("--name", options.name, "NAME", "the sequences are NAME-1, NAME-2, ...");
  verb.option("--repeat", options.repeat, "0..1", "probability that a box is of the type of the one before",
              within(0.0, 1.0));
  verb.flag("--any-side-up", options.any_side_up, "boxes arrive standing on any side, not only with Z up");
  verb.option("--seed", options.seed, "N", "", whole(0));
  add_result(verb, options.output, "FILE.yaml");
}

}  // namespace

void add_items(CLI::App& app, Action& action) {
  const Verb verb(app, action, "items", "read tables of boxes, reduce them to representatives, draw sequences",
                  kItemsHelp);
  add_draw(verb);
  add_read(verb);
  add_reduce(verb);
  add_sequence(verb);
}

}  // namespace snug::app
