// What became of a load that was shaken, for people and programs.
#include "snug/runs/shake_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"
#include "snug/report/page.hpp"
#include "snug/report/plan_view.hpp"
#include "snug/report/table.hpp"

namespace snug::runs {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kBeyondWalls = 0.1;  ///< m, beyond which a box of a recording is not of the load

const ShakenBox& worst_shaken_box(const ShakeRun& run) {
  return *std::ranges::max_element(run.boxes, {}, [](const ShakenBox& box) {
    return box.fell ? std::numeric_limits<double>::infinity() : box.part;
  });
}

int count_moved_boxes(const ShakeRun& run) {
  return static_cast<int>(
      std::ranges::count_if(run.boxes, [](const ShakenBox& box) { return box.fell || box.part > 1.0; }));
}

/// "20 mm or 6 degrees".
std::string describe_limits(const ShakeResult& result, const ShakeWords& words, const char* link) {
  std::string text = fmt::format("{:g} mm", std::round(1e4 * result.shift) / 10.0);
  if (std::isfinite(result.remaining)) text += fmt::format(" ({:g} mm in the end)", std::round(1e3 * result.remaining));
  return text + fmt::format(" {} {:g} degrees", link, words.tilt_deg);
}

/// Of each motion the friction with which it went worst, in the order of the profile.
std::vector<const ShakeRun*> worst_of_shaken_motions(const ShakeResult& result) {
  std::vector<const ShakeRun*> worst;
  for (const ShakeRun& run : result.runs) {
    if (worst.empty() || worst.back()->motion != run.motion) {
      worst.push_back(&run);
    } else if (run.worst > worst.back()->worst) {
      worst.back() = &run;
    }
  }
  return worst;
}

report::Markup shaken_from_above(const ShakeResult& result, const std::vector<Pose>& X_TP) {
  std::vector<report::BoxOutline> outlines;
  for (std::size_t i = 0; i < X_TP.size(); ++i) {
    outlines.push_back(report::outline_of(result.boxes[i], result.sizes[i], X_TP[i]));
  }
  return report::plan_view(result.inner_size, outlines);
}

/// From the side: y of the drawing is up.
report::Markup shaken_from_the_side(const ShakeResult& result, const std::vector<Pose>& X_TP) {
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

}  // namespace

/// What lies in the target in the last frame.
RecordedLoad load_recorded(const std::string& path) {
  record::RecordingReader reader(path);
  if (reader.times().empty()) throw InputError(path, "", "a recording without frames", "at least one frame");
  if (reader.header().scenario_text.empty()) throw InputError(path, "", "a recording without scenario", "one with it");
  RecordedLoad load{model::parse_scenario(reader.header().scenario_text, "scenario of " + path), {}};
  const model::Container* container = model::find_container(load.scenario, load.scenario.target);
  if (container == nullptr) throw InputError(path, "target", "nothing", "a scenario with a container");
  record::Frame frame;
  reader.read_frame(reader.frame_count() - 1, frame);
  const Vector3 half = 0.5 * container->inner_size + Vector3::Constant(kBeyondWalls);
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

std::string shake_verdict(const ShakeResult& result, const ShakeWords& words) {
  if (result.holds())
    return fmt::format("holds: {} boxes within {}", result.boxes.size(), describe_limits(result, words, "and"));
  const ShakeRun& run = result.runs[result.worst];
  const ShakenBox& box = worst_shaken_box(run);
  return fmt::format(
      "does not hold: {} of {} boxes beyond {} in '{}', friction x {:.2f}; worst {} ({})", count_moved_boxes(run),
      result.boxes.size(), describe_limits(result, words, "or"), run.motion, run.friction, box.id,
      box.fell ? std::string("falls") : fmt::format("{:.0f} mm, {:.1f} degrees", 1e3 * box.shift, kDegrees * box.tilt));
}

std::string format_shake_text(const ShakeResult& result, const ShakeWords& words) {
  const std::string layers = result.film_layers > 0
                                 ? fmt::format(" of {} layer{}", result.film_layers, result.film_layers == 1 ? "" : "s")
                                 : std::string();
  std::string text = fmt::format("load {}, profile {}, hold {}{}, {} boxes\n\n", words.load, words.profile, words.hold,
                                 layers, result.boxes.size());
  text += fmt::format("{:<34} {:>8} {:>9} {:>9} {:>9}  {}\n", "motion", "friction", "shift, mm", "left, mm",
                      "tilt, deg", "worst box");
  for (const ShakeRun* run : worst_of_shaken_motions(result)) {
    const ShakenBox& box = worst_shaken_box(*run);
    text += fmt::format("{:<34} {:>8.2f} {:>9.1f} {:>9.1f} {:>9.1f}  {}{}\n", run->motion, run->friction,
                        1e3 * box.shift, 1e3 * box.remaining, kDegrees * box.tilt, box.id, box.fell ? " falls" : "");
  }
  return text + "\n" + shake_verdict(result, words) + "\n";
}

std::string format_shake_json(const ShakeResult& result, const ShakeWords& words) {
  Json json{{"holds", result.holds()},      {"verdict", shake_verdict(result, words)}, {"profile", words.profile},
            {"hold", words.hold},           {"max_shift_mm", 1e3 * result.shift},      {"max_tilt_deg", words.tilt_deg},
            {"simulated_s", result.seconds}};
  if (result.film_layers > 0) json["film_layers"] = result.film_layers;
  for (const ShakeRun& run : result.runs) {
    Json one{{"motion", run.motion},
             {"friction", run.friction},
             {"sound", run.is_sound},
             {"steps", run.steps},
             {"boxes", Json::array()}};
    for (const ShakenBox& box : run.boxes) {
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

std::string format_shake_page(const ShakeResult& result, const ShakeWords& words) {
  const ShakeRun& run = result.runs[result.worst];
  report::Markup content = report::paragraph(report::bold(shake_verdict(result, words)));
  content += report::heading(2, fmt::format("The worst moment: {:.2f} s into '{}', friction x {:.2f}", run.worst_time,
                                            run.motion, run.friction));
  content +=
      report::side_by_side({report::figure("From above", shaken_from_above(result, run.worst_X_TP)),
                            report::figure("From the side, along x", shaken_from_the_side(result, run.worst_X_TP))});
  report::Table table{
      {{"motion", true}, {"friction"}, {"shift, mm"}, {"left, mm"}, {"tilt, deg"}, {"worst box", true}}, {}, {}};
  for (const ShakeRun* one : worst_of_shaken_motions(result)) {
    const ShakenBox& box = worst_shaken_box(*one);
    table.rows.push_back({one->motion, report::number(one->friction, 2), report::number(1e3 * box.shift, 1),
                          report::number(1e3 * box.remaining, 1), report::number(kDegrees * box.tilt, 1),
                          box.id + (box.fell ? " falls" : "")});
  }
  content += report::heading(2, "Every motion, with its worst friction") + report::as_markup(table);
  return report::make_page("Transport: " + words.load, content);
}

}  // namespace snug::runs
