// JsonForm of vectors, matrices and poses: lists of numbers, to the last bit.
#pragma once

#include "snug/core/json_archive.hpp"
#include "snug/spatial/pose.hpp"

namespace snug {

/// Column by column; the size is fixed.
template <int kRows, int kCols>
struct JsonForm<Eigen::Matrix<double, kRows, kCols>> {
  using Matrix = Eigen::Matrix<double, kRows, kCols>;
  [[nodiscard]] static JsonValue write(const Matrix& matrix) {
    JsonValue::Array array;
    for (const double value : matrix.reshaped()) array.push_back({value});
    return {std::move(array)};
  }
  [[nodiscard]] static Matrix read(const JsonValue& value, const JsonReader& reader) {
    const auto* array = std::get_if<JsonValue::Array>(&value.value);
    if (array == nullptr || array->size() != static_cast<std::size_t>(kRows * kCols)) {
      reader.fail("a list of " + std::to_string(kRows * kCols) + " numbers");
    }
    Matrix matrix;
    for (Eigen::Index i = 0; i < matrix.size(); ++i) {
      const auto slot = static_cast<std::size_t>(i);
      matrix.reshaped()[i] = reader.at((*array)[slot], "[" + std::to_string(i) + "]").template as<double>();
    }
    return matrix;
  }
};

/// Twelve numbers: position [m], then the rotation matrix, column by column.
template <>
struct JsonForm<Pose> {
  using Numbers = Eigen::Matrix<double, 12, 1>;
  [[nodiscard]] static JsonValue write(const Pose& X) {
    Numbers numbers;
    numbers << X.p, X.R.reshaped();
    return write_json(numbers);
  }
  [[nodiscard]] static Pose read(const JsonValue& value, const JsonReader& reader) {
    const Numbers numbers = JsonForm<Numbers>::read(value, reader);
    return {numbers.tail<9>().reshaped(3, 3), numbers.head<3>()};
  }
};

}  // namespace snug
