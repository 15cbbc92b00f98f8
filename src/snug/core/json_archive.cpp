// JsonReader: numbers of a JSON document, checked.
#include "snug/core/json_archive.hpp"

#include <limits>

namespace snug::json_detail {

double number_of(const JsonReader& reader) {
  const auto& value = reader.value().value;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* number = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*number);
  if (const auto* number = std::get_if<std::int64_t>(&value)) return static_cast<double>(*number);
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (*text == "inf") return std::numeric_limits<double>::infinity();
    if (*text == "-inf") return -std::numeric_limits<double>::infinity();
    if (*text == "nan") return std::numeric_limits<double>::quiet_NaN();
  }
  reader.fail("a number");
}

std::int64_t whole_of(const JsonReader& reader) {
  const auto& value = reader.value().value;
  constexpr std::int64_t kLargest = std::numeric_limits<int>::max(), kSmallest = std::numeric_limits<int>::min();
  if (const auto* number = std::get_if<std::uint64_t>(&value); number != nullptr && *number <= std::uint64_t{kLargest})
    return static_cast<std::int64_t>(*number);
  if (const auto* number = std::get_if<std::int64_t>(&value); number != nullptr && *number >= kSmallest) return *number;
  reader.fail("a whole number");
}

std::uint64_t unsigned_of(const JsonReader& reader) {
  const auto* number = std::get_if<std::uint64_t>(&reader.value().value);
  if (number == nullptr) reader.fail("a whole number, not below 0");
  return *number;
}

}  // namespace snug::json_detail
