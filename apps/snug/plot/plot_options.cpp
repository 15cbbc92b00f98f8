// plot: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/plot/plot.hpp"
#include "apps/snug/report/report.hpp"

namespace snug::app {
namespace {

constexpr const char* kPlotExamples = R"(Examples:
  snug plot run.h5 --what wrench -o wrench.svg
  snug plot run.h5 --what limits -o limits.svg
  snug plot run.h5 --what pose:BOX027 --from 2 --to 20 -o box.svg
  snug plot run.h5 again.h5 --what tool --what speed --width 85 -o compare.svg)";

}  // namespace

void add_plot(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("plot", "draw quantities of a recording over time as SVG");
  const auto options = std::make_shared<PlotOptions>();
  verb.add_option("recordings", options->recordings, "a recording, and another one to lay over it (dashed)")
      ->required()
      ->type_name("FILE.h5");
  verb.add_option("--what", options->what,
                  "wrench (of the cup), flange (wrench on it), tool (position), error (to the command), speed, cup "
                  "(length and bend), deformation (pose of the lip), vacuum, contacts, solver, joints (of a robot), "
                  "limits (used of the joints' and of the hold), pose:BODY; several are drawn one below the other")
      ->required()
      ->take_all()
      ->type_name("WORD");
  verb.add_option("-o,--output", options->output, "the drawing to write")->required()->type_name("FILE.svg");
  verb.add_option("--width", options->width_mm, "of the drawing; one column of a paper is about 85")
      ->check(positive())
      ->type_name("MM")
      ->capture_default_str();
  verb.add_option("--height", options->height_mm, "of each pair of axes")
      ->check(positive())
      ->type_name("MM")
      ->capture_default_str();
  verb.add_option("--urdf", options->urdf, "whose joints' limits are meant (default: the file that its scenario names)")
      ->type_name("FILE.urdf");
  add_selection_options(verb, options->selection);
  verb.footer(kPlotExamples);
  verb.callback([options, &action] { action = [options] { return run_plot(*options); }; });
}

}  // namespace snug::app
