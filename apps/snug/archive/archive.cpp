// archive: what is in archives of measurements, whether they are whole, and archives from parts.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "snug/archive_import/measurements.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/archive_text.hpp"
#include "snug/validation/log_table.hpp"

namespace snug::app {
namespace {

struct ArchiveListOptions {
  std::string archive;
  bool json = false;
};
struct ArchiveConvertOptions {
  std::vector<std::string> inputs;
  std::string output;  ///< a folder for an archive's tables, a .h5 for measurements
  std::string name;    ///< of the recording that measurements become; the first file's unless given
  std::string note, sequence, up = "y";
  std::vector<std::string> renames;  ///< OLD=NEW
  std::optional<double> rate;        ///< Hz
  archive_import::Hints hints;
};
struct ArchiveMergeOptions {
  std::vector<std::string> archives;
  std::string output;
};

int run_archive_list(const ArchiveListOptions& options) {
  const record::ArchiveReader reader(options.archive);
  print(options.json ? validation::contents_json(reader) : validation::contents_text(reader));
  return kSuccess;
}

int run_archive_check(const ArchiveListOptions& options) {
  const record::ArchiveReader reader(options.archive);
  const std::vector<InputError> defects = record::find_defects(reader);
  if (options.json)
    print(validation::defects_json(reader, defects));
  else if (defects.empty())
    print(fmt::format("{}: {} recordings, whole\n", options.archive, reader.size()));
  else
    for (const InputError& error : defects) std::fprintf(stderr, "snug: error: %s\n", error.what());
  return defects.empty() ? kSuccess : kBadInput;
}

int import_measurements(const ArchiveConvertOptions& options) {
  OutputFile output = reserve(name_all("the measurements", options.inputs), options.output);
  archive_import::Hints hints = options.hints;
  hints.up = options.up == "z" ? archive_import::UpAxis::Z : archive_import::UpAxis::Y;
  hints.rate = options.rate.value_or(0.0);
  hints.names = archive_import::parse_names(options.renames, "--rename");
  archive_import::Imported imported = archive_import::load_all({options.inputs.begin(), options.inputs.end()}, hints);
  record::ArchiveRecording& recording = imported.recording;
  if (!options.name.empty()) recording.name = options.name;
  if (!options.note.empty()) recording.remarks = {{"note", options.note}};
  if (!options.sequence.empty()) recording.remarks.emplace_back("sequence", options.sequence);
  record::save_archive(std::move(output), {{recording}});
  for (const std::string& remark : imported.remarks) std::fprintf(stderr, "snug: note: %s\n", remark.c_str());
  return kSuccess;
}

int run_archive_convert(const ArchiveConvertOptions& options) {
  const bool is_import = options.inputs.size() > 1 || archive_import::is_import(options.inputs.front());
  if (is_import) return import_measurements(options);
  if (!(options.name + options.note + options.sequence).empty())
    throw InputError("command line", "--name, --note, --sequence", "an archive",
                     "measurements: recordings keep what they have");
  const record::ArchiveReader reader(options.inputs.front());
  make_folder("-o", options.output);
  for (std::size_t i = 0; i < reader.size(); ++i) {
    for (const std::filesystem::path& path : validation::save_tables(reader.read(i), options.output))
      print(path.string() + "\n");
  }
  return kSuccess;
}

int run_archive_merge(const ArchiveMergeOptions& options) {
  record::merge_archives({options.archives.begin(), options.archives.end()},
                         reserve(name_all("an archive", options.archives), options.output));
  return kSuccess;
}

void add_reading(const Verb& verb, const char* name, const char* description, const char* footer,
                 int (*run)(const ArchiveListOptions&)) {
  const Verb part = verb.part(name, description, footer);
  ArchiveListOptions& options = part.runs(run);
  part.option("archive", options.archive, "ARCHIVE.h5", "an archive").required();
  add_json(part, options.json);
}

constexpr const char* kArchiveConvertHelp =
    R"(Each source of an archive becomes a separate table, since each has its own clock. Into an archive go CSV of OptiTrack's Motive, of RTDE
(record.py, ur_rtde) and with the column names of mc_rtc, its flat binary logs (.flat), MCAP and bags of ROS (.mcap, .db3, .bag, a folder).
Several files become one recording: each adds what the others lack. Bags need readers of PyPI in a Python that SNUG_PYTHON names; a
message says what is missing. For a bag with a robot: --tool tool0 --wrench /force_torque_sensor_broadcaster/wrench. Where a file lacks
something, a message names the option that supplies it (--up, --length-unit, --rotation, --rate). convert reports on stderr what it left
out or assumed (docs/formats.md#measurements-of-other-programs).
Examples:
  snug archive convert measured.h5 -o tables
  snug export run.h5 --format csv -o log.csv
  snug archive convert log.csv --name Rec_20230511T093000Z --sequence 1 -o one.h5
  snug archive convert scenarios/examples/take.csv scenarios/examples/rtde.csv --rename Crate=Box013 --rename "Robot base=Base005" -o lift.h5)";

void add_archive_convert(const Verb& verb) {
  const Verb part =
      verb.part("convert", "convert an archive into tables, or measurements into an archive", kArchiveConvertHelp);
  ArchiveConvertOptions& options = part.runs(run_archive_convert);
  part.option("input", options.inputs, "FILE", "an archive, or measurements: .csv, .flat, .mcap, .db3, .bag, a folder")
      .required()
      .expected(1, 8);
  part.option("-o,--output", options.output, "FOLDER|FILE.h5", "folder for the tables (made if needed), or the archive")
      .required();
  part.option("--name", options.name, "NAME", "name of the recording (default: that of the file of measurements)");
  part.option("--note", options.note, "TEXT", "remark on that recording");
  part.option("--sequence", options.sequence, "NAME", "item sequence of that recording");
  part.option("--rename", options.renames, "OLD=NEW", "rename a body of the file for the archive: Box013, Base005")
      .one_each();
  part.option("--up", options.up, "AXIS", "vertical axis in files of Motive: y, its usual one, is turned to z; or z",
              one_of({"y", "z"}));
  part.option("--length-unit", options.hints.length_unit, "UNIT", "unit of a file of Motive whose header names none",
              one_of({"m", "cm", "mm", "in", "ft"}));
  part.option("--rotation", options.hints.rotation, "ORDER",
              "order of the angles of a file of Motive whose header names none",
              one_of({"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}));
  part.option("--rate", options.rate, "HZ", "rows a second of RTDE without a column timestamp", positive());
  part.option("--tool", options.hints.tool, "TOPIC|FRAME", "in a bag: topic or frame with the poses of the tool");
  part.option("--wrench", options.hints.wrench, "NAME",
              "force sensor: topic of a bag, sensor of a flat log, columns of RTDE (ft_raw_wrench)");
  part.flag("--turn-wrench", options.hints.turns_wrench, "forces act from the robot on the load: change all signs");
  part.option("--joint", options.hints.joints, "NAME", "in a bag: joints from base to tool, one each").one_each();
  part.option("--fixed-frame", options.hints.fixed_frame, "NAME", "in a bag: the frame of /tf in which to give poses");
}

void add_merge(const Verb& verb) {
  const Verb part = verb.part(
      "merge", "merge several archives into one: the repetitions of a sequence",
      "Recordings keep their names and remarks. merge refuses two recordings of one name, recordings of different "
      "sequences,\nand another mass or size of the same body.\nExamples:\n  snug measure run.h5 --sensors "
      "scenarios/sensors/demonstrator.yaml -o "
      "first.h5\n  snug measure again.h5 --sensors scenarios/sensors/demonstrator.yaml --date 20000102T000000Z -o "
      "second.h5\n  snug archive merge first.h5 second.h5 -o sequence-1.h5");
  ArchiveMergeOptions& options = part.runs(run_archive_merge);
  part.option("archives", options.archives, "ARCHIVE.h5", "two or more").required().expected(2, 100);
  part.option("-o,--output", options.output, "FILE.h5", "the archive to write").required();
}

}  // namespace

void add_archive(CLI::App& app, Action& action) {
  const Verb verb(app, action, "archive", "list, check, convert and merge archives of measurements");
  add_reading(verb, "list", "list recordings, sources, bodies and how much of each was tracked",
              "Example:\n  snug archive list measured.h5 --json", run_archive_list);
  add_reading(verb, "check",
              "read everything and report each defect with its path and index; exit code 2 if there is one",
              "Example:\n  snug archive check measured.h5", run_archive_check);
  add_archive_convert(verb);
  add_merge(verb);
}

}  // namespace snug::app
