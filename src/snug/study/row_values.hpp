// The outputs of a study's row by name.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "snug/study/table.hpp"

namespace snug::study {

class RowValues {
 public:
  /// `result` must outlive this.
  explicit RowValues(const RowResult& result) : result_(result) {}

  [[nodiscard]] double number(const std::string& name, double otherwise = 0.0) const {
    const auto* value = std::get_if<double>(find(name));
    return value != nullptr ? *value : otherwise;
  }
  [[nodiscard]] int count(const std::string& name) const { return static_cast<int>(number(name)); }
  [[nodiscard]] std::string word(const std::string& name) const {
    const auto* value = std::get_if<std::string>(find(name));
    return value != nullptr ? *value : std::string();
  }
  /// A list that was kept as text; empty where there is none.
  [[nodiscard]] nlohmann::ordered_json list(const std::string& name) const {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(word(name), nullptr, false);
    return json.is_array() ? json : nlohmann::ordered_json::array();
  }

 private:
  [[nodiscard]] const Cell* find(const std::string& name) const {
    for (const auto* cells : {&result_.values, &result_.clock}) {
      for (const auto& [key, value] : *cells) {
        if (key == name) return &value;
      }
    }
    return nullptr;
  }
  const RowResult& result_;
};

}  // namespace snug::study
