// export: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/export/export.hpp"
#include "apps/snug/report/report.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

constexpr const char* kExportExamples = R"(
Examples:
  snug export run.h5 --format mcap -o run.mcap
  snug export run.h5 --format mcap --from 10 --to 20 --every 4 -o part.mcap
  snug export run.h5 --format csv -o run.csv
  snug export run.h5 --format glb --load -o load.glb
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript -o program.script
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript --dry-run -o dry.script
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript --from-box BOX028 -o rest.script
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format ros-trajectory -o program.yaml
A program that was packed with fast motions is exported with its own timing, as it is simulated in the scenario's cell.)";

constexpr const char* kPrograms = "urscript ros-trajectory mc-rtc-csv mc-rtc-flat";

/// Options that some formats have no use for, and the formats that have. Of a recording: those that choose its frames.
struct OptionFormats {
  const char* option;
  const char* formats;
};
constexpr std::array kOptionFormats = {
    OptionFormats{"--from", "mcap csv"},
    OptionFormats{"--to", "mcap csv"},
    OptionFormats{"--every", "mcap csv"},
    OptionFormats{"--compression", "mcap"},
    OptionFormats{"--urdf", "mcap glb"},
    OptionFormats{"--time", "glb"},
    OptionFormats{"--load", "glb"},
    OptionFormats{"--scenario", kPrograms},
    OptionFormats{"--items", kPrograms},
    OptionFormats{"--container", kPrograms},
    OptionFormats{"--pallet", kPrograms},
    OptionFormats{"--set", kPrograms},
    OptionFormats{"--sequence", kPrograms},
    OptionFormats{"--corrections", kPrograms},
    OptionFormats{"--controller", kPrograms},
    OptionFormats{"--tempo", kPrograms},
    OptionFormats{"--unchecked", kPrograms},
    OptionFormats{"--period", "ros-trajectory"},
    OptionFormats{"--vacuum-output", "urscript"},
    OptionFormats{"--blow-off-output", "urscript"},
    OptionFormats{"--vacuum-input", "urscript"},
    OptionFormats{"--vacuum-timeout", "urscript"},
    OptionFormats{"--vent-time", "urscript"},
    OptionFormats{"--part-input", "urscript"},
    OptionFormats{"--part-timeout", "urscript"},
    OptionFormats{"--payload-inertia", "urscript"},
    OptionFormats{"--from-box", "urscript"},
    OptionFormats{"--dry-run", "urscript"},
};

/// Throws InputError for an option that was given and means nothing to the format.
void refuse_without_effect(const CLI::App& verb, const std::string& format) {
  for (const OptionFormats& entry : kOptionFormats) {
    if (verb.get_option(entry.option)->count() == 0) continue;
    const std::vector<std::string> formats = CLI::detail::split(entry.formats, ' ');
    if (std::ranges::find(formats, format) != formats.end()) continue;
    throw InputError("command line", entry.option, "with --format " + format,
                     "--format " + CLI::detail::join(formats, " or "));
  }
}

/// Single outputs and inputs, standard ones, in the place of those of the scenario.
void add_wiring(CLI::App& verb, ExportOptions& options) {
  const auto add = [&](const char* name, std::optional<int>& number, const std::string& what) {
    verb.add_option(name, number, "of urscript: " + what + " (default: robot.io of the scenario)")
        ->check(whole(0, 7))
        ->type_name("N");
  };
  add("--vacuum-output", options.vacuum_output, "standard digital output of the vacuum");
  add("--blow-off-output", options.blow_off_output, "standard digital output of the blow-off");
  add("--vacuum-input", options.vacuum_input, "standard digital input that is on while there is vacuum");
  add("--part-input", options.part_input, "standard digital input that is on while a box stands at the aligner");
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("export", "write a recording or a program in a format of other programs");
  const auto options = std::make_shared<ExportOptions>();
  const auto compression = std::make_shared<std::string>("zstd");
  std::vector<std::string> names;
  std::string footer = "Formats:\n";
  for (const ExportFormat& format : export_formats()) {
    names.emplace_back(format.name);
    footer += std::string("  ") + format.name + std::string(16 - names.back().size(), ' ') + format.description + "\n";
  }
  verb.add_option("input", options->input, "what to export")->required()->type_name("FILE");
  verb.add_option("--format", options->format, "name of the format, see below")
      ->required()
      ->check(one_of(names))
      ->type_name("NAME");
  verb.add_option("-o,--output", options->output, "the file to write")->required()->type_name("FILE");
  add_selection_options(verb, options->selection);
  verb.add_option("--compression", *compression, "of mcap: zstd, or none for readers that cannot unpack it")
      ->check(one_of({"zstd", "none"}))
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--scenario", options->scenario, "of a program: scenario file with the robot, its limits and gains")
      ->type_name("SCENARIO.yaml");
  add_scenario_changes(verb, options->changes);
  verb.add_option(
          "--sequence", options->sequence,
          "of a program: item sequence that it packs: which boxes it carries, and their masses; refused where it picks "
          "others (default: the first)")
      ->type_name("NAME");
  verb.add_option("--corrections", options->corrections, "of a program: a layer of the scenario, or none")
      ->type_name("LAYER")
      ->capture_default_str();
  verb.add_option("--controller", options->motion.controller,
                  "of a program: what it was made for, lagged or fast (default: as the program was packed)")
      ->check(one_of({"lagged", "fast"}))
      ->type_name("KIND");
  verb.add_option("--tempo", options->motion.tempo,
                  "of a program: fraction of the speeds, with fast (default: that it was packed with, or 1)")
      ->check(within(0.5, 1.0))
      ->type_name("FRACTION");
  verb.add_flag(
      "--unchecked", options->is_unchecked,
      "of a program: write it without simulating it first; otherwise it is refused where the robot stops, no box is "
      "sealed or a box is lost");
  verb.add_option("--period", options->period, "of ros-trajectory: time between points at most")
      ->check(within(1e-3, 100.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  add_wiring(verb, *options);
  verb.add_option("--vacuum-timeout", options->script.vacuum_timeout,
                  "of urscript: the program halts when the vacuum has not changed by then")
      ->check(within(0.1, 600.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--vent-time", options->script.vent_time,
                  "of urscript: from when the input says that the vacuum fell until it is gone; where robot.io has a "
                  "gauge, that has to say so as well")
      ->check(within(0.0, 60.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--part-timeout", options->script.part_timeout,
                  "of urscript: the program halts when no box stands at the aligner by then")
      ->check(within(0.1, 86400.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_flag(
      "--payload-inertia", options->script.has_inertia,
      "of urscript: payloads with inertia, changed over 0.1 s (set_target_payload, PolyScope 5.10 and later)");
  CLI::Option* from_box = verb.add_option("--from-box", options->from_box,
                                          "of urscript: begin with this box: those before it lie where they belong")
                              ->type_name("BOX");
  verb.add_flag("--dry-run", options->script.is_dry,
                "of urscript: rows as straight moves 20 mm higher, at a quarter of their speed, nothing switched")
      ->excludes(from_box);
  verb.add_option("--time", options->time, "of glb: the instant (default: the end)")
      ->check(finite())
      ->type_name("SECONDS");
  verb.add_flag("--load", options->is_load_only,
                "of glb: only the container and the boxes in it, in the container's frame");
  verb.add_option("--urdf", options->urdf,
                  "of mcap and glb: how the robot in it looks (default: the file that its scenario names)")
      ->type_name("FILE.urdf");
  verb.footer(footer + kExportExamples);
  verb.callback([options, compression, &verb, &action] {
    refuse_without_effect(verb, options->format);
    action = [options, compression] {
      options->compression = *compression == "none" ? replay::McapCompression::None : replay::McapCompression::Zstd;
      return run_export(*options);
    };
  });
}

}  // namespace snug::app
