// Calibration of predicted success in the JSON of pack and compare, written and read.
#pragma once

#include <nlohmann/json.hpp>

#include "snug/study/calibration.hpp"

namespace snug::study {

/// Bins that hold some motions.
[[nodiscard]] inline nlohmann::ordered_json calibration_json(const Calibration& calibration) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < calibration.bins.size(); ++i) {
    const CalibrationBin& bin = calibration.bins[i];
    if (bin.motions == 0) continue;
    bins.push_back({{"from_percent", 10 * i},
                    {"to_percent", 10 * (i + 1)},
                    {"motions", bin.motions},
                    {"succeeded", bin.succeeded},
                    {"predicted_percent", 100.0 * bin.predicted / bin.motions},
                    {"observed_percent", 100.0 * bin.succeeded / bin.motions}});
  }
  return bins;
}

/// Of what calibration_json() wrote.
[[nodiscard]] inline Calibration read_calibration(const nlohmann::ordered_json& bins) {
  Calibration calibration;
  for (const nlohmann::ordered_json& json : bins) {
    const int motions = json.at("motions").get<int>();
    calibration.bins.at(json.at("from_percent").get<std::size_t>() / 10) = {
        motions, json.at("succeeded").get<int>(), 0.01 * motions * json.at("predicted_percent").get<double>()};
  }
  return calibration;
}

}  // namespace snug::study
