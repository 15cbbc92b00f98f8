// export: one function for each format.
#include "apps/snug/export/export.hpp"
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <sstream>
#include <string_view>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/replay/csv_export.hpp"
#include "snug/replay/glb_export.hpp"
#include "snug/replay/mcap_export.hpp"
#include "snug/replay/moveit_export.hpp"

namespace snug::app {
namespace {

int said(const ExportOptions& options, const auto& totals) {
  std::fprintf(stderr, "%s: %s\n", options.output.c_str(), to_text(totals).c_str());
  return kSuccess;
}

int write_mcap(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  const replay::McapTotals totals = replay::export_mcap(
      reader, file_name(options.input), options.selection, std::move(output),
      {.encoding = options.encoding == "json" ? replay::McapEncoding::Json : replay::McapEncoding::Protobuf,
       .compression = options.compression == "none" ? replay::McapCompression::None : replay::McapCompression::Zstd},
      find_robot(reader, options.input, options.urdf));
  return said(options, totals);
}

int write_csv(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  return said(options, replay::export_csv(reader, file_name(options.input), options.selection, std::move(output)));
}

int write_glb(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  expect_recorded(reader, options.input, options.time);
  const replay::RobotDescription robot =
      options.is_load_only ? replay::RobotDescription{} : find_robot(reader, options.input, options.urdf);
  const replay::GlbTotals totals = replay::export_glb(reader, file_name(options.input),
                                                      {options.time, options.is_load_only}, std::move(output), robot);
  return said(options, totals);
}

int write_moveit_scene(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  expect_recorded(reader, options.input, options.time);
  const replay::MoveItTotals totals =
      replay::export_moveit_scene(reader, file_name(options.input), options.time, std::move(output),
                                  find_robot(reader, options.input, options.urdf));
  return said(options, totals);
}

/// One format that can be asked for.
struct ExportFormat {
  std::string_view name;
  const char* description;  ///< for --help: what it is made from and who reads it
  int (*write)(const ExportOptions&, OutputFile);
};

constexpr std::array kFormats = {
    ExportFormat{"mcap", "a recording for Foxglove, Lichtblick and other viewers of MCAP", write_mcap},
    ExportFormat{"csv", "a recording as one table with the column names of mc_rtc logs", write_csv},
    ExportFormat{"glb", "an instant of a recording, or the load alone, as binary glTF for slides, Blender and viewers",
                 write_glb},
    ExportFormat{"moveit-scene",
                 "an instant of a recording as moveit_msgs/PlanningScene, YAML: what a planner must avoid",
                 write_moveit_scene},
    ExportFormat{"urscript", "a program for the controller of a UR robot (no other); needs --scenario", write_urscript},
    ExportFormat{"ros-trajectory",
                 "a program as trajectory_msgs/JointTrajectory and times of the outputs, YAML; needs --scenario",
                 write_ros_trajectory},
    ExportFormat{"mc-rtc-csv", "a program through the joints as a log of mc_rtc, CSV; needs --scenario",
                 write_mc_rtc_csv},
    ExportFormat{"mc-rtc-flat", "the same in the columnar form that mc_log_ui reads", write_mc_rtc_flat},
};

constexpr const char* kExportExamples = R"(
Examples:
  snug export run.h5 --format mcap -o run.mcap
  snug export run.h5 --format mcap --from 10 --to 20 --every 4 -o part.mcap
  snug export run.h5 --format csv -o run.csv
  snug export run.h5 --format glb --load -o load.glb
  snug export run.h5 --format moveit-scene --time 20 -o scene.yaml
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript -o program.script
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript --dry-run -o dry.script
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript --from-box BOX028 -o rest.script
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format ros-trajectory -o program.yaml
A program that was packed with fast motions is exported with its own timing, as simulated in the scenario's cell.)";

constexpr const char* kPrograms = "urscript ros-trajectory mc-rtc-csv mc-rtc-flat";

/// Options that only some formats have a use for: the formats, then the options.
constexpr std::array kOptionFormats = {
    std::array{"mcap csv", "--from --to --every"},
    std::array{"mcap", "--compression --encoding"},
    std::array{"mcap glb moveit-scene", "--urdf"},
    std::array{"glb moveit-scene", "--time"},
    std::array{"glb", "--load"},
    std::array{
        kPrograms,
        "--scenario --items --container --pallet --set --sequence --corrections --controller --tempo --unchecked"},
    std::array{"ros-trajectory", "--period"},
    std::array{"urscript",
               "--vacuum-output --blow-off-output --vacuum-input --vacuum-timeout --vent-time --part-input "
               "--part-timeout --payload-inertia --from-box --dry-run"},
};

std::vector<std::string> split_words(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

/// Throws InputError for an option that was given and means nothing to the format.
void refuse_without_effect(const Verb& verb, const std::string& format) {
  for (const auto& [names, options] : kOptionFormats) {
    const std::vector<std::string> formats = split_words(names);
    if (std::ranges::find(formats, format) != formats.end()) continue;
    for (const std::string& option : split_words(options)) {
      if (!verb.has(option.c_str())) continue;
      throw InputError("command line", option, "with --format " + format,
                       fmt::format("--format {}", fmt::join(formats, " or ")));
    }
  }
}

int run_export(const ExportOptions& options, const Verb& verb) {
  refuse_without_effect(verb, options.format);
  const auto found = std::ranges::find(kFormats, options.format, &ExportFormat::name);
  SNUG_CHECK(found != kFormats.end(), "a format that the parser accepts");
  if (options.scenario.empty() && options.changes.any()) {
    throw InputError("command line", "--items, --container, --pallet", "without --scenario", "a scenario to change");
  }
  NamedFiles inputs = {{"the input", options.input}};
  add_file(inputs, "--urdf", options.urdf);
  if (!options.scenario.empty()) add_file(inputs, "--scenario", options.scenario);
  for (NamedFile& items : name_all("--items", options.changes.items)) inputs.push_back(std::move(items));
  return found->write(options, reserve(inputs, options.output));
}

/// Single outputs and inputs, standard ones, in the place of those of the scenario.
void add_wiring(const Verb& verb, ExportOptions& options) {
  const auto add = [&](const char* name, std::optional<int>& number, const std::string& what) {
    verb.option(name, number, "N", "with urscript: " + what + " (default: robot.io of the scenario)", whole(0, 7));
  };
  add("--vacuum-output", options.wiring.vacuum_output, "standard digital output of the vacuum");
  add("--blow-off-output", options.wiring.blow_off_output, "standard digital output of the blow-off");
  add("--vacuum-input", options.wiring.vacuum_input, "standard digital input that is on while there is vacuum");
  add("--part-input", options.wiring.part_input, "standard digital input that is on while a box stands at the aligner");
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  std::vector<std::string> names;
  std::string footer = "Formats:\n";
  for (const ExportFormat& format : kFormats) {
    names.emplace_back(format.name);
    footer += fmt::format("  {:<16}{}\n", format.name, format.description);
  }
  const Verb verb(app, action, "export", "write a recording or a program in a format of other programs",
                  footer + kExportExamples);
  ExportOptions& options = verb.runs(run_export);
  verb.option("input", options.input, "FILE", "what to export").required();
  verb.option("--format", options.format, "NAME", "name of the format, see below", one_of(names)).required();
  verb.option("-o,--output", options.output, "FILE", "the file to write").required();
  add_selection(verb, options.selection);
  verb.option("--compression", options.compression, "NAME", "with mcap: zstd, or none for simple readers",
              one_of({"zstd", "none"}));
  verb.option("--encoding", options.encoding, "NAME",
              "with mcap: protobuf, or json, which is readable and several times as large",
              one_of({"protobuf", "json"}));
  verb.option("--scenario", options.scenario, "SCENARIO.yaml",
              "with a program: scenario with the robot, its limits and gains");
  add_scenario_changes(verb, options.changes);
  verb.option("--sequence", options.sequence, "NAME",
              "with a program: item sequence that it packs, with the boxes and their masses; refused if the program "
              "picks others (default: the first)");
  verb.option("--corrections", options.corrections, "LAYER", "with a program: a layer of the scenario, or none");
  verb.option("--controller", options.motion.controller, "KIND",
              "with a program: what it was made for, lagged or fast (default: as the program was packed)",
              one_of({"lagged", "fast"}));
  verb.option("--tempo", options.motion.tempo, "FRACTION",
              "with a program: fraction of the full speed, with fast (default: that of the program, or 1)",
              within(0.5, 1.0));
  verb.flag("--unchecked", options.is_unchecked,
            "with a program: write it without simulating it first; otherwise snug refuses it if the robot stops, no "
            "box is sealed or a box is lost");
  verb.option("--period", options.period, "SECONDS", "with ros-trajectory: longest time between points",
              within(1e-3, 100.0));
  add_wiring(verb, options);
  verb.option("--vacuum-timeout", options.script.vacuum_timeout, "SECONDS",
              "with urscript: the program halts if the vacuum has not changed by then", within(0.1, 600.0));
  verb.option("--vent-time", options.script.vent_time, "SECONDS",
              "with urscript: time from when the input reports that the vacuum fell until it is gone; a gauge in "
              "robot.io must confirm it",
              within(0.0, 60.0));
  verb.option("--part-timeout", options.script.part_timeout, "SECONDS",
              "with urscript: the program halts if no box stands at the aligner by then", within(0.1, 86400.0));
  verb.flag("--payload-inertia", options.script.has_inertia,
            "with urscript: payloads with inertia (set_target_payload, PolyScope 5.10 and later)");
  const OptionRow from_box = verb.option("--from-box", options.from_box, "BOX",
                                         "with urscript: begin with this box; those before it are packed already");
  verb.flag("--dry-run", options.script.is_dry,
            "with urscript: write straight moves 20 mm above the waypoints, at a quarter of their speed, without "
            "switching outputs")
      .excludes(from_box);
  verb.option("--time", options.time, "SECONDS", "with glb and moveit-scene: the instant (default: the end)", finite());
  verb.flag("--load", options.is_load_only, "with glb: only container and boxes, in the container's frame");
  verb.option("--urdf", options.urdf, "FILE.urdf",
              "with mcap, glb and moveit-scene: URDF with the looks of the robot and the place of its root (default: "
              "the file that the scenario names)");
}

}  // namespace snug::app
