// A comparison as a study of `snug pack`: a row for each session.
#include "apps/snug/compare/compare_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "snug/study/calibration_json.hpp"
#include "snug/study/row_values.hpp"

namespace snug::app {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The words that all sessions have: options with their values.
OrderedJson common_words(const PackOptions& pack, std::uint64_t seed) {
  const PackOptions usual;
  OptionWords words = words_of(pack.changes);
  const auto add = [&](const char* option, const auto& value, const auto& otherwise) {
    if (value != otherwise) words.emplace_back(option, fmt::format("{}", value));
  };
  words.emplace_back("--seed", std::to_string(seed));
  for (const std::string& change : pack.plant_set) words.emplace_back("--plant-set", change);
  add("--perception", pack.perception, usual.perception);
  add("--samples", pack.samples, usual.samples);
  if (pack.skips) words.emplace_back("--skips", std::to_string(*pack.skips));
  add("--decision-time", pack.decision_time, usual.decision_time);
  add("--future", pack.future, usual.future);
  add("--fault", pack.fault, usual.fault);
  add("--controller", pack.controller, usual.controller);
  if (pack.tempo) words.emplace_back("--tempo", fmt::format("{}", *pack.tempo));
  if (pack.robot) words.emplace_back("--robot", *pack.robot);
  OrderedJson json = OrderedJson::object();
  for (const auto& [option, value] : words) json[option].push_back(value);
  return json;
}

std::vector<PackedBox> read_packed(const OrderedJson& boxes) {
  std::vector<PackedBox> packed;
  for (const OrderedJson& json : boxes) {
    if (json.at("state") != "packed") continue;
    const auto p = json.at("X_TP").at("p").get<std::array<double, 3>>();
    const auto q = json.at("X_TP").at("quat_wxyz").get<std::array<double, 4>>();
    packed.push_back({json.at("id").get<std::string>(),
                      {Quaternion(q[0], q[1], q[2], q[3]).toRotationMatrix(), Vector3(p[0], p[1], p[2])}});
  }
  return packed;
}

}  // namespace

std::string recording_of(const CompareOptions& options, std::size_t index, const SessionPoint& point) {
  std::string name = fmt::format("{:03}-{}-{}-plant-{}.h5", index + 1, point.agent, point.sequence, point.plant_seed);
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.'; }, '-');
  return (std::filesystem::path(*options.runs) / name).string();
}

study::Study make_compare_study(const CompareOptions& options, std::uint64_t seed,
                                const std::vector<SessionPoint>& points) {
  OrderedJson document{{"name", "compare"},
                       {"verb", "pack"},
                       {"scenario", options.pack.scenario},
                       {"options", common_words(options.pack, seed)},
                       {"design", "list"}};
  document["factors"] = {{{"option", "--agent"}}, {{"option", "--sequence"}}, {{"option", "--plant-seed"}}};
  if (options.random > 0) document["factors"].push_back({{"option", "--random-seed"}});
  if (options.runs) document["factors"].push_back({{"option", "--record"}});
  document["outputs"] = {"executed_percent",
                         "executed_boxes",
                         "planned_percent",
                         "planned_boxes",
                         "items_sent",
                         "items_as_planned",
                         "percent_before_skips",
                         "boxes_lost",
                         "recoveries",
                         "boxes_per_hour",
                         "stop_reason",
                         "failure",
                         "calibration",
                         "boxes",
                         "decision_seconds_median",
                         "boxes_per_hour_with_planning"};
  std::string text = document.dump(2);
  text.erase(text.size() - 2);  // "\n}": the points follow, a line each
  text += ",\n  \"points\": [";
  for (const SessionPoint& point : points) {
    OrderedJson json{
        {"agent", point.agent}, {"sequence", point.sequence}, {"plant-seed", std::to_string(point.plant_seed)}};
    if (options.random > 0) json["random-seed"] = point.is_random ? std::to_string(options.random_seed) : "false";
    if (options.runs) json["record"] = recording_of(options, static_cast<std::size_t>(&point - points.data()), point);
    text += (&point == points.data() ? "\n    " : ",\n    ") + json.dump();
  }
  return study::parse_study(text + "\n  ]\n}\n", "compare");
}

CompareSession read_session(const model::Scenario& scenario, const study::Study& study, const SessionPoint& point,
                            std::uint64_t seed, const study::RowResult& result) {
  const study::RowValues values(result);
  CompareSession session;
  CompareRow& row = session.row;
  row.agent = point.agent;
  row.sequence = point.sequence;
  row.seed = seed;
  row.plant_seed = point.plant_seed;
  row.planned_boxes = values.count("planned_boxes");
  row.planned_percent = values.number("planned_percent");
  row.executed_boxes = values.count("executed_boxes");
  row.executed_percent = values.number("executed_percent");
  row.percent_before_skips = values.number("percent_before_skips", row.executed_percent);
  row.decision_seconds_median = values.number("decision_seconds_median");
  row.boxes_per_hour = values.number("boxes_per_hour");
  row.boxes_per_hour_with_planning = values.number("boxes_per_hour_with_planning");
  row.items_sent = values.count("items_sent");
  row.items_as_planned = values.count("items_as_planned");
  row.boxes_lost = values.count("boxes_lost");
  row.recoveries = values.count("recoveries");
  row.calibration = study::read_calibration(values.list("calibration"));
  row.stop_reason = values.word("stop_reason");
  row.failure = row.stop_reason.empty() ? result.error : values.word("failure");
  session.boxes = outline_boxes(scenario, read_packed(values.list("boxes")));
  session.command = study::command_of(study, study::row_of(study, result.row));
  return session;
}

}  // namespace snug::app
