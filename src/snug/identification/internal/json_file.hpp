// JsonValue: a value of a JSON file with its place, so that each complaint names file and path.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::identification::internal {

/// Values of a document, a list or object counted as two: it takes up to 200 bytes, be it written with two. A record of
/// measurements has some dozens.
inline constexpr std::size_t kMostJsonValues = 1'000'000;
/// Lists and objects within each other; records have five.
inline constexpr std::size_t kDeepestJson = 100;

/// Throws InputError "file:line" when the text is no JSON document, or ends too early; with the file when it has more
/// than kMostJsonValues values or is deeper than kDeepestJson.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, const std::string& name);

/// Every getter throws InputError with the file and the path (records[3].mass) when the value is missing, misshapen,
/// not finite, or not what its name says.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& content, std::string file, std::string path = {})
      : content_(&content), file_(std::move(file)), path_(std::move(path)) {}

  [[nodiscard]] bool has(const std::string& key) const { return content_->contains(key); }
  /// The value must be an object; a key that looks like a misspelt one of these is refused, others are left alone.
  void check_keys(const std::vector<std::string>& known) const;
  [[nodiscard]] JsonValue at(const std::string& key) const;
  /// Entries of a list that is not empty.
  [[nodiscard]] std::vector<JsonValue> entries() const;
  [[nodiscard]] std::size_t size() const { return content_->size(); }
  [[nodiscard]] std::string text() const;

  [[nodiscard]] double number() const;
  [[nodiscard]] double positive() const;
  [[nodiscard]] double not_negative() const;
  [[nodiscard]] Vector3 vector3() const;
  [[nodiscard]] Vector6 vector6() const;
  [[nodiscard]] Matrix3 rotation() const;    ///< 3 rows of 3
  [[nodiscard]] Matrix3 symmetric3() const;  ///< 3 rows of 3
  [[nodiscard]] Matrix6 symmetric6() const;  ///< 6 rows of 6
  [[nodiscard]] Matrix3 quaternion() const;  ///< [w, x, y, z], of unit length within 1e-3

  [[nodiscard]] std::string where() const;
  [[noreturn]] void fail(const std::string& got, const std::string& expected) const;

 private:
  void read_numbers(std::size_t count, const char* shape, double* out) const;
  void read_rows(std::size_t size, const char* shape, double* column_major) const;
  [[nodiscard]] std::string shown() const;

  const nlohmann::json* content_;
  std::string file_;
  std::string path_;
};

/// A rotation from w, x, y, z; false when they are not of unit length within 1e-3.
[[nodiscard]] bool rotation_from_quaternion(const double* wxyz, Matrix3& R);

}  // namespace snug::identification::internal
