// ByteWriter, ByteReader: numbers as a UR controller puts them on the wire, big-endian.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace snug::ur {

class ByteWriter {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  void i8(std::int8_t value) { u8(static_cast<std::uint8_t>(value)); }
  void boolean(bool value) { u8(value ? 1 : 0); }
  void u16(std::uint16_t value) { big_endian(value, 2); }
  void u32(std::uint32_t value) { big_endian(value, 4); }
  void u64(std::uint64_t value) { big_endian(value, 8); }
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void f32(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void text(std::string_view text) { bytes_ += text; }
  /// Its length as a byte first; what is beyond 255 bytes is cut off.
  void short_text(std::string_view text) {
    text = text.substr(0, 255);
    u8(static_cast<std::uint8_t>(text.size()));
    bytes_ += text;
  }
  template <std::size_t N>
  void f64s(const std::array<double, N>& values) {
    for (const double value : values) f64(value);
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  void big_endian(std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) bytes_.push_back(static_cast<char>((value >> (8 * i)) & 0xffU));
  }
  std::string bytes_;
};

/// Reads what is there; reading beyond the end gives zeros, and is_good() is false from then on.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(big_endian(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(big_endian(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(big_endian(4)); }
  std::uint64_t u64() { return big_endian(8); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  [[nodiscard]] std::string_view rest() const { return bytes_; }
  [[nodiscard]] bool is_good() const { return is_good_; }

 private:
  std::uint64_t big_endian(std::size_t bytes) {
    if (bytes_.size() < bytes) {
      is_good_ = false;
      bytes_ = {};
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = (value << 8U) | static_cast<std::uint8_t>(bytes_[i]);
    bytes_.remove_prefix(bytes);
    return value;
  }
  std::string_view bytes_;
  bool is_good_ = true;
};

}  // namespace snug::ur
