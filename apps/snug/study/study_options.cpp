// study: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/study/study.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

constexpr const char* kStudyHelp =
    R"(The file names a verb, its options and factors: options and scenario keys that change from row to row
(docs/studies.md). Every row is a function of its index. What is done is not done again: the same words after a kill go on.
Examples:
  snug study scenarios/examples/friction.yaml           # run what is missing, on all cores
  snug study scenarios/examples/friction.yaml --slurm   # write and submit an array of jobs
  snug study status scenarios/examples/friction.yaml
  snug study merge scenarios/examples/friction.yaml -o friction.csv
  snug study report scenarios/examples/friction.yaml -o friction.html)";

using StudyWork = int (*)(const StudyOptions&);

void add_study_file(CLI::App& verb, StudyOptions& options, bool is_required) {
  verb.add_option("study", options.file, "file of the study")->required(is_required)->type_name("STUDY.yaml");
  verb.add_option("--dir", options.dir, "folder of its tables (default: STUDY.study)")->type_name("DIR");
}

CLI::App& add_study_part(CLI::App& study, const char* name, const char* about,
                         const std::shared_ptr<StudyOptions>& options, StudyWork work, Action& action) {
  CLI::App& part = *study.add_subcommand(name, about);
  add_study_file(part, *options, true);
  part.callback([options, work, &action] { action = [options, work] { return work(*options); }; });
  return part;
}

}  // namespace

void add_study(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("study", "many runs over a design of scenario keys and options, here or on a cluster");
  const auto options = std::make_shared<StudyOptions>();
  verb.require_subcommand(0, 1);
  add_study_file(verb, *options, false);
  verb.add_option("--threads", options->threads,
                  "rows at a time; the result does not depend on it (default: all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  verb.add_option("--chunks", options->chunks, "only these tables, from 0; jobs of an array have theirs")
      ->type_name("A-B");
  CLI::Option* slurm =
      verb.add_flag("--slurm", options->slurm, "write an array of jobs for what is missing and submit it");
  verb.add_flag("--dry-run", options->dry_run, "with --slurm: write it, but do not submit it")->needs(slurm);
  verb.add_flag("--json", options->json, "print the summary as JSON");
  verb.footer(kStudyHelp);
  const auto status = std::make_shared<StudyOptions>();
  add_study_part(verb, "status", "how much of a study is done", status, &run_study_status, action)
      .add_flag("--json", status->json, "print JSON");
  const auto merge = std::make_shared<StudyOptions>();
  add_study_part(verb, "merge", "all rows that are done as one table, in the order of their indices", merge,
                 &run_study_merge, action)
      .add_option("-o,--output", merge->output, "table, CSV or HDF5 by its ending")
      ->required()
      ->type_name("FILE.csv|FILE.h5");
  const auto report = std::make_shared<StudyOptions>();
  CLI::App& page = add_study_part(verb, "report", "a page: main effects, interactions, quantiles, worst rows", report,
                                  &run_study_report, action);
  page.add_option("-o,--output", report->output, "page")->required()->type_name("FILE.html");
  page.add_option("--worst", report->worst, "rows listed as worst, of each number")
      ->check(whole(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  verb.callback([options, &verb, &action] {
    if (!verb.get_subcommands().empty()) return;
    if (options->file.empty())
      throw InputError("command line", "study", "no file", "STUDY.yaml, or status, merge or report");
    action = [options] { return run_study(*options); };
  });
}

}  // namespace snug::app
