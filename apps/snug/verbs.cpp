// add_verbs: every verb that this program offers, in the order of --help.
#include "apps/snug/command_line/verbs.hpp"

namespace snug::app {

void add_verbs(CLI::App& app, Action& action) {
  add_init(app, action);
  add_simulate(app, action);
  add_pack(app, action);
  add_plan(app, action);
  add_compare(app, action);
  add_study(app, action);
  add_program(app, action);
  add_check(app, action);
  add_cell(app, action);
  add_run(app, action);
  add_serve(app, action);
  add_control(app, action);
  add_ur(app, action);
  add_keys(app, action);
  add_report(app, action);
  add_view(app, action);
  add_ui(app, action);
  add_plot(app, action);
  add_picture(app, action);
  add_export(app, action);
  add_items(app, action);
  add_load(app, action);
  add_shake(app, action);
  add_cup(app, action);
  add_camera(app, action);
  add_perceive(app, action);
  add_calibrate(app, action);
  add_measure(app, action);
  add_archive(app, action);
  add_convert(app, action);
  add_validate(app, action);
  add_identify(app, action);
  add_bench(app, action);
  add_completion(app, action);
  add_manual(app, action);
}

}  // namespace snug::app
