// items: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/items/items.hpp"

namespace snug::app {
namespace {

constexpr const char* kReadHelp =
    R"(A table as people keep it becomes a CSV of orders (docs/formats.md): commas, semicolons or tabs between columns, headings in
English, German, Dutch or French, in any order, units in headings or behind numbers. What the sheet does not say has to be said;
the error names the options and what each would mean for the first box.
Example:
  snug items read scenarios/examples/sheet.csv --length-unit cm --mass-unit g -o orders.csv)";

constexpr const char* kReduceHelp =
    R"(Report section 3.1.1: boxes of nearly equal size and mass become one, the most frequent of these are kept, and it is
said how many of all boxes have a representative near their size. ORDERS is a CSV with a header or JSON in the BED-BPP form.
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
`snug items draw --help`, `snug items read --help`, `snug items reduce --help` and `snug items sequence --help` tell more.)";

void add_draw(CLI::App& parent, Action& action) {
  CLI::App& verb = *parent.add_subcommand("draw", "typical orders, drawn by a seed");
  const auto options = std::make_shared<ItemsDrawOptions>();
  verb.add_option("--orders", options->wanted.orders, "how many")
      ->capture_default_str()
      ->check(whole(1, model::kMostTypicalOrders))
      ->type_name("N");
  verb.add_option("--boxes", options->wanted.boxes, "of an order, on average")
      ->capture_default_str()
      ->check(whole(1, model::kMostTypicalBoxes))
      ->type_name("N");
  verb.add_option("--seed", options->wanted.seed, "")->capture_default_str()->check(whole(0))->type_name("N");
  verb.add_option("-o,--output", options->output, "file to write instead of stdout")->type_name("FILE.csv");
  verb.footer(kDrawHelp);
  verb.callback([options, &action] { action = [options] { return run_items_draw(*options); }; });
}

void add_read(CLI::App& parent, Action& action) {
  CLI::App& verb = *parent.add_subcommand("read", "a table of boxes as people keep it, as a CSV of orders");
  const auto options = std::make_shared<ItemsReadOptions>();
  verb.add_option("sheet", options->sheet, "table with a header")->required()->type_name("SHEET.csv");
  verb.add_option("--length-unit", options->answers.length, "of edges for which the sheet has no unit: mm, cm, m or in")
      ->check(one_of({"mm", "cm", "m", "in"}))
      ->type_name("UNIT");
  verb.add_option("--mass-unit", options->answers.mass, "of masses for which the sheet has no unit: kg, g or lb")
      ->check(one_of({"kg", "g", "lb"}))
      ->type_name("UNIT");
  verb.add_option("--decimal", options->answers.decimal,
                  "what stands before decimals where it is unclear: point or comma")
      ->check(one_of({"point", "comma"}))
      ->type_name("MARK");
  verb.add_option("-o,--output", options->output, "file to write instead of stdout")->type_name("FILE.csv");
  verb.footer(kReadHelp);
  verb.callback([options, &action] { action = [options] { return run_items_read(*options); }; });
}

void add_reduce(CLI::App& parent, Action& action) {
  CLI::App& verb = *parent.add_subcommand("reduce", "few boxes that stand for those of many orders");
  const auto options = std::make_shared<ItemsReduceOptions>();
  verb.add_option("orders", options->orders, "orders")->required()->type_name("ORDERS");
  verb.add_option("--count", options->count, "representatives wanted")
      ->capture_default_str()
      ->check(whole(1, kMostRuns))
      ->type_name("N");
  verb.add_option("--group", options->group_percent, "boxes join whose edges and mass differ by at most so much")
      ->capture_default_str()
      ->check(within(1e-3, 1000.0))
      ->type_name("PERCENT");
  verb.add_option("--cover", options->cover_percent, "a box is represented when its edges differ by at most so much")
      ->capture_default_str()
      ->check(positive())
      ->type_name("PERCENT");
  verb.add_flag("--json", options->json, "print JSON");
  verb.add_option("-o,--output", options->output, "file for the representatives as parcel types of a scenario")
      ->type_name("FILE.yaml");
  verb.footer(kReduceHelp);
  verb.callback([options, &action] { action = [options] { return run_items_reduce(*options); }; });
}

void add_sequence(CLI::App& parent, Action& action) {
  CLI::App& verb = *parent.add_subcommand("sequence", "random orders of a scenario's boxes");
  const auto options = std::make_shared<ItemsSequenceOptions>();
  verb.add_option("scenario", options->scenario,
                  "scenario file, or name of one that comes with snug (drop, box-demonstrator)")
      ->required()
      ->type_name("SCENARIO.yaml");
  verb.add_option("--fill", options->fill_percent, "volume of the boxes, of the target container's")
      ->capture_default_str()
      ->check(within(1e-3, 1000.0))
      ->type_name("PERCENT");
  CLI::Option* all = verb.add_flag("--all", options->all,
                                   "every box of the scenario once, whatever they fill: the sequences that compare "
                                   "--random draws with the same seed and --name random");
  CLI::Option* types =
      verb.add_option("--types", options->types,
                      "draw new boxes of these types (as written by items reduce) instead of the scenario's boxes")
          ->type_name("FILE.yaml");
  all->excludes(types);
  verb.add_option("--sequences", options->sequences, "how many")
      ->capture_default_str()
      ->check(whole(1, kMostSequences))
      ->type_name("N");
  verb.add_option("--name", options->name, "the sequences are NAME-1, NAME-2, ...")
      ->capture_default_str()
      ->type_name("NAME");
  verb.add_option("--repeat", options->repeat, "probability that a box is of the type of the one before")
      ->capture_default_str()
      ->check(within(0.0, 1.0))
      ->type_name("0..1");
  verb.add_flag("--any-side-up", options->any_side_up, "boxes arrive standing on any side, not only with Z up");
  verb.add_option("--seed", options->seed, "")->capture_default_str()->check(whole(0))->type_name("N");
  verb.add_option("-o,--output", options->output, "file to write instead of stdout")->type_name("FILE.yaml");
  verb.footer(kSequenceHelp);
  verb.callback([options, &action] { action = [options] { return run_items_sequence(*options); }; });
}

}  // namespace

void add_items(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("items", "tables of boxes, boxes that stand for many, and sequences of boxes");
  verb.require_subcommand(1);
  add_draw(verb, action);
  add_read(verb, action);
  add_reduce(verb, action);
  add_sequence(verb, action);
  verb.footer(kItemsHelp);
}

}  // namespace snug::app
