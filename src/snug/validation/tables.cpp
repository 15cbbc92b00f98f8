// Tables: a validation as JSON, CSV and lines of text.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/core/csv_cell.hpp"
#include "snug/core/units.hpp"
#include "snug/validation/page.hpp"
#include "snug/validation/reported.hpp"

namespace snug::validation {
namespace {

using Json = nlohmann::ordered_json;

/// A number of Errors with its name and unit for people.
struct Quantity {
  const char* key;
  double Errors::*value;
  double scale;
};
constexpr Quantity kQuantities[] = {
    {"rest_position_mm", &Errors::rest_position, kMm}, {"rest_rotation_deg", &Errors::rest_rotation, kDegrees},
    {"rms_position_mm", &Errors::rms_position, kMm},   {"rms_rotation_deg", &Errors::rms_rotation, kDegrees},
    {"rms_force_N", &Errors::rms_force, 1.0},          {"rms_torque_Nm", &Errors::rms_torque, 1.0}};

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json errors_as_json(const std::vector<Errors>& errors) {
  Json json = Json::object();
  for (const Quantity& quantity : kQuantities) {
    const Spread spread = spread_of(errors, quantity.value);
    Json values = Json::array();
    for (const Errors& one : errors) values.push_back(number(quantity.scale * (one.*quantity.value)));
    json[quantity.key] = {{"mean", number(quantity.scale * spread.mean)},
                          {"standard_deviation", number(quantity.scale * spread.deviation)},
                          {"repetitions", values}};
  }
  Json tracked = Json::array(), dropped = Json::array();
  for (const Errors& one : errors) {
    tracked.push_back(number(100.0 * one.tracked));
    dropped.push_back(number(100.0 * one.dropped));
  }
  json["tracked_percent"] = tracked;
  json["dropped_percent"] = dropped;
  return json;
}

Json window_as_json(const Window& window) { return {{"start_s", window.start}, {"end_s", window.end}}; }

Json means_as_json(const Means& means) {
  return {{"rest_position_mm", number(kMm * means.rest_position)},
          {"rest_rotation_deg", number(kDegrees * means.rest_rotation)},
          {"rms_position_mm", number(kMm * means.rms_position)},
          {"rms_rotation_deg", number(kDegrees * means.rms_rotation)},
          {"rms_force_N", number(means.rms_force)},
          {"rms_torque_Nm", number(means.rms_torque)},
          {"bodies", means.bodies}};
}

Json steps_as_json(const ClockFit& fit) {
  Json steps = Json::array();
  for (const ClockStep& step : fit.steps)
    steps.push_back({{"at_s", step.time}, {"size_s", step.size}, {"standard_error_s", number(step.error)}});
  return steps;
}

Json repetition_as_json(const Measurement& measurement) {
  Json json = {{"name", measurement.name}, {"note", measurement.note}, {"clocks", Json::array()}};
  for (const SourceClock& clock : measurement.clocks) {
    Json one = {{"source", clock.source}};
    if (clock.fit) {
      const ClockFit& fit = *clock.fit;
      one.update({{"shift_s", fit.shift},
                  {"standard_error_s", fit.is_by_hand ? Json(nullptr) : number(fit.shift_error)},
                  {"at_s", fit.middle},
                  {"rate_ppm", 1e6 * fit.rate},
                  {"rate_standard_error_ppm", fit.is_by_hand ? Json(nullptr) : number(1e6 * fit.rate_error)},
                  {"steps", steps_as_json(fit)},
                  {"correlation", fit.is_by_hand ? Json(nullptr) : number(fit.correlation)},
                  {"by_hand", fit.is_by_hand}});
    } else {
      one["failure"] = clock.failure;
    }
    json["clocks"].push_back(one);
  }
  const Vector6 bias = as_vector(measurement.bias);
  json["bias"] = {{"force_N", {bias[0], bias[1], bias[2]}}, {"torque_Nm", {bias[3], bias[4], bias[5]}}};
  return json;
}

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "n.a.";
}

}  // namespace

std::string as_json(const Validation& validation) {
  Json json = {
      {"simulated", validation.simulated},
      {"sequence", validation.sequence},
      {"protective_stop", validation.protective_stop.empty() ? Json(nullptr) : Json(validation.protective_stop)},
      {"repetitions", Json::array()},
      {"bodies", Json::array()},
      {"moments", Json::array()}};
  for (const Measurement& measurement : validation.repetitions)
    json["repetitions"].push_back(repetition_as_json(measurement));
  for (const BodyReport& body : validation.bodies) {
    json["bodies"].push_back({{"body", body.body},
                              {"window", window_as_json(body.window)},
                              {"simulated", body.simulated_state},
                              {"measured", body.measured_states},
                              {"clean", errors_as_json(body.errors.clean)},
                              {"report", errors_as_json(body.errors.report)}});
  }
  for (const MomentReport& moment : validation.moments) {
    json["moments"].push_back({{"body", moment.window.body},
                               {"what", moment.what},
                               {"window", window_as_json(moment.window)},
                               {"clean", errors_as_json(moment.errors.clean)},
                               {"report", errors_as_json(moment.errors.report)}});
  }
  json["means"] = {{"clean", means_as_json(validation.clean)},
                   {"report", means_as_json(validation.report)},
                   {"reported_of_the_real_cell", means_as_json(reported_means())}};
  return json.dump(2) + "\n";
}

std::string as_csv(const Validation& validation) {
  std::string text = "body,repetition,form,start_s,end_s,simulated,measured";
  for (const Quantity& quantity : kQuantities) text += std::string(",") + quantity.key;
  text += ",tracked_percent,dropped_percent\n";
  for (const BodyReport& body : validation.bodies) {
    for (const auto& [form, errors] :
         {std::pair("clean", &body.errors.clean), std::pair("report", &body.errors.report)}) {
      for (std::size_t k = 0; k < errors->size(); ++k) {
        const Errors& one = (*errors)[k];
        text += fmt::format("{},{},{},{:.3f},{:.3f},{},{}", csv_cell(body.body),
                            csv_cell(validation.repetitions[k].name), form, body.window.start, body.window.end,
                            csv_cell(body.simulated_state), csv_cell(body.measured_states[k]));
        for (const Quantity& quantity : kQuantities) {
          const double value = quantity.scale * (one.*quantity.value);
          text += std::isfinite(value) ? fmt::format(",{:.6g}", value) : ",";
        }
        text += fmt::format(",{:.4g},{:.4g}\n", 100.0 * one.tracked, 100.0 * one.dropped);
      }
    }
  }
  return text;
}

std::string as_text(const Validation& validation) {
  std::string text;
  for (const Measurement& measurement : validation.repetitions) {
    text += measurement.name + '\n';
    for (const SourceClock& clock : measurement.clocks) {
      if (!clock.fit)
        text += fmt::format("  {}: not on the simulation's clock: {}\n", clock.source, clock.failure);
      else if (clock.fit->is_by_hand)
        text += fmt::format("  {}: shift {:.4f} s, by hand\n", clock.source, clock.fit->shift);
      else
        text += fmt::format("  {}: shift {:.5f} +- {:.5f} s, rate {:.1f} +- {:.1f} ppm, correlation {:.3f}\n",
                            clock.source, clock.fit->shift, clock.fit->shift_error, 1e6 * clock.fit->rate,
                            1e6 * clock.fit->rate_error, clock.fit->correlation);
      if (!clock.fit) continue;
      for (const ClockStep& step : clock.fit->steps)
        text += fmt::format("    slips by {:+.5f} +- {:.5f} s at {:.1f} s\n", step.size, step.error, step.time);
    }
  }
  text += fmt::format("\n{:<9} {:<9} {:<26} {:>15} {:>15} {:>15}\n", "box", "simulated", "measured", "rest mm / deg",
                      "rms mm / deg", "rms N / Nm");
  const auto pair = [](const std::vector<Errors>& errors, double Errors::*a, double scale_a, double Errors::*b,
                       double scale_b, int decimals) {
    return cell(scale_a * spread_of(errors, a).mean, decimals) + " / " + cell(scale_b * spread_of(errors, b).mean, 2);
  };
  for (const BodyReport& body : validation.bodies) {
    const std::vector<Errors>& errors = body.errors.clean;
    text += fmt::format("{:<9} {:<9} {:<26} {:>15} {:>15} {:>15}\n", record::archive_name(body.body),
                        body.simulated_state, fmt::format("{}", fmt::join(body.measured_states, ", ")),
                        pair(errors, &Errors::rest_position, kMm, &Errors::rest_rotation, kDegrees, 2),
                        pair(errors, &Errors::rms_position, kMm, &Errors::rms_rotation, kDegrees, 2),
                        pair(errors, &Errors::rms_force, 1.0, &Errors::rms_torque, 1.0, 2));
  }
  const auto line = [&](const char* name, const Means& means) {
    text += fmt::format("{:<46} {:>15} {:>15} {:>15}\n", name,
                        cell(kMm * means.rest_position, 2) + " / " + cell(kDegrees * means.rest_rotation, 2),
                        cell(kMm * means.rms_position, 2) + " / " + cell(kDegrees * means.rms_rotation, 2),
                        cell(means.rms_force, 2) + " / " + cell(means.rms_torque, 2));
  };
  text += '\n';
  line("mean, clean", validation.clean);
  line("mean, by the report's rules", validation.report);
  line("the report's simulation beside its real cell", reported_means());
  return text;
}

}  // namespace snug::validation
