// Lifts from tables, and what a lift told of the payload as text.
#include "snug/identification/payload_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/table.hpp"
#include "snug/identification/internal/measured_table.hpp"

namespace snug::identification {
namespace {

constexpr double kCentreKnown = 0.005,
                 kCentreWeak = 0.02;  // m: the aim of docs/theory/identification.md, section 7; weak to four times that

Verdict judge_centre(double deviation) {
  if (deviation <= kCentreKnown) return Verdict::Identified;
  return deviation <= kCentreWeak ? Verdict::Weak : Verdict::NotIdentifiable;
}

}  // namespace

std::vector<PayloadSample> parse_lift(const std::string& text, const std::string& name) {
  const std::vector<std::string> columns = {"t",  "x",  "y",  "z",  "qw", "qx", "qy",
                                            "qz", "fx", "fy", "fz", "tx", "ty", "tz"};
  const std::vector<std::string> lip = {"lip_x", "lip_y", "lip_z", "lip_qw", "lip_qx", "lip_qy", "lip_qz"};
  const Table table = parse_table(text, name, columns, lip);
  const std::optional<std::size_t> lip_at = internal::find_group(table, lip);
  std::vector<PayloadSample> lift;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    PayloadSample& sample = lift.emplace_back();
    sample.time = table.rows[row][0];
    if (lift.size() > 1 && sample.time <= lift[lift.size() - 2].time)
      throw InputError(table.where(row), "t", fmt::format("{} after {}", sample.time, lift[lift.size() - 2].time),
                       "times that grow");
    sample.X_WE = {internal::rotation_at(table, row, 4), internal::vector_at(table, row, 1)};
    sample.wrench_E << internal::vector_at(table, row, 8), internal::vector_at(table, row, 11);
    if (lip_at)
      sample.X_ES = Pose{internal::rotation_at(table, row, *lip_at + 3), internal::vector_at(table, row, *lip_at)};
  }
  check_lift(lift, name);
  return lift;
}

void check_lift(const std::vector<PayloadSample>& lift, const std::string& name) {
  for (std::size_t i = 0; i < lift.size(); ++i) {
    const PayloadSample& one = lift[i];
    if (!std::isfinite(one.time) || !one.X_WE.p.allFinite() || !one.X_WE.R.allFinite() || !one.wrench_E.allFinite())
      throw InputError(name, fmt::format("row {}", i), "a number that is not finite", "finite numbers");
    if (i > 0 && one.time <= lift[i - 1].time)
      throw InputError(name, fmt::format("row {}", i), fmt::format("time {} after {}", one.time, lift[i - 1].time),
                       "times that grow");
  }
  const double window = PayloadSettings{}.window;
  if (lift.size() < 3 || lift.back().time - lift.front().time < window)
    throw InputError(name, "", fmt::format("{} rows", lift.size()),
                     fmt::format("a lift of {} s or more, of the gripper that holds a box", window));
}

std::vector<PayloadSample> load_lift(const std::filesystem::path& path) {
  return parse_lift(read_file(path, "a recorded lift (CSV)"), path.string());
}

std::vector<PayloadSample> with_rigid_lip(std::vector<PayloadSample> lift, const CupFrames& frames) {
  for (PayloadSample& sample : lift) sample.X_ES = frames.X_ES2 * frames.X_SS1.inverse();
  return lift;
}

std::vector<Parameter> judge_payload(const PayloadEstimate& estimate) {
  const SpatialInertia& load = estimate.load_S;
  const double unknown = std::numeric_limits<double>::infinity();
  const auto error = [&](Eigen::Index i) {
    return estimate.windows > 0 ? std::sqrt(estimate.covariance(i, i)) : unknown;
  };
  std::vector<Parameter> list;
  const Verdict mass = judge(error(0), load.mass);
  list.push_back(
      {"mass", load.mass, error(0), "kg", mass,
       mass == Verdict::Identified ? "" : "a longer lift, or a sensor that was tared with the empty gripper"});
  constexpr std::array kCentres = {"com_x", "com_y", "com_z"};
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Verdict verdict = judge_centre(error(1 + i));
    list.push_back({kCentres[static_cast<std::size_t>(i)], load.com[i], error(1 + i), "m", verdict,
                    verdict == Verdict::Identified
                        ? ""
                        : "the gripper tilted by 20 degrees or more, or moved sideways: a lift straight up does not "
                          "determine the centre along the weight"});
  }
  constexpr std::array kMoments = {"I_xx", "I_yy", "I_zz", "I_xy", "I_xz", "I_yz"};
  constexpr int kRows[] = {0, 1, 2, 0, 0, 1}, kColumns[] = {0, 1, 2, 1, 2, 2};
  const double scale = load.inertia.trace() / 3.0;
  for (std::size_t k = 0; k < kMoments.size(); ++k) {
    const Verdict verdict = judge(error(4 + static_cast<Eigen::Index>(k)), scale);
    list.push_back({kMoments[k], load.inertia(kRows[k], kColumns[k]), error(4 + static_cast<Eigen::Index>(k)), "kg m^2",
                    verdict, verdict == Verdict::Identified ? "" : "fast turns about this axis"});
  }
  return list;
}

std::string format_payload_json(const PayloadEstimate& estimate) {
  nlohmann::ordered_json json;
  json["parameters"] = nlohmann::ordered_json::array();
  for (const Parameter& one : judge_payload(estimate)) {
    nlohmann::ordered_json entry = {{"name", one.name}, {"value", one.value}};
    entry["standard_error"] =
        std::isfinite(one.standard_error) ? nlohmann::ordered_json(one.standard_error) : nlohmann::ordered_json();
    entry["unit"] = one.unit;
    entry["verdict"] = name_of(one.verdict);
    if (!one.advice.empty()) entry["record_instead"] = one.advice;
    json["parameters"].push_back(entry);
  }
  json["windows"] = estimate.windows;
  return json.dump(2) + "\n";
}

std::string format_payload_table(const PayloadEstimate& estimate) {
  std::string text =
      fmt::format("payload from {} windows; centre of mass and inertia in the lip's frame S\n", estimate.windows);
  std::string before;
  for (const Parameter& one : judge_payload(estimate)) {
    text += fmt::format(
        "  {:<6} {:>10.5g} {} {:<7} {}\n", one.name, one.value,
        std::isfinite(one.standard_error) ? fmt::format("+- {:<8.2g}", one.standard_error) : std::string("+- unknown "),
        one.unit, name_of(one.verdict));
    if (!one.advice.empty() && one.advice != before) text += fmt::format("         record instead: {}\n", one.advice);
    before = one.advice;
  }
  return text;
}

}  // namespace snug::identification
