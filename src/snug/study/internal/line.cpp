// Line: JSON on one line, ending with a sum over the rest, so that a line cut short is known as such.
#include "snug/study/internal/line.hpp"

#include <fmt/format.h>

#include <string_view>

#include "snug/core/hash.hpp"
#include "snug/core/json_value.hpp"

namespace snug::study::internal {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::string_view kSum = ",\"sum\":\"";

std::string sum_of(std::string_view text) {
  Hash hash;
  hash.add(text);
  return fmt::format("{:016x}", hash.value());
}

}  // namespace

std::string with_sum(const Json& json) {
  std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  line.pop_back();
  return line + std::string(kSum) + sum_of(line) + "\"}\n";
}

std::optional<Json> without_sum(const std::string& line) {
  const std::size_t sum = line.rfind(kSum);
  if (sum == std::string::npos || line.substr(sum + kSum.size()) != sum_of(line.substr(0, sum)) + "\"}")
    return std::nullopt;
  if (!is_shallow_json(line)) return std::nullopt;
  Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

}  // namespace snug::study::internal
