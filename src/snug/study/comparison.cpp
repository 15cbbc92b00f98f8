// Comparison: rows of sessions written, read and summed up.
#include "snug/study/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/study/calibration_json.hpp"
#include "snug/study/row_values.hpp"

namespace snug::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kStopReasons = {
    session::StopReason::AllPacked, session::StopReason::NoMoreItems, session::StopReason::NoItems,
    session::StopReason::NoPlace,   session::StopReason::RobotStops,  session::StopReason::ViewBlocked,
    session::StopReason::NoFrame,   session::StopReason::PlantFault,  session::StopReason::Interrupted};

/// The names that rows have.
struct FieldNames {
  std::vector<Output> outputs;
  template <class T>
  void operator()(const char* name, T& /*value*/) {
    outputs.push_back({.name = name});
  }
};

/// The one place where a session becomes JSON.
struct RowWriter {
  Json json = Json::object();
  template <class T>
  void operator()(const char* name, T& value) {
    json[name] = value;
  }
  void operator()(const char* name, std::optional<session::StopReason>& reason) {
    json[name] = reason ? session::name_of(*reason) : "";
  }
  void operator()(const char* name, Calibration& calibration) { json[name] = calibration_json(calibration); }
  void operator()(const char* name, std::vector<PackedBox>& packed) {
    json[name] = Json::array();
    for (const PackedBox& box : packed) {
      const Quaternion q(box.X_TP.R);
      json[name].push_back({{"id", box.id},
                            {"p", {box.X_TP.p.x(), box.X_TP.p.y(), box.X_TP.p.z()}},
                            {"quat_wxyz", {q.w(), q.x(), q.y(), q.z()}}});
    }
  }
};

/// The values of a table's row; what is not there stays as it is.
class RowReader {
 public:
  explicit RowReader(const RowResult& result) : values_(result) {}

  void operator()(const char* name, double& value) { value = values_.number(name, value); }
  void operator()(const char* name, int& value) { value = static_cast<int>(values_.number(name, value)); }
  void operator()(const char* name, std::string& value) { value = values_.word(name); }
  void operator()(const char* name, std::optional<session::StopReason>& reason) {
    const std::string text = values_.word(name);
    const auto found = std::ranges::find_if(kStopReasons, [&](auto one) { return text == session::name_of(one); });
    if (found != kStopReasons.end()) reason = *found;
  }
  void operator()(const char* name, Calibration& calibration) { calibration = read_calibration(values_.list(name)); }
  void operator()(const char* name, std::vector<PackedBox>& packed) {
    for (const Json& json : values_.list(name)) {
      const auto p = json.at("p").get<std::array<double, 3>>();
      const auto q = json.at("quat_wxyz").get<std::array<double, 4>>();
      packed.push_back({json.at("id").get<std::string>(),
                        {Quaternion(q[0], q[1], q[2], q[3]).toRotationMatrix(), Vector3(p[0], p[1], p[2])}});
    }
  }

 private:
  RowValues values_;
};

}  // namespace

std::string SessionRow::stop_name() const { return stop_reason ? session::name_of(*stop_reason) : ""; }

std::vector<Output> session_outputs() {
  SessionRow row;
  FieldNames names;
  row.fields(names);
  return names.outputs;
}

SessionRow make_row(const Trial& trial, const SessionPoint& point) {
  const session::SessionResult& session = trial.session;
  SessionRow row;
  row.point = point;
  row.seed = trial.seed;
  row.planned_boxes = static_cast<int>(session.plan.size());
  row.planned_percent = session.planned_percent;
  row.executed_boxes = trial.executed_boxes;
  row.executed_percent = trial.executed_percent;
  row.percent_before_skips = session.percent_before_skips.value_or(trial.executed_percent);
  row.decision_seconds_median = session.decision_seconds_median;
  row.boxes_per_hour = trial.boxes_per_hour;
  row.boxes_per_hour_with_planning = trial.boxes_per_hour_with_planning;
  row.items_sent = trial.items_sent;
  row.items_as_planned = trial.items_as_planned;
  row.boxes_lost = trial.boxes_lost;
  row.recoveries = trial.recoveries;
  row.calibration.add(trial);
  for (const cell::BoxResult& box : trial.boxes) {
    if (box.state == cell::BoxState::Packed) row.packed.push_back({box.id, box.X_TP});
  }
  row.stop_reason = session.stop_reason;
  row.failure = session.failure.text;
  return row;
}

std::string format_row(SessionRow row) {
  RowWriter writer;
  row.fields(writer);
  writer.json["of_clock"] = {"decision_seconds_median", "boxes_per_hour_with_planning"};
  return writer.json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

SessionRow read_row(const RowResult& result, const SessionPoint& point, std::uint64_t seed) {
  SessionRow row;
  RowReader reader(result);
  row.fields(reader);
  row.point = point;
  row.seed = seed;
  if (!row.stop_reason) row.failure = result.error;
  return row;
}

AgentSummary summarize(const std::vector<SessionRow>& rows, const std::string& agent, const std::string& sequence) {
  AgentSummary all;
  double square = 0.0;
  for (const SessionRow& row : rows) {
    if (row.point.agent != agent || (!sequence.empty() && row.point.sequence != sequence)) continue;
    all.lowest = all.count == 0 ? row.executed_percent : std::min(all.lowest, row.executed_percent);
    all.highest = std::max(all.highest, row.executed_percent);
    ++all.count;
    all.sent += row.items_sent;
    all.as_planned += row.items_as_planned;
    all.lost += row.boxes_lost;
    all.recoveries += row.recoveries;
    all.planned += row.planned_percent;
    all.executed += row.executed_percent;
    all.before_skips += row.percent_before_skips;
    square += row.executed_percent * row.executed_percent;
    all.decision_seconds += row.decision_seconds_median;
    all.boxes_per_hour += row.boxes_per_hour;
    all.boxes_per_hour_with_planning += row.boxes_per_hour_with_planning;
    all.calibration.add(row.calibration);
  }
  if (all.count == 0) return all;
  const double count = all.count;
  for (double* sum : {&all.planned, &all.executed, &all.before_skips, &all.decision_seconds, &all.boxes_per_hour,
                      &all.boxes_per_hour_with_planning}) {
    *sum /= count;
  }
  // Of the sample: divided by one less than there are.
  if (all.count > 1)
    all.deviation = std::sqrt(std::max(0.0, (square - count * all.executed * all.executed) / (count - 1.0)));
  return all;
}

}  // namespace snug::study
