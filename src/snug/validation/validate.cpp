// validate: the report's four criteria (section 4.4.1) for a simulated run and the repetitions of its experiment.
#include "snug/validation/validate.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/validation/log_table.hpp"
#include "snug/validation/reported.hpp"

namespace snug::validation {
namespace {

using record::is_tracked;
using record::PoseSample;

constexpr double kBefore = 1.0, kAfter = 2.0;  // s around holding a box
constexpr double kSeenAtEnd = 0.5;             // s: a body seen that near to the window's end was seen at its end

/// When a box was held: from each seal to the release or loss after it.
struct Hold {
  double start = 0.0, end = 0.0;
};

std::vector<Hold> holds_of(const SimulatedRun& run, const std::string& body) {
  std::vector<Hold> holds;
  bool is_held = false;
  for (const record::Event& event : run.events) {
    if (event.body != body) continue;
    const bool seals = event.kind == "seal" || event.kind == "repick" || event.kind == "reseal";
    if (seals && !is_held) holds.push_back({event.time, run.times.back()});
    if (seals) is_held = true;
    if (is_held && (event.kind == "release" || event.kind == "lost")) {
      holds.back().end = event.time;
      is_held = false;
    }
  }
  return holds;
}

/// The part of the run in which a body is there.
Window presence_of(const SimulatedRun& run, std::size_t body) {
  Window window{run.header.bodies[body].name, kNaN, kNaN};
  for (std::size_t i = 0; i < run.times.size(); ++i) {
    if (!is_tracked(run.bodies[body][i])) continue;
    if (!std::isfinite(window.start)) window.start = run.times[i];
    window.end = run.times[i];
  }
  return window;
}

std::string simulated_state(const std::optional<runs::RunResult>& result, const std::string& body) {
  if (!result) return "not known";
  const auto box = std::ranges::find(result->boxes, body, &cell::BoxResult::id);
  return box != result->boxes.end() ? cell::name_of(box->state) : "not known";
}

std::string protective_stop(const std::optional<runs::RunResult>& result) {
  if (!result || !result->stop) return "";
  return std::string(cell::name_of(result->stop->cause)) + " of " + result->stop->where;
}

/// Where the body was last seen in the window, and whether that was at its end.
std::string measured_state(const SimulatedRun& run, const Measurement& measurement, const Window& window) {
  const auto body = static_cast<std::size_t>(record::find_body(run.header, window.body));
  if (!measurement.has_poses() || measurement.bodies[body].empty()) return "not measured";
  const std::vector<double>& times = measurement.pose_times;
  auto i = static_cast<std::ptrdiff_t>(std::upper_bound(times.begin(), times.end(), window.end) - times.begin()) - 1;
  const auto at = [&](std::ptrdiff_t k) -> const PoseSample& {
    return measurement.bodies[body][static_cast<std::size_t>(k)];
  };
  while (i >= 0 && times[static_cast<std::size_t>(i)] >= window.start && !is_tracked(at(i))) --i;
  if (i < 0 || times[static_cast<std::size_t>(i)] < std::max(window.start, window.end - kSeenAtEnd)) return "lost";
  const record::ContainerInfo& container = run.header.container;
  if (container.name.empty()) return "seen";
  const Vector3 p_IB = (container.X_WT.pose() * container.X_TI.pose()).inverse() * at(i).p;
  const bool is_inside = std::abs(p_IB.x()) < 0.5 * container.inner_size.x() &&
                         std::abs(p_IB.y()) < 0.5 * container.inner_size.y() && p_IB.z() > 0.0 &&
                         p_IB.z() < container.inner_size.z();
  return is_inside ? "packed" : "outside";
}

ErrorTable compare_all(const SimulatedRun& run, const std::vector<Measurement>& repetitions, const Window& window) {
  ErrorTable table;
  for (const Measurement& measurement : repetitions) {
    table.clean.push_back(compare(run, measurement, window, Form::Clean));
    table.report.push_back(compare(run, measurement, window, Form::Report));
  }
  return table;
}

/// The report's moments for a sequence it has, and flips and the last box packed for every other.
std::vector<MomentReport> find_moments(const SimulatedRun& run, const std::vector<BodyReport>& bodies) {
  std::vector<MomentReport> moments;
  const auto add = [&](const BodyReport& body, const std::string& what) {
    const std::vector<Hold> holds = holds_of(run, body.body);
    const bool is_flip = what == "flipping";
    if (holds.empty() || (is_flip && holds.size() < 2)) return;
    const double start = is_flip ? holds.front().start - kBefore : holds.back().start - kBefore;
    const double end = is_flip ? holds[1].start - kBefore : body.window.end;
    if (end > start) moments.push_back({what, {body.body, start, end}, {}});
  };
  for (const KeyMoment& moment : key_moments()) {
    if (run.header.sequence != moment.sequence) continue;
    for (const BodyReport& body : bodies)
      if (record::is_same_body(body.body, moment.body)) add(body, moment.what);
  }
  if (!moments.empty()) return moments;
  for (const BodyReport& body : bodies) add(body, "flipping");
  if (!bodies.empty()) add(bodies.back(), "packing");
  return moments;
}

Means means_of(const std::vector<BodyReport>& bodies, std::vector<Errors> ErrorTable::*form) {
  const auto mean = [&](double Errors::*value, int* count) {
    double sum = 0.0, known = 0.0;
    for (const BodyReport& body : bodies) {
      const double one = spread_of(body.errors.*form, value).mean;
      if (!std::isfinite(one)) continue;
      sum += one;
      known += 1.0;
    }
    if (count != nullptr) *count = static_cast<int>(known);
    return known > 0.0 ? sum / known : kNaN;
  };
  Means means;
  means.rest_position = mean(&Errors::rest_position, &means.bodies);
  means.rest_rotation = mean(&Errors::rest_rotation, nullptr);
  means.rms_position = mean(&Errors::rms_position, nullptr);
  means.rms_rotation = mean(&Errors::rms_rotation, nullptr);
  means.rms_force = mean(&Errors::rms_force, nullptr);
  means.rms_torque = mean(&Errors::rms_torque, nullptr);
  return means;
}

}  // namespace

Spread spread_of(const std::vector<Errors>& errors, double Errors::*value) {
  Spread spread;
  double sum = 0.0, squares = 0.0;
  for (const Errors& one : errors) {
    if (!std::isfinite(one.*value)) continue;
    sum += one.*value;
    ++spread.count;
  }
  spread.mean = spread.count > 0 ? sum / spread.count : kNaN;
  for (const Errors& one : errors)
    if (std::isfinite(one.*value)) squares += (one.*value - spread.mean) * (one.*value - spread.mean);
  spread.deviation = spread.count > 1 ? std::sqrt(squares / (spread.count - 1)) : kNaN;
  return spread;
}

std::vector<Window> find_windows(const SimulatedRun& run) {
  std::vector<Window> windows;
  for (const std::size_t i : find_boxes(run.header)) {
    const std::vector<Hold> holds = holds_of(run, run.header.bodies[i].name);
    Window window = presence_of(run, i);
    if (!holds.empty()) {
      window.start = std::max(run.times.front(), holds.front().start - kBefore);
      window.end = std::min(run.times.back(), holds.back().end + kAfter);
    }
    if (window.end > window.start) windows.push_back(std::move(window));
  }
  std::stable_sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.start < b.start; });
  // A box that rests may be pushed by the next one: its window ends before that one arrives.
  for (std::size_t i = 0; i + 1 < windows.size(); ++i)
    if (windows[i + 1].start > windows[i].start + kBefore && windows[i + 1].start < windows[i].end)
      windows[i].end = windows[i + 1].start;
  return windows;
}

Validation validate(const SimulatedRun& run, std::vector<Measurement> repetitions, std::vector<Window> windows) {
  if (windows.empty()) windows = find_windows(run);
  const std::optional<runs::RunResult> result = runs::read_result(run.result);
  Validation validation;
  validation.simulated = run.name;
  validation.sequence = run.header.sequence;
  validation.protective_stop = protective_stop(result);
  validation.repetitions = std::move(repetitions);
  for (const Window& window : windows) {
    BodyReport body;
    body.body = window.body;
    body.window = window;
    body.simulated_state = simulated_state(result, window.body);
    for (const Measurement& measurement : validation.repetitions)
      body.measured_states.push_back(measured_state(run, measurement, window));
    body.errors = compare_all(run, validation.repetitions, window);
    validation.bodies.push_back(std::move(body));
  }
  validation.moments = find_moments(run, validation.bodies);
  for (MomentReport& moment : validation.moments)
    moment.errors = compare_all(run, validation.repetitions, moment.window);
  validation.clean = means_of(validation.bodies, &ErrorTable::clean);
  validation.report = means_of(validation.bodies, &ErrorTable::report);
  return validation;
}

namespace {

/// Cells of a line, without blanks.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') cells.emplace_back();
    if (c != ',' && c != '\r' && c != ' ') cells.back() += c;
  }
  return cells;
}

}  // namespace

std::vector<Window> load_windows(const std::filesystem::path& path, const SimulatedRun& run) {
  const std::string whole = read_file(path, "windows (CSV: body,start_s,end_s)");
  check_utf8(whole, path.string());
  std::istringstream file{std::string(without_byte_order_mark(whole))};
  int line_number = 0;
  const auto fail = [&](const std::string& key, const std::string& got, const std::string& expected) {
    throw InputError(path.string() + ":" + std::to_string(line_number), key, got, expected);
  };
  std::vector<std::string> header;
  std::vector<Window> windows;
  std::vector<std::string> known;
  for (const record::BodyInfo& body : run.header.bodies) known.push_back(record::archive_name(body.name));
  const auto column = [&](const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    return at == header.end() ? header.size() : static_cast<std::size_t>(at - header.begin());
  };
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    const std::vector<std::string> cells = cells_of(line);
    if (header.empty()) {
      header = cells;
      const std::vector<std::string> names = {"sequence", "body", "start_s", "end_s"};
      for (const std::string& name : header)
        if (std::find(names.begin(), names.end(), name) == names.end())
          fail(name, "a column of that name", "columns body, start_s, end_s and perhaps sequence");
      for (const char* name : {"body", "start_s", "end_s"})
        if (column(name) == header.size()) fail(name, "no such column", "columns body, start_s, end_s");
      continue;
    }
    if (cells.size() != header.size())
      fail("", std::to_string(cells.size()) + " cells", std::to_string(header.size()) + ", one for each column");
    if (column("sequence") < header.size() && cells[column("sequence")] != run.header.sequence) continue;
    const auto number = [&](const char* name) {
      const std::string& text = cells[column(name)];
      double value = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        fail(name, "'" + text + "'", "seconds");
      return value;
    };
    Window window;
    for (const record::BodyInfo& body : run.header.bodies)
      if (record::is_same_body(body.name, cells[column("body")])) window.body = body.name;
    if (window.body.empty()) {
      const std::string_view nearest = find_nearest(cells[column("body")], known);
      fail("body", "'" + cells[column("body")] + "'",
           nearest.empty() ? "a body of the simulation" : "a body; did you mean " + std::string(nearest) + "?");
    }
    window.start = number("start_s");
    window.end = number("end_s");
    if (!(window.end > window.start)) fail("end_s", cells[column("end_s")], "an end after the start");
    windows.push_back(std::move(window));
  }
  if (windows.empty()) throw InputError(path.string(), "", "no window of this run's sequence", "one or more");
  return windows;
}

std::vector<Measurement> load_repetitions(const std::filesystem::path& path, const SimulatedRun& run,
                                          const HandShifts& shifts) {
  std::vector<Measurement> repetitions;
  if (path.extension() == ".csv") {
    repetitions.push_back(align(run, load_log(path), shifts, path.string()));
  } else {
    const record::ArchiveReader reader(path);
    for (std::size_t i = 0; i < reader.size(); ++i) {
      const record::ArchiveRecording recording = reader.read(i);
      if (recording.motion_capture.bodies.empty()) continue;  // the calibration of the force/torque sensor
      repetitions.push_back(align(run, recording, shifts, path.string()));
    }
  }
  if (repetitions.empty())
    throw InputError(path.string(), "", "no recording with motion capture", "the repetitions of a sequence");
  std::string failures;
  for (const Measurement& measurement : repetitions) {
    for (const SourceClock& clock : measurement.clocks) {
      if (clock.fit) return repetitions;
      failures += (failures.empty() ? "" : "; ") + measurement.name + ", " + clock.source + ": " + clock.failure;
    }
  }
  throw InputError(path.string(), "", "measurements whose clock cannot be found (" + failures + ")",
                   "measurements of this run's motion, or shifts by hand (--shift)");
}

}  // namespace snug::validation
