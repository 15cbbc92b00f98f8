// Plot: quantities of recordings over time, as a figure.
#include "snug/replay/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/replay/limits.hpp"

namespace snug::replay {
namespace {

using record::Frame;

constexpr double kMm = 1.0e3;
constexpr const char* kPosePrefix = "pose:";

/// One line of a panel: how to read it off a frame.
struct Line {
  std::string label;
  std::function<double(const Frame&)> value;
};

struct PanelPlan {
  std::string y_label;
  std::vector<Line> lines;
};

std::vector<Line> xyz_lines(const std::string& symbol, double scale, std::function<Vector3(const Frame&)> vector) {
  std::vector<Line> lines;
  for (int i = 0; i < 3; ++i) {
    lines.push_back({symbol + "xyz"[i], [=](const Frame& frame) { return scale * vector(frame)[i]; }});
  }
  return lines;
}

std::vector<PanelPlan> wrench_panels(const char* on, const std::string& frame_letter,
                                     const std::function<Wrench(const Frame&)>& wrench) {
  return {{fmt::format("force {} [N]", on),
           xyz_lines("F" + frame_letter, 1.0, [=](const Frame& frame) { return wrench(frame).force; })},
          {fmt::format("torque {} [Nm]", on),
           xyz_lines("M" + frame_letter, 1.0, [=](const Frame& frame) { return wrench(frame).torque; })}};
}

double only_attached(const Frame& frame, double value) { return frame.cup.attached_body < 0 ? kNaN : value; }

std::vector<PanelPlan> tool_panels() {
  std::vector<Line> lines = xyz_lines("", 1.0, [](const Frame& frame) { return frame.X_WE.p; });
  return {{"tool position in W [m]", lines}};
}

std::vector<PanelPlan> error_panels() {
  return {{"distance to command [mm]",
           {{"tool", [](const Frame& frame) { return kMm * (frame.X_WE.p - frame.X_WE_command.p).norm(); }}}},
          {"angle to command [deg]", {{"tool", [](const Frame& frame) {
                                         return kDegrees * frame.X_WE.quat.normalized().angularDistance(
                                                               frame.X_WE_command.quat.normalized());
                                       }}}}};
}

std::vector<PanelPlan> speed_panels() {
  return {{"tool speed [m/s]", {{"tool", [](const Frame& frame) { return frame.V_WE.linear.norm(); }}}},
          {"turning speed [rad/s]", {{"tool", [](const Frame& frame) { return frame.V_WE.angular.norm(); }}}}};
}

std::vector<PanelPlan> cup_panels() {
  return {
      {"cup length [mm]",
       {{"E to S along z", [](const Frame& frame) { return only_attached(frame, kMm * frame.cup.length); }}}},
      {"cup bend [deg]",
       {{"between z of E and S", [](const Frame& frame) { return only_attached(frame, kDegrees * frame.cup.bend); }}}}};
}

/// Pose of the lip in the control point's frame: all six numbers of what `cup` tells two of.
std::vector<PanelPlan> deformation_panels() {
  const auto only_held = [](const Frame& frame, const Vector3& v) -> Vector3 {
    return frame.cup.attached_body < 0 ? Vector3::Constant(kNaN) : v;
  };
  std::vector<Line> aside = xyz_lines("", kMm, [=](const Frame& frame) { return only_held(frame, frame.cup.X_ES.p); });
  const std::vector<Line> along = {aside[2]};
  aside.pop_back();
  return {{"lip along z of E [mm]", along},
          {"lip aside in E [mm]", aside},
          {"turn of the lip in E [deg]", xyz_lines("", kDegrees, [=](const Frame& frame) {
             const Eigen::AngleAxisd turn(frame.cup.X_ES.quat.normalized());
             return only_held(frame, turn.angle() * turn.axis());
           })}};
}

std::vector<PanelPlan> joint_panels(const record::RecordingHeader& header, const std::string& source) {
  if (header.joints.empty()) {
    throw InputError(source, "--what", "'joints' of a recording without a robot", "a run with --robot");
  }
  const auto lines = [&](double record::JointSample::*part) {
    std::vector<Line> all;
    for (std::size_t i = 0; i < header.joints.size(); ++i) {
      all.push_back({header.joints[i], [i, part](const Frame& frame) { return frame.joints[i].*part; }});
    }
    return all;
  };
  return {{"joint position [rad]", lines(&record::JointSample::position)},
          {"joint speed [rad/s]", lines(&record::JointSample::velocity)},
          {"joint torque [Nm]", lines(&record::JointSample::torque)}};
}

/// What is near 100 % is what binds. Without a robot its two panels are empty.
std::vector<PanelPlan> limit_panels(const PlotSource& source) {
  constexpr double kPercent = 100.0;
  const record::RecordingHeader& header = source.reader->header();
  const std::optional<JointUseLimits> limits = joint_limits_of(header, source.urdf);
  if (!limits && !header.joints.empty()) {
    throw InputError(source.name, "--what limits", "a robot whose limits are not known here", "its URDF: --urdf");
  }
  const auto hold = std::make_shared<HoldUse>(header);
  PanelPlan speeds{"joint speed [% of limit]", {}}, torques{"joint torque [% of limit]", {}};
  for (std::size_t i = 0; i < header.joints.size(); ++i) {
    speeds.lines.push_back({header.joints[i], [i, most = limits->speed[i]](const Frame& frame) {
                              return kPercent * std::abs(frame.joints[i].velocity) / most;
                            }});
    torques.lines.push_back({header.joints[i], [i, most = limits->torque[i]](const Frame& frame) {
                               return kPercent * std::abs(frame.joints[i].torque) / most;
                             }});
  }
  return {{"hold of the cup used [%]", {{"cup", [hold](const Frame& frame) { return kPercent * hold->next(frame); }}}},
          std::move(speeds),
          std::move(torques)};
}

std::vector<PanelPlan> vacuum_panels() {
  return {{"pressure, gauge [kPa]", {{"cup", [](const Frame& frame) { return 1e-3 * frame.cup.pressure_gauge; }}}},
          {"command [0 or 1]",
           {{"vacuum", [](const Frame& frame) { return frame.cup.vacuum_command ? 1.0 : 0.0; }},
            {"blow-off", [](const Frame& frame) { return frame.cup.blow_off_command ? 1.0 : 0.0; }}}}};
}

std::vector<PanelPlan> contact_panels() {
  return {{"contact points [1]",
           {{"all pairs", [](const Frame& frame) { return static_cast<double>(frame.contacts.size()); }}}},
          {"largest contact force [N]", {{"one point", [](const Frame& frame) {
                                            double largest = 0.0;
                                            for (const record::ContactSample& contact : frame.contacts) {
                                              largest = std::max(largest, contact.force_B_W.norm());
                                            }
                                            return largest;
                                          }}}}};
}

std::vector<PanelPlan> solver_panels() {
  return {{"residual [mm/s]", {{"contact solver", [](const Frame& frame) { return kMm * frame.solver.residual; }}}},
          {"sweeps [1]",
           {{"contact solver", [](const Frame& frame) { return static_cast<double>(frame.solver.iterations); }}}}};
}

std::vector<PanelPlan> pose_panels(const record::RecordingHeader& header, const std::string& body,
                                   const std::string& source) {
  const int index = record::find_body(header, body);
  if (index < 0) {
    std::vector<std::string> names;
    for (const record::BodyInfo& info : header.bodies) names.push_back(info.name);
    const std::string_view nearest = find_nearest(body, names);
    throw InputError(source, "--what pose:NAME", "'" + body + "'",
                     nearest.empty() ? fmt::format("one of {}", fmt::join(names, ", "))
                                     : fmt::format("a body; did you mean {}?", nearest));
  }
  const auto at = static_cast<std::size_t>(index);
  const auto coefficient = [at](int i) {
    // The sign that has w > 0 would jump at half turns; the panel is drawn from continuous signs (see sample).
    return [at, i](const Frame& frame) {
      const Quaternion& q = frame.bodies[at].X_WB.quat;
      return frame.bodies[at].present ? (i == 0 ? q.w() : q.vec()[i - 1]) : kNaN;
    };
  };
  return {{body + " position in W [m]", xyz_lines("", 1.0,
                                                  [at](const Frame& frame) -> Vector3 {
                                                    if (!frame.bodies[at].present) return Vector3::Constant(kNaN);
                                                    return frame.bodies[at].X_WB.p;
                                                  })},
          {"quaternion, body to W [1]",
           {{"qx", coefficient(1)}, {"qy", coefficient(2)}, {"qz", coefficient(3)}, {"qw", coefficient(0)}}}};
}

std::vector<PanelPlan> panels_of(const std::string& word, const PlotSource& from) {
  const record::RecordingHeader& header = from.reader->header();
  const std::string& source = from.name;
  if (word == "wrench") {
    return wrench_panels("of the cup in S", "", [](const Frame& frame) { return frame.cup.F_PSo_S; });
  }
  if (word == "flange")
    return wrench_panels("on the flange in F", "", [](const Frame& frame) { return frame.F_flange; });
  if (word == "tool") return tool_panels();
  if (word == "error") return error_panels();
  if (word == "speed") return speed_panels();
  if (word == "cup") return cup_panels();
  if (word == "deformation") return deformation_panels();
  if (word == "vacuum") return vacuum_panels();
  if (word == "joints") return joint_panels(header, source);
  if (word == "limits") return limit_panels(from);
  if (word == "contacts") return contact_panels();
  if (word == "solver") return solver_panels();
  if (word.starts_with(kPosePrefix)) return pose_panels(header, word.substr(std::string(kPosePrefix).size()), source);
  std::vector<std::string> words = plot_words();
  const std::string_view nearest = find_nearest(word, words);
  throw InputError("command line", "--what", "'" + word + "'",
                   fmt::format("one of {}, pose:BODY{}", fmt::join(words, ", "),
                               nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

/// Values of all lines of all panels, of one recording.
struct Samples {
  std::vector<double> times;
  std::vector<std::vector<double>> values;  ///< by line, panels one after the other
  std::vector<std::pair<double, double>> held;
};

/// Quaternions come with either sign: keep each body's continuous.
void make_continuous(Frame& frame, std::vector<Quaternion>& last) {
  last.resize(frame.bodies.size(), Quaternion::Identity());
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    if (!frame.bodies[i].present) continue;
    Quaternion& quat = frame.bodies[i].X_WB.quat;
    if (quat.dot(last[i]) < 0.0) quat.coeffs() = -quat.coeffs();
    last[i] = quat;
  }
}

Samples sample(const PlotSource& source, const std::vector<PanelPlan>& plans, const Selection& selection) {
  Samples samples;
  std::size_t lines = 0;
  for (const PanelPlan& plan : plans) lines += plan.lines.size();
  samples.values.resize(lines);
  Frame frame;
  std::vector<Quaternion> last;
  bool was_held = false;
  for (const std::size_t index : select_frames(*source.reader, source.name, selection)) {
    source.reader->read_frame(index, frame);
    make_continuous(frame, last);
    samples.times.push_back(frame.time);
    std::size_t line = 0;
    for (const PanelPlan& plan : plans) {
      for (const Line& one : plan.lines) samples.values[line++].push_back(one.value(frame));
    }
    const bool is_held = frame.cup.attached_body >= 0;
    if (is_held && !was_held) samples.held.emplace_back(frame.time, frame.time);
    if (is_held) samples.held.back().second = frame.time;
    was_held = is_held;
  }
  return samples;
}

}  // namespace

const std::vector<std::string>& plot_words() {
  static const std::vector<std::string> words = {"wrench",      "flange", "tool",     "error",  "speed",  "cup",
                                                 "deformation", "vacuum", "contacts", "solver", "joints", "limits"};
  return words;
}

report::Figure make_plot(std::span<const PlotSource> sources, const std::vector<std::string>& what,
                         const Selection& selection) {
  report::Figure figure;
  figure.x_label = "time [s]";
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const record::RecordingHeader& header = sources[k].reader->header();
    std::vector<PanelPlan> plans;
    for (const std::string& word : what) {
      for (PanelPlan& plan : panels_of(word, sources[k])) plans.push_back(std::move(plan));
    }
    const Samples samples = sample(sources[k], plans, selection);
    figure.description += fmt::format("{}{}: snug {}, sequence '{}', seed {}", k == 0 ? "" : "; ", sources[k].name,
                                      header.version, header.sequence, header.seed);
    figure.panels.resize(plans.size());
    std::size_t line = 0;
    for (std::size_t i = 0; i < plans.size(); ++i) {
      report::Panel& panel = figure.panels[i];
      panel.y_label = plans[i].y_label;
      if (k == 0) panel.bands = samples.held;
      panel.band_label = "box held";
      for (std::size_t j = 0; j < plans[i].lines.size(); ++j, ++line) {
        const std::string suffix = sources.size() > 1 ? ", " + sources[k].name : "";
        panel.curves.push_back(
            {plans[i].lines[j].label + suffix, samples.times, samples.values[line], static_cast<int>(j), k > 0});
      }
    }
  }
  return figure;
}

}  // namespace snug::replay
