// JsonValue: strict reading of one JSON document.
#include "snug/identification/internal/json_file.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/input_error.hpp"

namespace snug::identification::internal {

using nlohmann::json;

constexpr double kUnitTolerance = 1e-3;      // of a quaternion's length, as for placements
constexpr double kRotationTolerance = 1e-6;  // of R^T R: a rotation that was printed with seven digits passes
constexpr double kSymmetryTolerance = 1e-9;  // relative to the largest entry

/// Takes the events of the library's parser and keeps nothing: the limits are known before any value takes memory.
class LimitCheck : public nlohmann::json_sax<json> {
 public:
  explicit LimitCheck(const std::string& name) : name_(name) {}

  bool null() override { return add(); }
  bool boolean(bool) override { return add(); }
  bool number_integer(json::number_integer_t) override { return add(); }
  bool number_unsigned(json::number_unsigned_t) override { return add(); }
  bool number_float(json::number_float_t, const std::string&) override { return add(); }
  bool string(std::string&) override { return add(); }
  bool binary(json::binary_t&) override { return add(); }
  bool key(std::string&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  /// Told by the parser that makes the values.
  bool parse_error(std::size_t, const std::string&, const json::exception&) override { return false; }

 private:
  bool add(std::size_t count = 1) {
    values_ += count;
    if (values_ > kMostJsonValues)
      throw InputError(name_, "", "more than " + std::to_string(kMostJsonValues) + " values",
                       std::to_string(kMostJsonValues) + " or fewer, a list or object counted as two");
    return true;
  }
  bool open() {
    if (++depth_ > kDeepestJson)
      throw InputError(name_, "", "lists and objects within each other, more than " + std::to_string(kDeepestJson),
                       std::to_string(kDeepestJson) + " or fewer");
    return add(2);
  }
  bool close() {
    --depth_;
    return true;
  }

  const std::string& name_;
  std::size_t values_ = 0, depth_ = 0;
};

json parse_json(std::string_view text, const std::string& name) {
  LimitCheck check(name);
  (void)json::sax_parse(text, &check);
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const std::size_t at = std::min(error.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    throw InputError(name + ":" + std::to_string(line), "",
                     error.byte >= text.size() ? "a file that ends in the middle"
                                               : "something that is not JSON at byte " + std::to_string(error.byte),
                     "one whole JSON document");
  } catch (const json::exception&) {
    throw InputError(name, "", "a number beyond the range of double precision", "finite numbers");
  }
}

bool rotation_from_quaternion(const double* wxyz, Matrix3& R) {
  const Quaternion quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(quat.norm() - 1.0) <= kUnitTolerance)) return false;
  R = quat.normalized().toRotationMatrix();
  return true;
}

std::string JsonValue::shown() const {
  std::string text = content_->dump(-1, ' ', false, json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string JsonValue::where() const { return path_.empty() ? file_ : file_ + ": " + path_; }

void JsonValue::fail(const std::string& got, const std::string& expected) const {
  throw InputError(file_, path_, got, expected);
}

void JsonValue::check_keys(const std::vector<std::string>& known) const {
  if (!content_->is_object()) fail(shown(), "an object");
  for (const auto& item : content_->items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    // Two edits turn any short word into any other: only longer ones are taken for slips.
    const std::string_view nearest = item.key().size() < 5 ? "" : find_nearest(item.key(), known);
    if (!nearest.empty())
      JsonValue(item.value(), file_, (path_.empty() ? "" : path_ + ".") + item.key())
          .fail("an unknown key", "a known key, perhaps " + std::string(nearest));
  }
}

JsonValue JsonValue::at(const std::string& key) const {
  if (!content_->is_object()) fail(shown(), "an object with " + key);
  const auto found = content_->find(key);
  const std::string path = (path_.empty() ? "" : path_ + ".") + key;
  if (found == content_->end()) throw InputError(file_, path, "nothing", "this key");
  return {*found, file_, path};
}

std::vector<JsonValue> JsonValue::entries() const {
  if (!content_->is_array() || content_->empty()) fail(shown(), "a list that is not empty");
  std::vector<JsonValue> list;
  for (std::size_t i = 0; i < content_->size(); ++i)
    list.emplace_back((*content_)[i], file_, path_ + "[" + std::to_string(i) + "]");
  return list;
}

std::string JsonValue::text() const { return content_->is_string() ? content_->get<std::string>() : shown(); }

double JsonValue::number() const {
  if (!content_->is_number() || !std::isfinite(content_->get<double>())) fail(shown(), "a finite number");
  return content_->get<double>();
}

double JsonValue::positive() const {
  const double value = number();
  if (!(value > 0.0)) fail(shown(), "a number above 0");
  return value;
}

double JsonValue::not_negative() const {
  const double value = number();
  if (!(value >= 0.0)) fail(shown(), "a number that is not negative");
  return value;
}

void JsonValue::read_numbers(std::size_t count, const char* shape, double* out) const {
  if (!content_->is_array() || content_->size() != count) fail(shown(), shape);
  for (std::size_t i = 0; i < count; ++i)
    out[i] = JsonValue((*content_)[i], file_, path_ + "[" + std::to_string(i) + "]").number();
}

void JsonValue::read_rows(std::size_t size, const char* shape, double* column_major) const {
  if (!content_->is_array() || content_->size() != size) fail(shown(), shape);
  std::vector<double> row(size);
  for (std::size_t i = 0; i < size; ++i) {
    JsonValue((*content_)[i], file_, path_ + "[" + std::to_string(i) + "]").read_numbers(size, shape, row.data());
    for (std::size_t j = 0; j < size; ++j) column_major[j * size + i] = row[j];
  }
}

Vector3 JsonValue::vector3() const {
  Vector3 out;
  read_numbers(3, "a list of 3 numbers", out.data());
  return out;
}

Vector6 JsonValue::vector6() const {
  Vector6 out;
  read_numbers(6, "a list of 6 numbers, force first", out.data());
  return out;
}

Matrix3 JsonValue::rotation() const {
  Matrix3 R;
  read_rows(3, "3 rows of 3 numbers, a rotation", R.data());
  if (!((R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff() <= kRotationTolerance))
    fail(shown(), "a rotation: R^T R equal to the identity within 1e-6");
  if (R.determinant() < 0.0) fail("a reflection, determinant -1", "a rotation, determinant +1");
  return R;
}

Matrix3 JsonValue::symmetric3() const {
  Matrix3 A;
  read_rows(3, "3 rows of 3 numbers, symmetric", A.data());
  if (!((A - A.transpose()).cwiseAbs().maxCoeff() <= kSymmetryTolerance * A.cwiseAbs().maxCoeff()))
    fail(shown(), "a symmetric matrix (within 1e-9)");
  return A;
}

Matrix6 JsonValue::symmetric6() const {
  Matrix6 A;
  read_rows(6, "6 rows of 6 numbers, symmetric", A.data());
  if (!((A - A.transpose()).cwiseAbs().maxCoeff() <= kSymmetryTolerance * A.cwiseAbs().maxCoeff()))
    fail(shown(), "a symmetric matrix (within 1e-9)");
  return A;
}

Matrix3 JsonValue::quaternion() const {
  double wxyz[4];
  read_numbers(4, "a list of 4 numbers: w, x, y, z", wxyz);
  Matrix3 R;
  if (!rotation_from_quaternion(wxyz, R)) fail(shown(), "a rotation: a quaternion of length 1 within 0.001");
  return R;
}

}  // namespace snug::identification::internal
