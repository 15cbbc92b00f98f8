// What was identified of a scene as text.
#include "snug/identification/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

namespace snug::identification {
namespace {

using nlohmann::ordered_json;

/// JSON has no infinity.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

ordered_json as_json(const SceneError& error) {
  return {{"position_mm", error.position_mm},
          {"rotation_deg", error.rotation_deg},
          {"right_orientation_percent", error.right_orientation_percent},
          {"cost", error.cost},
          {"end_position_mm", error.end_position_mm},
          {"end_rotation_deg", error.end_rotation_deg},
          {"recordings", error.recordings},
          {"failed", error.failed}};
}

struct Correlated {
  std::string a, b;
  double value = 0.0;
};

/// Of parameters whose errors hang together by `least` or more, in the order of the task.
std::vector<Correlated> correlations(const SceneFit& fit, double least) {
  std::vector<Correlated> list;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      const double size = std::sqrt(fit.covariance(a, a) * fit.covariance(b, b));
      if (!(size > 0.0)) continue;
      const double value = fit.covariance(a, b) / size;
      if (std::abs(value) >= least) list.push_back({fit.parameters[j].name, fit.parameters[i].name, value});
    }
  }
  return list;
}

/// "0.21 +- 0.002", or what is known of the error instead.
std::string error_text(double error) {
  if (std::isnan(error)) return "+- unknown  ";
  return std::isinf(error) ? "not told    " : fmt::format("+- {:<9.2g}", error);
}

std::string as_text(const SceneError& error) {
  std::string text =
      fmt::format("{:.3f} mm, {:.3f} degrees, right orientation {:.1f} %, cost {:.4f} mm, {} recording{}",
                  error.position_mm, error.rotation_deg, error.right_orientation_percent, error.cost, error.recordings,
                  error.recordings == 1 ? "" : "s");
  if (error.failed > 0) text += fmt::format(", {} of them could not be simulated", error.failed);
  return text;
}

/// What was done to the recordings, and what they do not tell.
void add_recordings(const SceneFit& fit, ordered_json& json) {
  json["refused"] = ordered_json::array();
  for (const UnknownDirection& direction : fit.unknown) {
    ordered_json shares = ordered_json::object();
    for (const auto& [name, share] : direction.shares) shares[name] = share;
    json["refused"].push_back({{"shares_of_bounds", shares}, {"error_in_bounds", number(direction.error)}});
  }
  json["unpredictable"] = ordered_json::array();
  for (const Unpredictable& one : fit.unpredictable)
    json["unpredictable"].push_back({{"recording", one.recording}, {"body", one.body}, {"from_s", one.from}});
  json["rejected_samples"] = ordered_json::array();
  for (const Rejected& one : fit.rejected)
    json["rejected_samples"].push_back({{"recording", one.recording}, {"body", one.body}, {"samples", one.samples}});
  json["smoothed"] = ordered_json::array();
  for (const Smoothing& one : fit.smoothed)
    json["smoothed"].push_back({{"recording", one.recording},
                                {"body", one.body},
                                {"position_noise_mm", 1e3 * one.position_noise},
                                {"rotation_noise_deg", 180.0 / std::numbers::pi * one.rotation_noise},
                                {"position_bandwidth_hz", one.position_bandwidth},
                                {"rotation_bandwidth_hz", one.rotation_bandwidth}});
}

/// How errors of the parameters hang together.
void add_errors(const SceneFit& fit, ordered_json& json) {
  json["correlations"] = ordered_json::array();
  for (const Correlated& pair : correlations(fit, 0.0))
    json["correlations"].push_back({{"a", pair.a}, {"b", pair.b}, {"correlation", pair.value}});
  if (!fit.profiles.empty()) json["profiles"] = ordered_json::array();
  for (const Profile& profile : fit.profiles) {
    ordered_json rises = ordered_json::array();
    for (const double rise : profile.rises) rises.push_back(number(rise));
    json["profiles"].push_back({{"name", profile.name},
                                {"low_95", number(profile.low)},
                                {"high_95", number(profile.high)},
                                {"values", profile.values},
                                {"rises", rises}});
  }
  json["covariance"] = ordered_json::array();
  for (Eigen::Index i = 0; i < fit.covariance.rows(); ++i) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index j = 0; j < fit.covariance.cols(); ++j) row.push_back(fit.covariance(i, j));
    json["covariance"].push_back(row);
  }
}

ordered_json as_json(const SceneFit& fit) {
  ordered_json json;
  json["parameters"] = ordered_json::array();
  for (const Parameter& parameter : fit.parameters) {
    json["parameters"].push_back({{"name", parameter.name},
                                  {"value", parameter.value},
                                  {"standard_error", number(parameter.standard_error)},
                                  {"verdict", name_of(parameter.verdict)}});
    if (!parameter.advice.empty()) json["parameters"].back()["record_instead"] = parameter.advice;
  }
  json["chi2_per_dof"] = number(fit.chi2_per_dof);
  json["held_back_error"] = number(fit.held_back_error);
  json["cost"] = fit.fitted.cost;
  json["is_trusted"] = fit.is_trusted;
  json["is_systematic"] = fit.is_systematic;
  json["before"] = as_json(fit.before);
  json["fitted"] = as_json(fit.fitted);
  if (fit.held_back.recordings > 0) {
    json["held_back_before"] = as_json(fit.held_back_before);
    json["held_back"] = as_json(fit.held_back);
  }
  json["sensitivity"] = ordered_json::array();
  for (const Sensitivity& row : fit.sensitivity)
    json["sensitivity"].push_back({{"name", row.name},
                                   {"step", row.step},
                                   {"position_mm", row.position_mm},
                                   {"rotation_deg", row.rotation_deg},
                                   {"error_alone", number(row.error_alone)},
                                   {"error_together", number(row.error_together)}});
  add_recordings(fit, json);
  add_errors(fit, json);
  json["evaluations"] = fit.evaluations;
  json["message"] = fit.message;
  return json;
}

/// Rows that are left out, samples that are rejected, poses that are smoothed.
std::string recordings_as_text(const SceneFit& fit) {
  std::string text;
  struct LeftOut {
    double from = 0.0;  // s, the earliest
    int recordings = 0;
  };
  std::map<std::string, LeftOut> left_out;  // by body
  for (const Unpredictable& one : fit.unpredictable) {
    LeftOut& of_body = left_out[one.body];
    of_body.from = of_body.recordings == 0 ? one.from : std::min(of_body.from, one.from);
    ++of_body.recordings;
  }
  for (const auto& [body, one] : left_out)
    text += fmt::format("left out: {} from {:.2f} s on, in {} recordings: its motion cannot be predicted from there\n",
                        body, one.from, one.recordings);
  for (const Rejected& one : fit.rejected)
    text += fmt::format("rejected: {} samples of {} in {} that jump away from their neighbours\n", one.samples,
                        one.body, one.recording);
  std::map<std::string, std::vector<Smoothing>> smoothed;  // by body
  for (const Smoothing& one : fit.smoothed) smoothed[one.body].push_back(one);
  for (const auto& [body, list] : smoothed) {
    const auto mean = [&list = list](double Smoothing::*member) {
      double sum = 0.0;
      for (const Smoothing& one : list) sum += one.*member;
      return sum / static_cast<double>(list.size());
    };
    text += fmt::format(
        "smoothed: poses of {} in {} recordings; noise of {:.3f} mm and {:.3f} deg found, {:.3g} and {:.3g} Hz "
        "followed, "
        "on average\n",
        body, list.size(), 1e3 * mean(&Smoothing::position_noise),
        180.0 / std::numbers::pi * mean(&Smoothing::rotation_noise), mean(&Smoothing::position_bandwidth),
        mean(&Smoothing::rotation_bandwidth));
  }
  return text;
}

std::string parameters_as_text(const SceneFit& fit) {
  std::string text;
  for (const Parameter& parameter : fit.parameters) {
    const bool is_fixed = std::isnan(parameter.standard_error) && parameter.advice.starts_with("held fixed");
    text += fmt::format("  {:<20} {:>12.6g} {} {}\n", parameter.name, parameter.value,
                        is_fixed ? "fixed       " : error_text(parameter.standard_error),
                        is_fixed ? "" : name_of(parameter.verdict));
    if (!parameter.advice.empty()) text += fmt::format("  {:<20} {}\n", "", parameter.advice);
  }
  return text;
}

std::string as_text(const SceneFit& fit) {
  std::string text =
      "what one step of each parameter changes at the values found (rms), its standard error alone / with all others\n";
  for (const Sensitivity& row : fit.sensitivity)
    text += fmt::format("  {:<20} step {:<9.4g} {:>9.3f} mm {:>9.3f} deg   {:>9.3g} / {:.3g}\n", row.name, row.step,
                        row.position_mm, row.rotation_deg, row.error_alone, row.error_together);
  for (const UnknownDirection& direction : fit.unknown) {
    text += "refused, the recordings do not tell:";
    for (const auto& [name, share] : direction.shares) text += fmt::format(" {:+.2f} {}", share, name);
    text += fmt::format(" (of what their bounds span; error {:.2g} of it)\n", direction.error);
  }
  text += fmt::format("before: {}\nfitted: {}\n", as_text(fit.before), as_text(fit.fitted));
  if (fit.held_back.recordings > 0)
    text +=
        fmt::format("held back, before: {}\nheld back: {}\n", as_text(fit.held_back_before), as_text(fit.held_back));
  if (std::isfinite(fit.held_back_error)) text += fmt::format("held-back error: {:.4f} mm\n", fit.held_back_error);
  constexpr double kSmall = 0.5;
  text += fmt::format("misfit: chi2 per degree of freedom {:.3g} with the noise of the task{}\n", fit.chi2_per_dof,
                      fit.chi2_per_dof > kExplained ? ": more than noise, no number is called identified"
                      : fit.chi2_per_dof < kSmall   ? ": the noise is smaller than the task says, and so are the errors"
                                                    : "");
  if (fit.is_systematic)
    text += "residuals are correlated: the remaining error is not noise, and no number is called identified\n";
  text += recordings_as_text(fit);
  if (!fit.is_trusted) text += "NOT to be trusted: the simulation misses the recordings by far more than noise\n";
  text += parameters_as_text(fit);
  for (const Correlated& pair : correlations(fit, 0.8))
    text += fmt::format("correlation of {} and {}: {:+.3f}\n", pair.a, pair.b, pair.value);
  for (const Profile& profile : fit.profiles)
    text += fmt::format("95 % of {} by its profile: {:.6g} to {:.6g}\n", profile.name, profile.low, profile.high);
  text += fmt::format("{} evaluations; {}\n", fit.evaluations, fit.message);
  return text;
}

}  // namespace

std::string format_json(const SceneError& error) { return as_json(error).dump(2) + "\n"; }
std::string format_table(const SceneError& error) { return as_text(error) + "\n"; }
std::string format_json(const SceneFit& fit) { return as_json(fit).dump(2) + "\n"; }
std::string format_table(const SceneFit& fit) { return as_text(fit); }

}  // namespace snug::identification
