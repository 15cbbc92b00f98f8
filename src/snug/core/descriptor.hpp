// Descriptor: an open file of the system that is closed with the object.
#pragma once

#include <unistd.h>

#include <utility>

namespace snug {

class Descriptor {
 public:
  Descriptor() = default;
  /// Takes what open() gave, also a negative number.
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  [[nodiscard]] int get() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

}  // namespace snug
