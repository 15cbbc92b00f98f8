// shake: drives a packed container and says which boxes shift, tip or fall.
#include "apps/snug/shake/shake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/write_file.hpp"
#include "snug/record/reader.hpp"
#include "snug/report/page.hpp"
#include "snug/report/plan_view.hpp"
#include "snug/report/table.hpp"
#include "snug/runs/shake.hpp"

namespace snug::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kWalls = 0.1;  ///< m, beyond which a box of a recording is not of the load

struct Load {
  model::Scenario scenario;
  std::vector<model::PlacementEntry> boxes;
};

/// What lies in the target in the last frame.
Load load_recorded(const std::string& path) {
  record::RecordingReader reader(path);
  if (reader.times().empty()) throw InputError(path, "", "a recording without frames", "at least one frame");
  if (reader.header().scenario_text.empty()) throw InputError(path, "", "a recording without scenario", "one with it");
  Load load{model::parse_scenario(reader.header().scenario_text, "scenario of " + path), {}};
  const model::Container* container = model::find_container(load.scenario, load.scenario.target);
  if (container == nullptr) throw InputError(path, "target", "nothing", "a scenario with a container");
  record::Frame frame;
  reader.read_frame(reader.frame_count() - 1, frame);
  const Vector3 half = 0.5 * container->inner_size + Vector3::Constant(kWalls);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const std::string& name = reader.header().bodies[i].name;
    if (!frame.bodies[i].present || model::find_parcel(load.scenario, name) == nullptr) continue;
    const Pose X_TP = container->X_WT.inverse() * frame.bodies[i].X_WB.pose();
    if ((X_TP.p.head<2>().cwiseAbs().array() > half.head<2>().array()).any() || X_TP.p.z() < 0.0) continue;
    load.boxes.push_back({name, X_TP, 0});
  }
  if (load.boxes.empty()) throw InputError(path, "", "no box in the container in the end", "a load");
  return load;
}

Load load_of(const ShakeOptions& options) {
  if (std::filesystem::path(options.load).extension() == ".h5") {
    if (options.scenario || options.changes.any()) {
      throw InputError("command line", "--scenario", "a scenario beside a recording", "none: a recording has its own");
    }
    return load_recorded(options.load);
  }
  if (!options.scenario) {
    throw InputError("command line", "--scenario", "nothing", "the scenario of the placements " + options.load);
  }
  Load load{load_changed(*options.scenario, options.changes), {}};
  load.boxes = model::load_placements(find_shipped(options.load), load.scenario);
  return load;
}

std::vector<runs::ShakeMotion> profile_of(const ShakeOptions& options, const model::Scenario& scenario) {
  if (std::filesystem::path(options.profile).extension() == ".csv") return runs::load_shake_profile(options.profile);
  const model::Container* container = model::find_container(scenario, scenario.target);
  runs::ShakeProfileOptions profile;
  profile.level = options.level;
  if (container != nullptr) profile.size = container->inner_size;
  return runs::make_shake_profile(options.profile, profile);
}

runs::ShakeOptions run_options(const ShakeOptions& options) {
  runs::ShakeOptions run;
  for (const runs::LoadHold hold : {runs::LoadHold::None, runs::LoadHold::Film, runs::LoadHold::Straps}) {
    if (options.hold == runs::name_of(hold)) run.hold = hold;
  }
  run.draws = options.draws;
  run.seed = options.seed;
  run.shift = 1e-3 * options.shift;
  run.tilt = options.tilt / kDegrees;
  run.time_step = options.time_step;
  run.threads = options.threads.value_or(core_count());
  return run;
}

const runs::ShakenBox& worst_box(const runs::ShakeRun& run, const ShakeOptions& options) {
  return *std::ranges::max_element(run.boxes, {}, [&](const runs::ShakenBox& box) {
    return box.fell ? std::numeric_limits<double>::infinity()
                    : std::max(1e3 * box.shift / options.shift, kDegrees * box.tilt / options.tilt);
  });
}

int moved_boxes(const runs::ShakeRun& run, const ShakeOptions& options) {
  return static_cast<int>(std::ranges::count_if(run.boxes, [&](const runs::ShakenBox& box) {
    return box.fell || 1e3 * box.shift > options.shift || kDegrees * box.tilt > options.tilt;
  }));
}

/// Of each motion the friction with which it went worst, in the order of the profile.
std::vector<const runs::ShakeRun*> worst_of_motions(const runs::ShakeResult& result) {
  std::vector<const runs::ShakeRun*> worst;
  for (const runs::ShakeRun& run : result.runs) {
    if (worst.empty() || worst.back()->motion != run.motion) {
      worst.push_back(&run);
    } else if (run.worst > worst.back()->worst) {
      worst.back() = &run;
    }
  }
  return worst;
}

std::string verdict_of(const runs::ShakeResult& result, const ShakeOptions& options) {
  if (result.holds())
    return fmt::format("holds: {} boxes within {:g} mm and {:g} degrees", result.boxes.size(), options.shift,
                       options.tilt);
  const runs::ShakeRun& run = result.runs[result.worst];
  const runs::ShakenBox& box = worst_box(run, options);
  return fmt::format(
      "does not hold: {} of {} boxes beyond {:g} mm or {:g} degrees in '{}', friction x {:.2f}; worst {} ({})",
      moved_boxes(run, options), result.boxes.size(), options.shift, options.tilt, run.motion, run.friction, box.id,
      box.fell ? std::string("falls") : fmt::format("{:.0f} mm, {:.1f} degrees", 1e3 * box.shift, kDegrees * box.tilt));
}

std::string format_text(const runs::ShakeResult& result, const ShakeOptions& options) {
  std::string text = fmt::format("load {}, profile {}, hold {}, {} boxes\n\n", options.load, options.profile,
                                 options.hold, result.boxes.size());
  text += fmt::format("{:<34} {:>8} {:>9} {:>9} {:>9}  {}\n", "motion", "friction", "shift, mm", "left, mm",
                      "tilt, deg", "worst box");
  for (const runs::ShakeRun* run : worst_of_motions(result)) {
    const runs::ShakenBox& box = worst_box(*run, options);
    text += fmt::format("{:<34} {:>8.2f} {:>9.1f} {:>9.1f} {:>9.1f}  {}{}\n", run->motion, run->friction,
                        1e3 * box.shift, 1e3 * box.remaining, kDegrees * box.tilt, box.id, box.fell ? " falls" : "");
  }
  return text + "\n" + verdict_of(result, options) + "\n";
}

std::string format_json(const runs::ShakeResult& result, const ShakeOptions& options) {
  Json json{{"holds", result.holds()},      {"verdict", verdict_of(result, options)}, {"profile", options.profile},
            {"hold", options.hold},         {"max_shift_mm", options.shift},          {"max_tilt_deg", options.tilt},
            {"simulated_s", result.seconds}};
  for (const runs::ShakeRun& run : result.runs) {
    Json one{{"motion", run.motion}, {"friction", run.friction}, {"sound", run.is_sound}, {"boxes", Json::array()}};
    for (const runs::ShakenBox& box : run.boxes) {
      one["boxes"].push_back({{"box", box.id},
                              {"shift_mm", 1e3 * box.shift},
                              {"remaining_mm", 1e3 * box.remaining},
                              {"tilt_deg", kDegrees * box.tilt},
                              {"fell", box.fell}});
    }
    json["runs"].push_back(std::move(one));
  }
  return json.dump(2) + "\n";
}

report::Markup view_of(const runs::ShakeResult& result, const std::vector<Pose>& X_TP) {
  std::vector<report::BoxOutline> outlines;
  for (std::size_t i = 0; i < X_TP.size(); ++i) {
    outlines.push_back(report::outline_of(result.boxes[i], result.sizes[i], X_TP[i]));
  }
  return report::plan_view(result.inner_size, outlines);
}

/// From the side: y of the drawing is up.
report::Markup side_view_of(const runs::ShakeResult& result, const std::vector<Pose>& X_TP) {
  Matrix3 R_VT;  // V: x along Ty, y along Tz, seen along Tx
  R_VT << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0;
  const Vector3 size = R_VT * result.inner_size;
  std::vector<report::BoxOutline> outlines;
  for (std::size_t i = 0; i < X_TP.size(); ++i) {
    Pose X_VP{R_VT * X_TP[i].R, R_VT * X_TP[i].p};
    X_VP.p.y() -= 0.5 * size.y();
    outlines.push_back(report::outline_of(result.boxes[i], result.sizes[i], X_VP));
  }
  return report::plan_view(size, outlines);
}

std::string format_page(const runs::ShakeResult& result, const ShakeOptions& options) {
  const runs::ShakeRun& run = result.runs[result.worst];
  report::Markup content = report::paragraph(report::bold(verdict_of(result, options)));
  content += report::heading(2, fmt::format("The worst moment: {:.2f} s into '{}', friction x {:.2f}", run.worst_time,
                                            run.motion, run.friction));
  content += report::side_by_side({report::figure("From above", view_of(result, run.worst_X_TP)),
                                   report::figure("From the side, along x", side_view_of(result, run.worst_X_TP))});
  report::Table table{
      {{"motion", true}, {"friction"}, {"shift, mm"}, {"left, mm"}, {"tilt, deg"}, {"worst box", true}}, {}, {}};
  for (const runs::ShakeRun* one : worst_of_motions(result)) {
    const runs::ShakenBox& box = worst_box(*one, options);
    table.rows.push_back({one->motion, report::number(one->friction, 2), report::number(1e3 * box.shift, 1),
                          report::number(1e3 * box.remaining, 1), report::number(kDegrees * box.tilt, 1),
                          box.id + (box.fell ? " falls" : "")});
  }
  content += report::heading(2, "Every motion, with the friction with which it went worst") + report::as_markup(table);
  return report::make_page("Transport: " + options.load, content);
}

}  // namespace

int run_shake(const ShakeOptions& options) {
  const Load load = load_of(options);
  NamedFiles inputs;
  if (options.scenario) inputs = files_of(*options.scenario, options.changes, load.scenario);
  add_file(inputs, "the load", options.load);
  std::optional<OutputFile> page = reserve(inputs, options.page);
  const std::vector<runs::ShakeMotion> profile = profile_of(options, load.scenario);
  const runs::ShakeResult result = runs::shake(load.scenario, load.boxes, profile, run_options(options));
  if (page) write_file(std::move(*page), format_page(result, options));
  print(options.json ? format_json(result, options) : format_text(result, options));
  return result.holds() ? kSuccess : kRunFailed;
}

}  // namespace snug::app
