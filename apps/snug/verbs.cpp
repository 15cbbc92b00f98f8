// add_verbs: every verb that this program offers, in the order of --help.
#include "apps/snug/verbs.hpp"

#include "apps/snug/archive/archive.hpp"
#include "apps/snug/bench/bench.hpp"
#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/camera/camera.hpp"
#include "apps/snug/check/check.hpp"
#include "apps/snug/compare/compare.hpp"
#include "apps/snug/completion/completion.hpp"
#include "apps/snug/control/control.hpp"
#include "apps/snug/cup/cup.hpp"
#include "apps/snug/export/export.hpp"
#include "apps/snug/identify/identify.hpp"
#include "apps/snug/init/init.hpp"
#include "apps/snug/items/items.hpp"
#include "apps/snug/keys/keys.hpp"
#include "apps/snug/load/load.hpp"
#include "apps/snug/manual/manual.hpp"
#include "apps/snug/measure/measure.hpp"
#include "apps/snug/pack/pack.hpp"
#include "apps/snug/perceive/perceive.hpp"
#include "apps/snug/picture/picture.hpp"
#include "apps/snug/plan/plan.hpp"
#include "apps/snug/plot/plot.hpp"
#include "apps/snug/program/program.hpp"
#include "apps/snug/report/report.hpp"
#include "apps/snug/run/run.hpp"
#include "apps/snug/serve/serve.hpp"
#include "apps/snug/shake/shake.hpp"
#include "apps/snug/simulate/simulate.hpp"
#include "apps/snug/study/study.hpp"
#include "apps/snug/ui/ui.hpp"
#include "apps/snug/ur/ur.hpp"
#include "apps/snug/validate/validate.hpp"
#include "apps/snug/view/view.hpp"

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
  add_validate(app, action);
  add_identify(app, action);
  add_bench(app, action);
  add_completion(app, action);
  add_manual(app, action);
}

}  // namespace snug::app
