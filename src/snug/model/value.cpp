// Value: strict conversions of YAML nodes, each complaint with file, line, key and what would do.
#include "snug/model/internal/value.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/text.hpp"

namespace snug::model::internal {
namespace {

/// Larger magnitudes in a scenario are slips; keeps products of a few values far from overflow.
constexpr double kLargestNumber = 1e12;
constexpr double kSmallestMass = 1e-6;
constexpr double kLargestMass = 1e5;
constexpr std::size_t kLongestName = 120;
constexpr std::size_t kLongestPath = 4096;

std::string_view range_text(Range range) {
  switch (range) {
    case Range::Any:
      return "a finite number";
    case Range::Positive:
      return "a number > 0";
    case Range::NotNegative:
      return "a number >= 0";
    case Range::Fraction:
      return "a number from 0 to 1";
  }
  return "";
}

bool is_within(double x, Range range) {
  switch (range) {
    case Range::Any:
      return true;
    case Range::Positive:
      return x > 0.0;
    case Range::NotNegative:
      return x >= 0.0;
    case Range::Fraction:
      return x >= 0.0 && x <= 1.0;
  }
  return false;
}

/// Line of a node in the text, or the fallback for nodes that stand nowhere (aliases of nothing, empty values).
int line_of(const YAML::Node& node, int fallback) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() || (mark.line == 0 && mark.pos == 0 && node.IsNull()) ? fallback : mark.line + 1;
}

}  // namespace

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  return "'" + printable(text, kLongest) + "'";
}

std::string to_text(double value) {
  char buffer[32];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return error == std::errc() ? std::string(buffer, end) : std::string("?");
}

std::string nearest_hint(std::string_view word, const std::vector<std::string>& words) {
  const std::string_view nearest = find_nearest(word, words);
  return nearest.empty() ? std::string() : ", nearest is " + quote(nearest);
}

Value::Value(YAML::Node node, std::string path, Document& document, int line)
    : node_(std::move(node)), path_(std::move(path)), document_(&document), line_(line_of(node_, line)) {}

std::string Value::where() const { return document_->name + ":" + std::to_string(line_); }

std::string Value::describe() const {
  if (node_.IsScalar()) return quote(node_.Scalar());
  if (node_.IsSequence()) return "a list of " + std::to_string(node_.size());
  if (node_.IsMap()) return "a mapping";
  return "nothing";
}

void Value::fail(const std::string& expected) const { fail(describe(), expected); }

void Value::fail(const std::string& got, const std::string& expected) const {
  throw InputError(where(), path_, got, expected);
}

double Value::number(Range range) const {
  const std::string expected = std::string(range_text(range)) + ", SI units, without unit text";
  if (!node_.IsScalar() || node_.Tag() == "!") fail(expected);
  std::string_view text = node_.Scalar();
  if (text.starts_with('+')) text.remove_prefix(1);
  double x = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size()) fail(expected);
  if (std::isfinite(x) && std::abs(x) > kLargestNumber) fail("a magnitude of at most " + to_text(kLargestNumber));
  if (!std::isfinite(x) || !is_within(x, range)) fail(expected);
  return x;
}

double Value::number_within(double low, double high, const std::string& what) const {
  const double x = number();
  if (!(x >= low && x <= high)) fail(what + " from " + to_text(low) + " to " + to_text(high));
  return x;
}

double Value::size() const { return number_within(kSmallestSize, kLargestSize, "a size in metres"); }

double Value::mass() const { return number_within(kSmallestMass, kLargestMass, "a mass in kg"); }

double Value::radians_from_degrees(Range range) const {
  const double degrees = number(range);
  if (std::abs(degrees) > 3600.0) fail("an angle in degrees from -3600 to 3600");
  return degrees * (std::numbers::pi / 180.0);
}

std::int64_t Value::integer(std::int64_t low, std::int64_t high) const {
  const std::string expected = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (!node_.IsScalar() || node_.Tag() == "!") fail(expected);
  const std::string& text = node_.Scalar();
  std::int64_t x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || x < low || x > high) fail(expected);
  return x;
}

bool Value::boolean() const {
  if (node_.IsScalar() && node_.Tag() != "!") {
    if (node_.Scalar() == "true") return true;
    if (node_.Scalar() == "false") return false;
  }
  fail("true or false");
}

std::string Value::name() const {
  const std::string expected = "a name of 1 to " + std::to_string(kLongestName) + " printable characters";
  if (!node_.IsScalar()) fail(expected);
  const std::string& text = node_.Scalar();
  if (text.empty() || text.size() > kLongestName || !is_printable(text)) fail(expected);
  return text;
}

std::string Value::file() const {
  const char* expected = "the path of a file: 1 to 4096 printable characters";
  if (!node_.IsScalar()) fail(expected);
  const std::string& text = node_.Scalar();
  if (text.empty() || text.size() > kLongestPath || !is_printable(text)) fail(expected);
  return text;
}

std::size_t Value::choice(const std::vector<std::string>& words) const {
  std::string expected = "one of";
  for (const std::string& word : words) expected += " " + word;
  if (!node_.IsScalar()) fail(expected);
  const auto found = std::find(words.begin(), words.end(), node_.Scalar());
  if (found == words.end()) fail(expected + nearest_hint(node_.Scalar(), words));
  return static_cast<std::size_t>(found - words.begin());
}

std::vector<Value> Value::list() const {
  if (!node_.IsSequence()) fail("a list");
  std::vector<Value> values;
  for (std::size_t i = 0; i < node_.size(); ++i)
    values.emplace_back(node_[i], path_ + "[" + std::to_string(i) + "]", *document_, line_);
  return values;
}

std::vector<Value> Value::list_of(std::size_t count, const std::string& what) const {
  if (!node_.IsSequence() || node_.size() != count) fail("a list of " + std::to_string(count) + " " + what);
  return list();
}

Vector3 Value::vector3() const {
  const std::vector<Value> parts = list_of(3, "numbers");
  return {parts[0].number(), parts[1].number(), parts[2].number()};
}

Vector3 Value::position() const {
  Vector3 p = Vector3::Zero();
  int i = 0;
  for (const Value& part : list_of(3, "positions in metres"))
    p(i++) = part.number_within(-kFarthestPosition, kFarthestPosition, "a position in metres");
  return p;
}

Vector3 Value::sizes() const {
  Vector3 edges = Vector3::Zero();
  int i = 0;
  for (const Value& part : list_of(3, "sizes in metres")) edges(i++) = part.size();
  return edges;
}

MapReader Value::map(const std::string& kind, std::vector<std::string> keys) const {
  return MapReader(*this, kind, std::move(keys));
}

MapReader::MapReader(const Value& self, const std::string& kind, std::vector<std::string> keys)
    : self_(self), keys_(std::move(keys)) {
  for (const std::string& key : keys_) self_.document().known_keys.insert(kind + "." + key);
  if (!self_.node_.IsMap()) self_.fail("a mapping");
  const std::string prefix = self_.path().empty() ? "" : self_.path() + ".";
  for (const auto& entry : self_.node_) {
    const Value key_value(entry.first, prefix + "?", self_.document(), self_.line_);
    if (!entry.first.IsScalar()) key_value.fail("a key in words");
    const std::string key = entry.first.Scalar();
    const Value at_key(entry.first, prefix + key, self_.document(), self_.line_);
    if (std::find(keys_.begin(), keys_.end(), key) == keys_.end()) {
      std::string all;
      for (const std::string& known : keys_) all += (all.empty() ? "" : ", ") + known;
      const std::string_view nearest = find_nearest(key, keys_);
      at_key.fail("unknown key " + quote(key),
                  (nearest.empty() ? "" : quote(nearest) + " (nearest); ") + "keys here are " + all);
    }
    for (const auto& known : entries_)
      if (known.first == key) at_key.fail("key " + quote(key) + " a second time", "each key once");
    entries_.emplace_back(key, Value(entry.second, prefix + key, self_.document(), key_value.line_));
  }
}

std::optional<Value> MapReader::find(std::string_view key) const {
  SNUG_CHECK(std::find(keys_.begin(), keys_.end(), key) != keys_.end(), "key was not declared");
  for (const auto& [known, value] : entries_)
    if (known == key) return value;
  return std::nullopt;
}

Value MapReader::require(std::string_view key) const {
  if (const auto value = find(key)) return *value;
  const std::string path = (self_.path().empty() ? "" : self_.path() + ".") + std::string(key);
  throw InputError(self_.where(), path, "nothing", "key " + quote(key) + ", which is required here");
}

std::string MapReader::require_one_of(const std::vector<std::string>& keys) const {
  std::string found, all;
  for (const std::string& key : keys) {
    all += (all.empty() ? "" : ", ") + key;
    if (!has(key)) continue;
    if (!found.empty()) require(key).fail(quote(found) + " and " + quote(key), "only one of " + all);
    found = key;
  }
  if (found.empty()) self_.fail("none of them", "one of the keys " + all);
  return found;
}

void MapReader::forbid_together(std::string_view key, std::string_view other) const {
  if (has(key) && has(other)) require(other).fail("both " + quote(key) + " and " + quote(other), "one of the two");
}

}  // namespace snug::model::internal
