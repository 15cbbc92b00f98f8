// Value, MapReader: a YAML node that knows its file, line and key, so that every complaint can name them.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "snug/core/field.hpp"
#include "snug/core/input_error.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model::internal {

/// What is known about the text being read. Outlives all its Values.
struct Document {
  std::string name;                  ///< file or label, for messages
  std::set<std::string> known_keys;  ///< "kind.key" of every key that any mapping read so far may have
  std::vector<std::filesystem::path> side_files = {};  ///< that were found beside it
  std::vector<std::string> warnings = {};              ///< what a reader took otherwise than its writer may think
};

/// Bounds of a length, m: outside of them a value is taken for a slip (millimetres, say) and refused.
inline constexpr double kSmallestSize = 1e-4;
inline constexpr double kLargestSize = 100.0;
inline constexpr double kFarthestPosition = 1000.0;

class MapReader;

class Value {
 public:
  Value(YAML::Node node, std::string path, Document& document, int line);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string where() const;
  [[nodiscard]] Document& document() const { return *document_; }

  /// What stands here, in a few words, for messages.
  [[nodiscard]] std::string describe() const;
  [[noreturn]] void fail(const std::string& expected) const;
  [[noreturn]] void fail(const std::string& got, const std::string& expected) const;

  [[nodiscard]] bool is_scalar() const { return node_.IsScalar(); }
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }

  [[nodiscard]] double number(Range range = Range::Any) const;
  /// Finite, within [low, high]; `what` names it in the message.
  [[nodiscard]] double number_within(double low, double high, const std::string& what) const;
  /// Edge length, radius or thickness of something real, m.
  [[nodiscard]] double size() const;
  [[nodiscard]] double mass() const;
  [[nodiscard]] double radians_from_degrees(Range range = Range::Any) const;
  [[nodiscard]] std::int64_t integer(std::int64_t low, std::int64_t high) const;
  [[nodiscard]] bool boolean() const;
  /// Non-empty, at most 120 printable characters.
  [[nodiscard]] std::string name() const;
  /// Of a file, as it is written.
  [[nodiscard]] std::string file() const;
  /// A name, or "".
  [[nodiscard]] std::string name_or_empty() const { return is_scalar() && node_.Scalar().empty() ? "" : name(); }
  /// One of the given words; the index of the one that stands here.
  [[nodiscard]] std::size_t choice(const std::vector<std::string>& words) const;

  [[nodiscard]] std::vector<Value> list() const;
  [[nodiscard]] std::vector<Value> list_of(std::size_t count, const std::string& what) const;
  [[nodiscard]] Vector3 vector3() const;
  [[nodiscard]] Vector3 position() const;  ///< m
  [[nodiscard]] Vector3 sizes() const;     ///< three edge lengths, m

  /// The mapping here, which may have these keys and no others. `kind` is what docs/scenario.md calls it.
  [[nodiscard]] MapReader map(const std::string& kind, std::vector<std::string> keys) const;

 private:
  friend class MapReader;
  YAML::Node node_;
  std::string path_;
  Document* document_;
  int line_;
};

/// A mapping whose keys were all checked against what it may have when it was made: an unknown, repeated or
/// non-textual key never gets this far, and asking for a key that was not declared is a bug.
class MapReader {
 public:
  MapReader(const Value& self, const std::string& kind, std::vector<std::string> keys);

  [[nodiscard]] const Value& self() const { return self_; }
  [[nodiscard]] bool has(std::string_view key) const { return find(key).has_value(); }
  [[nodiscard]] std::optional<Value> find(std::string_view key) const;
  [[nodiscard]] Value require(std::string_view key) const;
  /// Throws unless exactly one of the keys is there; returns it.
  [[nodiscard]] std::string require_one_of(const std::vector<std::string>& keys) const;
  /// Throws when both are there.
  void forbid_together(std::string_view key, std::string_view other) const;

 private:
  Value self_;
  std::vector<std::string> keys_;
  std::vector<std::pair<std::string, Value>> entries_;
};

[[nodiscard]] std::string quote(std::string_view text);
/// Shortest text that reads back as the same number.
[[nodiscard]] std::string to_text(double value);
/// ", nearest is 'x'" or nothing.
[[nodiscard]] std::string nearest_hint(std::string_view word, const std::vector<std::string>& words);

}  // namespace snug::model::internal
