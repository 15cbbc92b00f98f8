// Figures: poses and wrenches of a window, simulated and measured, with the errors below.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/core/units.hpp"
#include "snug/validation/page.hpp"

namespace snug::validation {
namespace {

using report::Curve;
using report::Figure;
using report::Panel;

constexpr int kBlue = 0, kOrange = 1, kGreen = 2, kPurple = 3;
constexpr int kRepetitionColors[] = {kOrange, kGreen, kPurple};

int color_of(std::size_t repetition) { return kRepetitionColors[repetition % std::size(kRepetitionColors)]; }

std::string label_of(const Validation& validation, std::size_t repetition) {
  return validation.repetitions.size() == 1 ? "measured" : fmt::format("measured {}", repetition + 1);
}

std::vector<double> axis_of(const std::vector<Vector3>& vectors, int axis, double scale) {
  std::vector<double> values;
  values.reserve(vectors.size());
  for (const Vector3& v : vectors) values.push_back(scale * v[axis]);
  return values;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::vector<Vector3> part_of(const std::vector<Wrench>& wrenches, Vector3 Wrench::*part) {
  std::vector<Vector3> vectors;
  vectors.reserve(wrenches.size());
  for (const Wrench& wrench : wrenches) vectors.push_back(wrench.*part);
  return vectors;
}

/// One side of a figure: three components and the size of the error.
struct Side {
  std::string what, unit;
  std::vector<double> times;
  std::vector<Vector3> simulated;
};

/// Four panels; curves of the repetitions are added one by one.
std::vector<Panel> panels_of(const Side& side, double scale) {
  std::vector<Panel> panels;
  for (int axis = 0; axis < 3; ++axis) {
    Panel panel;
    panel.y_label = fmt::format("{} {} [{}]", side.what, "xyz"[axis], side.unit);
    // One legend for the column, above its first panel.
    panel.curves.push_back(
        {axis == 0 ? "simulated" : "", side.times, axis_of(side.simulated, axis, scale), kBlue, false});
    panels.push_back(std::move(panel));
  }
  Panel error;
  error.y_label = fmt::format("error [{}]", side.unit);
  panels.push_back(std::move(error));
  return panels;
}

void add_measured(std::vector<Panel>& panels, const std::string& label, int color, const std::vector<double>& times,
                  const std::vector<Vector3>& measured, double scale, const std::vector<double>& error) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Curve>& curves = panels[static_cast<std::size_t>(axis)].curves;
    curves.push_back({axis == 0 ? label : "", times, axis_of(measured, axis, scale), color, true});
  }
  panels[3].curves.push_back({"", times, scaled(error, scale), color, false});
}

Figure two_columns(const Validation& validation, std::vector<Panel> left, std::vector<Panel> right,
                   const Window& window) {
  Figure figure;
  figure.description =
      fmt::format("{} of {}, {:.1f} to {:.1f} s, beside", window.body, validation.simulated, window.start, window.end);
  for (const Measurement& measurement : validation.repetitions) figure.description += ' ' + measurement.name;
  figure.x_label = "time of the simulation [s]";
  figure.columns = 2;
  figure.panel_height_mm = 32.0;
  figure.panels = std::move(left);
  for (Panel& panel : right) figure.panels.push_back(std::move(panel));
  return figure;
}

Figure pose_figure(const SimulatedRun& run, const Validation& validation, const Window& window) {
  std::vector<Panel> left, right;
  for (std::size_t k = 0; k < validation.repetitions.size(); ++k) {
    const PoseSeries series = pose_series(run, validation.repetitions[k], window);
    if (k == 0) {
      left = panels_of({"position", "mm", series.times, series.p_simulated}, kMm);
      right = panels_of({"rotation vector", "deg", series.times, series.w_simulated}, kDegrees);
    }
    add_measured(left, label_of(validation, k), color_of(k), series.times, series.p_measured, kMm,
                 series.position_error);
    add_measured(right, label_of(validation, k), color_of(k), series.times, series.w_measured, kDegrees,
                 series.rotation_error);
  }
  return two_columns(validation, std::move(left), std::move(right), window);
}

Figure wrench_figure(const SimulatedRun& run, const Validation& validation, const Window& window) {
  std::vector<Panel> left, right;
  for (std::size_t k = 0; k < validation.repetitions.size(); ++k) {
    const WrenchSeries series = wrench_series(run, validation.repetitions[k], window);
    if (series.times.empty()) continue;
    if (left.empty()) {
      left = panels_of({"force", "N", series.times, part_of(series.simulated, &Wrench::force)}, 1.0);
      right = panels_of({"torque", "Nm", series.times, part_of(series.simulated, &Wrench::torque)}, 1.0);
    }
    add_measured(left, label_of(validation, k), color_of(k), series.times, part_of(series.measured, &Wrench::force),
                 1.0, series.force_error);
    add_measured(right, label_of(validation, k), color_of(k), series.times, part_of(series.measured, &Wrench::torque),
                 1.0, series.torque_error);
  }
  return two_columns(validation, std::move(left), std::move(right), window);
}

void add_figures(const SimulatedRun& run, const Validation& validation, const Window& window, const std::string& what,
                 std::vector<NamedFigure>& figures) {
  const std::string suffix = what.empty() ? "" : '-' + what;
  const std::string name = record::archive_name(window.body);
  const std::string caption =
      fmt::format("{}{}, {:.1f} to {:.1f} s", name, what.empty() ? "" : ", " + what, window.start, window.end);
  figures.push_back({name + suffix + "-poses.svg", caption + ": pose in W", pose_figure(run, validation, window)});
  Figure wrenches = wrench_figure(run, validation, window);
  if (!wrenches.panels.empty())
    figures.push_back(
        {name + suffix + "-wrenches.svg", caption + ": wrench on the flange, in its frame", std::move(wrenches)});
}

}  // namespace

std::vector<NamedFigure> make_figures(const SimulatedRun& run, const Validation& validation, bool for_moments) {
  std::vector<NamedFigure> figures;
  if (for_moments) {
    for (const MomentReport& moment : validation.moments)
      add_figures(run, validation, moment.window, moment.what, figures);
  } else {
    for (const BodyReport& body : validation.bodies) add_figures(run, validation, body.window, "", figures);
  }
  return figures;
}

}  // namespace snug::validation
