// BoundedVector: a run of values with a capacity fixed at construction, so that a step never allocates.
#pragma once

#include <cstddef>
#include <memory>

#include "snug/core/check.hpp"

namespace snug {

/// Like std::vector, but the capacity is set once and survives copying; going beyond it is a bug.
template <class T>
class BoundedVector {
 public:
  BoundedVector() = default;
  explicit BoundedVector(std::size_t capacity) : items_(new T[capacity]()), capacity_(capacity) {}
  BoundedVector(const BoundedVector& other) : BoundedVector(other.capacity_) { assign(other); }
  BoundedVector(BoundedVector&&) noexcept = default;
  BoundedVector& operator=(BoundedVector&&) noexcept = default;
  BoundedVector& operator=(const BoundedVector& other) {
    if (this == &other) return *this;
    if (capacity_ != other.capacity_) {
      items_.reset(new T[other.capacity_]());
      capacity_ = other.capacity_;
    }
    assign(other);
    return *this;
  }
  ~BoundedVector() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == capacity_; }

  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T* begin() { return items_.get(); }
  T* end() { return items_.get() + size_; }
  const T* begin() const { return items_.get(); }
  const T* end() const { return items_.get() + size_; }
  T& back() { return items_[size_ - 1]; }

  void clear() { size_ = 0; }
  void resize(std::size_t size) {
    SNUG_CHECK(size <= capacity_, "bounded vector too small");
    size_ = size;
  }
  T& push_back(const T& value) {
    SNUG_CHECK(size_ < capacity_, "bounded vector too small");
    items_[size_] = value;
    return items_[size_++];
  }

  bool operator==(const BoundedVector& other) const {
    if (size_ != other.size_) return false;
    for (std::size_t i = 0; i < size_; ++i) {
      if (!(items_[i] == other.items_[i])) return false;
    }
    return true;
  }

 private:
  void assign(const BoundedVector& other) {
    size_ = other.size_;
    for (std::size_t i = 0; i < size_; ++i) items_[i] = other.items_[i];
  }

  std::unique_ptr<T[]> items_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace snug
