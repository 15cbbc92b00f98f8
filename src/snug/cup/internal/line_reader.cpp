// LineReader: one JSON object, read strictly, key by key.
#include "snug/cup/internal/line_reader.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::cup::internal {
namespace {

using nlohmann::json;

constexpr double kRotationTolerance = 1e-6;  // of R^T R: a rotation that was printed with seven digits passes
constexpr double kSymmetryTolerance = 1e-9;  // relative to the largest entry

constexpr int kDeepest = 8;  // printing deeper ones takes stack without end

constexpr const char* kVectorShape = "a list of 3 numbers";
constexpr const char* kRotationShape = "3 rows of 3 numbers, a rotation";
constexpr const char* kStiffnessShape = "6 rows of 6 numbers, symmetric";

std::string shown(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool is_finite_number(const json& value) { return value.is_number() && std::isfinite(value.get<double>()); }

}  // namespace

LineReader::LineReader(std::string_view line, int line_number, std::string_view source,
                       const std::vector<std::string>& read, const std::vector<std::string>& ignored)
    : where_(std::string(source) + ":" + std::to_string(line_number)) {
  if (!is_utf8(line)) fail("", "bytes that are not UTF-8", "text in UTF-8");
  std::set<std::string> seen;
  std::string repeated;
  bool is_too_deep = false;
  const auto note_keys = [&](int depth, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::key && depth == 1 && !seen.insert(parsed.get<std::string>()).second) {
      repeated = parsed.get<std::string>();
    }
    is_too_deep = is_too_deep || depth > kDeepest;
    return !is_too_deep;
  };
  try {
    content_ = json::parse(line.begin(), line.end(), note_keys);
  } catch (const json::parse_error& error) {
    fail("", "something that is not JSON at character " + std::to_string(error.byte), "one JSON object on the line");
  } catch (const json::exception&) {
    fail("", "a number beyond the range of double precision", "finite numbers");
  }
  if (is_too_deep) fail("", "lists in lists that are deeper than any number here", "one JSON object on the line");
  if (!content_.is_object()) fail("", shown(content_), "one JSON object on the line");
  if (!repeated.empty()) fail(repeated, "the key twice", "each key once");
  std::vector<std::string> known = read;
  known.insert(known.end(), ignored.begin(), ignored.end());
  for (const auto& item : content_.items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    const std::string_view nearest = find_nearest(item.key(), known);
    fail(item.key(), "an unknown key",
         nearest.empty() ? "one of " + joined(read) : "a known key, perhaps " + std::string(nearest));
  }
}

void LineReader::fail(const std::string& key, const std::string& got, const std::string& expected) const {
  throw InputError(where_, key, got, expected);
}

const json& LineReader::value(const json& object, const std::string& name, const std::string& key,
                              const char* expected) const {
  const auto found = object.find(name);
  if (found == object.end()) fail(key, "nothing", expected);
  return *found;
}

double LineReader::number(const std::string& key) const {
  const json& got = value(content_, key, key, "a number");
  if (!is_finite_number(got)) fail(key, shown(got), "a finite number");
  return got.get<double>();
}

double LineReader::number_at_least_zero(const std::string& key) const {
  const double got = number(key);
  if (got < 0.0) fail(key, shown(content_.at(key)), "a number that is not negative");
  return got;
}

void LineReader::read_rows(const json& rows, const std::string& key, int size, const char* expected,
                           double* row_major) const {
  const auto n = static_cast<std::size_t>(size);
  if (!rows.is_array()) fail(key, shown(rows), expected);
  if (rows.size() != n) fail(key, std::to_string(rows.size()) + " rows", expected);
  for (std::size_t i = 0; i < n; ++i) {
    const std::string row_key = key + "[" + std::to_string(i) + "]";
    if (!rows[i].is_array() || rows[i].size() != n) fail(row_key, shown(rows[i]), expected);
    for (std::size_t j = 0; j < n; ++j) {
      if (!is_finite_number(rows[i][j])) {
        fail(row_key + "[" + std::to_string(j) + "]", shown(rows[i][j]), "a finite number");
      }
      row_major[n * i + j] = rows[i][j].get<double>();
    }
  }
}

Vector3 LineReader::vector_from(const json& list, const std::string& key) const {
  if (!list.is_array() || list.size() != 3) fail(key, shown(list), kVectorShape);
  Vector3 out;
  for (int i = 0; i < 3; ++i) {
    const json& entry = list[static_cast<std::size_t>(i)];
    if (!is_finite_number(entry)) fail(key + "[" + std::to_string(i) + "]", shown(entry), "a finite number");
    out[i] = entry.get<double>();
  }
  return out;
}

Matrix3 LineReader::rotation_from(const json& rows, const std::string& key) const {
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R;
  read_rows(rows, key, 3, kRotationShape, R.data());
  const Matrix3 excess = R.transpose() * R - Matrix3::Identity();
  if (!(excess.cwiseAbs().maxCoeff() <= kRotationTolerance)) {
    fail(key, shown(rows), "a rotation: R^T R equal to the identity within 1e-6");
  }
  if (R.determinant() < 0.0) fail(key, "a reflection, determinant -1", "a rotation, determinant +1");
  return R;
}

Vector3 LineReader::vector(const std::string& key) const {
  return vector_from(value(content_, key, key, kVectorShape), key);
}

Matrix3 LineReader::rotation(const std::string& key) const {
  return rotation_from(value(content_, key, key, kRotationShape), key);
}

Pose LineReader::pose(const std::string& key) const {
  constexpr const char* kShape = "an object with R and o";
  const json& object = value(content_, key, key, kShape);
  if (!object.is_object()) fail(key, shown(object), kShape);
  for (const auto& item : object.items()) {
    if (item.key() != "R" && item.key() != "o") fail(key + "." + item.key(), "an unknown key", "R or o");
  }
  return {rotation_from(value(object, "R", key + ".R", kRotationShape), key + ".R"),
          vector_from(value(object, "o", key + ".o", kVectorShape), key + ".o")};
}

Matrix6 LineReader::stiffness(const std::string& key) const {
  const json& rows = value(content_, key, key, kStiffnessShape);
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> K;
  read_rows(rows, key, 6, kStiffnessShape, K.data());
  const double size = K.cwiseAbs().maxCoeff();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) {
      if (!(std::abs(K(i, j) - K(j, i)) <= kSymmetryTolerance * size)) {
        const std::string at = "[" + std::to_string(i) + "][" + std::to_string(j) + "]";
        const std::string mirrored = "[" + std::to_string(j) + "][" + std::to_string(i) + "]";
        const auto entry = [&rows](int r, int c) {
          return shown(rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)]);
        };
        fail(key + at, entry(i, j) + " but " + entry(j, i) + " at " + mirrored, "a symmetric matrix (within 1e-9)");
      }
    }
  }
  const Matrix6 scaled = K / std::max(size, 1e-300);
  const double smallest = symmetric_eigenvalues(scaled).minCoeff();
  if (!(smallest >= -kSymmetryTolerance))
    fail(key, "a negative eigenvalue", "a stiffness without negative eigenvalues");
  return K;
}

}  // namespace snug::cup::internal
