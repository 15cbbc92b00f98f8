// verbs: every verb that this program offers; each is defined in the folder of its name.
#pragma once

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

/// Adds all of them to `app`, in the order of its --help; parsing one of them sets `action`, which must outlive the
/// parser.
void add_verbs(CLI::App& app, Action& action);

void add_init(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_pack(CLI::App& app, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_study(CLI::App& app, Action& action);
void add_program(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);
void add_cell(CLI::App& app, Action& action);
void add_run(CLI::App& app, Action& action);
void add_serve(CLI::App& app, Action& action);
void add_control(CLI::App& app, Action& action);
void add_ur(CLI::App& app, Action& action);
void add_keys(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_view(CLI::App& app, Action& action);
void add_ui(CLI::App& app, Action& action);
void add_plot(CLI::App& app, Action& action);
void add_picture(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_items(CLI::App& app, Action& action);
void add_load(CLI::App& app, Action& action);
void add_shake(CLI::App& app, Action& action);
void add_cup(CLI::App& app, Action& action);
void add_camera(CLI::App& app, Action& action);
void add_perceive(CLI::App& app, Action& action);
void add_calibrate(CLI::App& app, Action& action);
void add_measure(CLI::App& app, Action& action);
void add_archive(CLI::App& app, Action& action);
void add_convert(CLI::App& app, Action& action);
void add_validate(CLI::App& app, Action& action);
void add_identify(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_completion(CLI::App& app, Action& action);
void add_manual(CLI::App& app, Action& action);

}  // namespace snug::app
