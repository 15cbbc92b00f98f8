// archive: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/archive/archive.hpp"

namespace snug::app {
namespace {

void add_reading(CLI::App& verb, Action& action, const char* name, const char* description, const char* footer,
                 int (*run)(const ArchiveListOptions&)) {
  CLI::App& part = *verb.add_subcommand(name, description);
  const auto options = std::make_shared<ArchiveListOptions>();
  part.add_option("archive", options->archive, "an archive")->required()->type_name("ARCHIVE.h5");
  part.add_flag("--json", options->json, "print JSON");
  part.footer(footer);
  part.callback([options, run, &action] { action = [options, run] { return run(*options); }; });
}

void add_convert(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("convert", "an archive into tables, or a log into an archive");
  const auto options = std::make_shared<ArchiveConvertOptions>();
  part.add_option("input", options->input, "an archive, or a log with the column names of mc_rtc")
      ->required()
      ->type_name("ARCHIVE.h5|LOG.csv");
  part.add_option("-o,--output", options->output, "folder for the tables (made if needed), or the archive")
      ->required()
      ->type_name("FOLDER|FILE.h5");
  part.add_option("--name", options->name, "of the recording that a log becomes; else the log's file name")
      ->type_name("NAME");
  part.add_option("--note", options->note, "what to remark about the recording that a log becomes")->type_name("TEXT");
  part.add_option("--sequence", options->sequence, "item sequence of the recording that a log becomes")
      ->type_name("NAME");
  part.footer(
      "Each source of an archive becomes a table of its own, as each has a clock of its own.\n"
      "Examples:\n  snug archive convert measured.h5 -o tables\n"
      "  snug export run.h5 --format csv -o log.csv\n"
      "  snug archive convert log.csv --name Rec_20230511T093000Z --sequence 1 -o one.h5");
  part.callback([options, &action] { action = [options] { return run_archive_convert(*options); }; });
}

void add_merge(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("merge", "several archives into one: the repetitions of a sequence");
  const auto options = std::make_shared<ArchiveMergeOptions>();
  part.add_option("archives", options->archives, "two or more")->required()->expected(2, 100)->type_name("ARCHIVE.h5");
  part.add_option("-o,--output", options->output, "the archive to write")->required()->type_name("FILE.h5");
  part.footer(
      "Recordings keep their names and remarks. Two of one name, of two sequences, or with another mass or size of "
      "the\n"
      "same body are refused.\nExamples:\n"
      "  snug measure run.h5 --sensors scenarios/sensors/demonstrator.yaml -o first.h5\n"
      "  snug measure again.h5 --sensors scenarios/sensors/demonstrator.yaml --date 20000102T000000Z -o second.h5\n"
      "  snug archive merge first.h5 second.h5 -o sequence-1.h5");
  part.callback([options, &action] { action = [options] { return run_archive_merge(*options); }; });
}

}  // namespace

void add_archive(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("archive", "archives of measurements: what is in them, are they whole");
  verb.require_subcommand(1);
  add_reading(verb, action, "list", "recordings, sources, bodies and how much of them was tracked",
              "Example:\n  snug archive list measured.h5 --json", run_archive_list);
  add_reading(verb, action, "check",
              "read everything; tell each defect with its path and index; exit code 2 if there is one",
              "Example:\n  snug archive check measured.h5", run_archive_check);
  add_convert(verb, action);
  add_merge(verb, action);
}

}  // namespace snug::app
