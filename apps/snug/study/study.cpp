// study: rows are the program's own verbs, each in a process that is split off; tables and pages are the module's.
#include "apps/snug/study/study.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <thread>

#include "apps/snug/command_line/command_line.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "apps/snug/command_line/version.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/python_interpreter.hpp"
#include "snug/core/write_file.hpp"
#include "snug/study/effects.hpp"
#include "snug/study/ray.hpp"
#include "snug/study/run.hpp"
#include "snug/study/study_text.hpp"

namespace snug::app {
namespace {

namespace fs = std::filesystem;

/// The words of `snug study`.
struct StudyOptions {
  std::string file;
  std::optional<std::string> dir;  ///< absent: the file's name with the ending .study, in the folder one is in
  std::optional<int> threads;      ///< absent: all cores
  std::optional<std::string> chunks;
  bool slurm = false;
  std::optional<std::string> ray;  ///< address of a cluster
  bool dry_run = false;
  bool json = false;
  std::optional<std::string> output;
  int worst = 10;
};

fs::path folder_of(const StudyOptions& options) {
  if (options.dir) return *options.dir;
  return fs::path(options.file).stem().string() + ".study";
}

/// What a study reads, and what it has found.
NamedFiles files_of(const StudyOptions& options, const study::Study& study, const study::Folder& folder) {
  NamedFiles files{{"the study", options.file}};
  if (!study.scenario.empty()) files.push_back({"the study's scenario", study.scenario});
  for (const fs::path& file : folder.files()) files.push_back({"a file of the study's folder", file});
  return files;
}

std::string this_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) throw std::runtime_error("where this program is cannot be told: " + error.message());
  return program.string();
}

/// By Slurm or Ray: what is missing as a script in the study's folder, then handed over.
int hand_over(const StudyOptions& options, const study::Study& study, const study::Folder& folder) {
  const study::ArrayPlan plan = study::plan_array(study, folder);
  if (plan.tasks.empty()) {
    std::fprintf(stderr, "every row is done\n");
    return kSuccess;
  }
  const fs::path script = study::write_tasks(study, folder, plan, this_program(), options.file, options.ray);
  if (options.dry_run || !options.ray) {
    print((options.dry_run ? script.string() : study::submit(script)) + "\n");
    return kSuccess;
  }
  const std::string python = python_interpreter();
  execlp(python.c_str(), python.c_str(), script.c_str(), nullptr);
  throw InputError("command line", "--ray", "'" + python + "' cannot be started: " + std::strerror(errno),
                   "a Python 3 with ray, named by SNUG_PYTHON");
}

std::function<void(std::uint64_t, std::uint64_t)> progress_line() {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [](std::uint64_t done, std::uint64_t wanted) {
    std::fprintf(stderr, "\r%llu of %llu rows of the chunks under way%s", static_cast<unsigned long long>(done),
                 static_cast<unsigned long long>(wanted), done == wanted ? "\r\033[K" : "");
    std::fflush(stderr);
  };
}

int run_study(const StudyOptions& options) {
  if (options.file.empty())
    throw InputError("command line", "study", "no file", "STUDY.yaml, or status, merge or report");
  const study::Study study = study::load_study(options.file);
  study::RunSettings settings;
  settings.version = version_text();
  if (options.chunks) std::tie(settings.first_chunk, settings.last_chunk) = study::parse_chunks(*options.chunks, study);
  if (options.dry_run && !options.slurm && !options.ray)
    throw InputError("command line", "--dry-run", "without --slurm or --ray", "one of them");
  const study::Folder folder(study, folder_of(options), true);
  if (options.slurm || options.ray) return hand_over(options, study, folder);
  settings.processes = options.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  settings.progress = progress_line();
  const auto start = std::chrono::steady_clock::now();
  const study::RunSummary summary = study::run_study(
      study, folder, [](const std::vector<std::string>& words) { return run_row(words); }, settings);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  print(options.json ? study::format_run_json(study, folder, summary, wall.count(), settings.processes)
                     : study::format_run_text(folder, summary, wall.count()));
  if (summary.left_out == 0) return kSuccess;
  std::fprintf(stderr,
               "snug: failed: %llu rows were left out: others are at work on them, or their processes were killed\n",
               static_cast<unsigned long long>(summary.left_out));
  return kRunFailed;
}

int run_study_status(const StudyOptions& options) {
  const study::Study study = study::load_study(options.file);
  const study::Folder folder(study, folder_of(options), false);
  const study::Status status = study::status_of(study, folder);
  print(options.json ? study::format_status_json(study, status) : study::format_status_text(status));
  return kSuccess;
}

int run_study_merge(const StudyOptions& options) {
  const study::Study study = study::load_study(options.file);
  const study::Folder folder(study, folder_of(options), false);
  study::write_table(study, folder, *options.output, reserve(files_of(options, study, folder), *options.output));
  const study::Status status = study::status_of(study, folder);
  if (status.done < status.rows)
    std::fprintf(stderr, "%llu of %llu rows are not done yet\n",
                 static_cast<unsigned long long>(status.rows - status.done),
                 static_cast<unsigned long long>(status.rows));
  return kSuccess;
}

int run_study_report(const StudyOptions& options) {
  const study::Study study = study::load_study(options.file);
  const study::Folder folder(study, folder_of(options), false);
  OutputFile file = reserve(files_of(options, study, folder), *options.output);
  const auto effects = study::find_effects(study, folder, static_cast<std::size_t>(options.worst));
  write_file(std::move(file), study::make_page(study, study::status_of(study, folder), effects));
  return kSuccess;
}

constexpr const char* kStudyHelp =
    R"(The file names a verb, its options and factors: options and scenario keys that change from row to row
(docs/studies.md). Every row depends only on its index. Finished rows are not computed again: after a kill the same command continues.
Examples:
  snug study scenarios/examples/friction.yaml           # run what is missing, on all cores
  snug study scenarios/examples/friction.yaml --slurm   # write and submit an array of jobs
  snug study scenarios/examples/friction.yaml --ray auto   # hand what is missing to a Ray cluster and wait
  snug study status scenarios/examples/friction.yaml
  snug study merge scenarios/examples/friction.yaml -o friction.csv
  snug study report scenarios/examples/friction.yaml -o friction.html)";

}  // namespace

// Rows share the machine: a verb that would take every core for itself gets its part.
int run_row(const std::vector<std::string>& words, int threads) {
  std::vector<std::string> all = {"snug"};
  all.insert(all.end(), words.begin(), words.end());
  const bool takes_all = words.front() == "pack" || words.front() == "compare" || words.front() == "simulate";
  if (takes_all && std::ranges::find(words, "--threads") == words.end())
    all.insert(all.end(), {"--threads", std::to_string(threads)});
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int code = run_command_line(static_cast<int>(all.size()), argv.data());
  return flush_stdout() ? code : std::max<int>(code, kRunFailed);
}

void add_study(CLI::App& app, Action& action) {
  const Verb verb(app, action, "study", "run a design over scenario keys and options, here or on a cluster",
                  kStudyHelp);
  const auto add_file = [](const Verb& to, StudyOptions& options, bool is_required) {
    to.option("study", options.file, "STUDY.yaml", "file of the study").required(is_required);
    to.option("--dir", options.dir, "DIR", "folder of its tables (default: STUDY.study)");
  };
  StudyOptions& options = verb.runs(run_study);
  add_file(verb, options, false);
  verb.option("--threads", options.threads, "N", "rows at a time; they do not change the result (default: all cores)",
              whole(1, kMostThreads));
  verb.option("--chunks", options.chunks, "A-B", "compute only these tables, counted from 0");
  const OptionRow slurm = verb.flag("--slurm", options.slurm, "write a job array for the missing rows and submit it");
  verb.option("--ray", options.ray, "ADDRESS",
              "compute the missing rows on a Ray cluster and wait: its address, auto, or local for this machine alone")
      .excludes(slurm);
  verb.flag("--dry-run", options.dry_run, "with --slurm or --ray: write the script, but do not run it");
  add_json(verb, options.json);
  const Verb status = verb.part("status", "report how much of a study is done", "", true);
  StudyOptions& of_status = status.runs(run_study_status);
  add_file(status, of_status, true);
  add_json(status, of_status.json);
  const Verb merge = verb.part("merge", "write all finished rows as one table, ordered by index", "", true);
  StudyOptions& of_merge = merge.runs(run_study_merge);
  add_file(merge, of_merge, true);
  merge.option("-o,--output", of_merge.output, "FILE.csv|FILE.h5", "table, CSV or HDF5 by its ending").required();
  const Verb report = verb.part("report", "write a page: main effects, interactions, quantiles, worst rows", "", true);
  StudyOptions& of_report = report.runs(run_study_report);
  add_file(report, of_report, true);
  report.option("-o,--output", of_report.output, "FILE.html", "page").required();
  report.option("--worst", of_report.worst, "N", "how many of the worst rows to list for each output", whole(0, 1000));
}

}  // namespace snug::app
