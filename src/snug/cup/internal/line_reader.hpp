// LineReader: one JSON object, read strictly, key by key.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::cup::internal {

/// Every getter throws InputError with "source:line" and the key when the value is missing, misshapen, not finite, or
/// not what its name says.
class LineReader {
 public:
  /// `read` are the keys that the getters will ask for, `ignored` those that may stand there without being read.
  LineReader(std::string_view line, int line_number, std::string_view source, const std::vector<std::string>& read,
             const std::vector<std::string>& ignored);

  [[nodiscard]] const nlohmann::json& content() const { return content_; }
  [[nodiscard]] double number(const std::string& key) const;
  [[nodiscard]] double number_at_least_zero(const std::string& key) const;
  [[nodiscard]] Vector3 vector(const std::string& key) const;
  [[nodiscard]] Matrix3 rotation(const std::string& key) const;
  /// {"R": rotation, "o": vector}
  [[nodiscard]] Pose pose(const std::string& key) const;
  /// Symmetric, no negative eigenvalue.
  [[nodiscard]] Matrix6 stiffness(const std::string& key) const;

  [[noreturn]] void fail(const std::string& key, const std::string& got, const std::string& expected) const;

 private:
  [[nodiscard]] const nlohmann::json& value(const nlohmann::json& object, const std::string& name,
                                            const std::string& key, const char* expected) const;
  void read_rows(const nlohmann::json& rows, const std::string& key, int size, const char* expected,
                 double* row_major) const;
  [[nodiscard]] Vector3 vector_from(const nlohmann::json& list, const std::string& key) const;
  [[nodiscard]] Matrix3 rotation_from(const nlohmann::json& rows, const std::string& key) const;

  std::string where_;
  nlohmann::json content_;
};

}  // namespace snug::cup::internal
