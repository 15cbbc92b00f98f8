// BoundedVector: a run of values with a capacity fixed at construction, so that a step never allocates.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

#include "snug/core/check.hpp"

namespace snug {

/// Like std::vector, but the capacity is set once and survives copying; going beyond it is a bug. Memory is reserved at
/// once and becomes real only as far as it is used: values are made when first reached, and keep what they hold when
/// the size shrinks and grows again.
template <class T>
class BoundedVector {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  BoundedVector() = default;
  explicit BoundedVector(std::size_t capacity) : items_(reserve(capacity)), capacity_(capacity) {}
  BoundedVector(const BoundedVector& other) : BoundedVector(other.capacity_) { assign(other); }
  BoundedVector(BoundedVector&&) noexcept = default;
  BoundedVector& operator=(BoundedVector&&) noexcept = default;
  BoundedVector& operator=(const BoundedVector& other) {
    if (this == &other) return *this;
    if (capacity_ != other.capacity_) {
      items_.reset(reserve(other.capacity_));
      capacity_ = other.capacity_;
      made_ = 0;
    }
    assign(other);
    return *this;
  }
  ~BoundedVector() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == capacity_; }

  T& operator[](std::size_t i) { return items_.get()[i]; }
  const T& operator[](std::size_t i) const { return items_.get()[i]; }
  T* begin() { return items_.get(); }
  T* end() { return items_.get() + size_; }
  const T* begin() const { return items_.get(); }
  const T* end() const { return items_.get() + size_; }
  T& back() { return items_.get()[size_ - 1]; }

  void clear() { size_ = 0; }
  void resize(std::size_t size) {
    SNUG_CHECK(size <= capacity_, "bounded vector too small");
    make(size);
    size_ = size;
  }
  /// `count` values behind the end, to be written to before resize() takes them in.
  T* room(std::size_t count) {
    SNUG_CHECK(count <= capacity_ - size_, "bounded vector too small");
    make(size_ + count);
    return end();
  }
  T& push_back(const T& value) {
    SNUG_CHECK(size_ < capacity_, "bounded vector too small");
    make(size_ + 1);
    items_.get()[size_] = value;
    return items_.get()[size_++];
  }

  bool operator==(const BoundedVector& other) const {
    if (size_ != other.size_) return false;
    for (std::size_t i = 0; i < size_; ++i) {
      if (!(items_.get()[i] == other.items_.get()[i])) return false;
    }
    return true;
  }

 private:
  struct Free {
    void operator()(T* items) const { ::operator delete(items, kAlignment); }
  };
  static constexpr std::align_val_t kAlignment{std::max<std::size_t>(alignof(T), 64)};

  static T* reserve(std::size_t capacity) {
    return static_cast<T*>(::operator new(std::max<std::size_t>(1, capacity) * sizeof(T), kAlignment));
  }
  void make(std::size_t count) {
    for (; made_ < count; ++made_) ::new (static_cast<void*>(items_.get() + made_)) T();
  }
  void assign(const BoundedVector& other) {
    make(other.size_);
    size_ = other.size_;
    for (std::size_t i = 0; i < size_; ++i) items_.get()[i] = other.items_.get()[i];
  }

  std::unique_ptr<T, Free> items_;
  std::size_t size_ = 0, capacity_ = 0;
  std::size_t made_ = 0;  ///< values that are there, counted or not
};

}  // namespace snug
