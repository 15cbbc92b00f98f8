// Grid2: a picture: one value for each pixel, row by row.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace snug::camera {

template <class T>
class Grid2 {
 public:
  Grid2() = default;
  Grid2(int rows, int cols, T value = T{})
      : rows_(rows), cols_(cols), values_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), value) {}

  /// Of so many values as there are pixels.
  Grid2(int rows, int cols, std::vector<T> values) : rows_(rows), cols_(cols), values_(std::move(values)) {}

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  [[nodiscard]] bool is_inside(int row, int col) const { return row >= 0 && row < rows_ && col >= 0 && col < cols_; }

  [[nodiscard]] T& operator()(int row, int col) { return values_[index(row, col)]; }
  [[nodiscard]] const T& operator()(int row, int col) const { return values_[index(row, col)]; }
  /// First pixel of a row.
  [[nodiscard]] T* row(int r) { return values_.data() + index(r, 0); }
  [[nodiscard]] const T* row(int r) const { return values_.data() + index(r, 0); }
  [[nodiscard]] std::span<T> values() { return values_; }
  [[nodiscard]] std::span<const T> values() const { return values_; }
  bool operator==(const Grid2&) const = default;

 private:
  [[nodiscard]] std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
  }
  int rows_ = 0;
  int cols_ = 0;
  std::vector<T> values_;
};

}  // namespace snug::camera
