// ApiForms: what requests and answers of the interface of `snug ui` look like, once: types of TypeScript are made of
// it, and answers are held against it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace snug::workspace {

struct ApiField {
  std::string_view name;  ///< with "?" behind it: may be left out
  /// string, number, boolean, null, a word in quotes, a form, Record<string, T>, T[], [T, T], or T | T
  std::string_view type;
  std::string_view note;  ///< for who reads the types; empty: none
};

struct ApiForm {
  std::string_view name;
  std::string_view note;
  std::vector<ApiField> fields;
};

/// All forms; one that others have in them may stand behind them.
[[nodiscard]] const std::vector<ApiForm>& api_forms();

/// viewer/src/workspace/api_types.ts
[[nodiscard]] std::string format_api_types();

/// Where `json` is not of `type` (as ApiField::type): "lines.0.count: 1.5 instead of string"; empty where it is.
[[nodiscard]] std::string find_deviation(const nlohmann::ordered_json& json, std::string_view type);

}  // namespace snug::workspace
