// What each file of this folder defines, and what every answer of a reader must be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

/// One input for the reader. Anything but a result or an InputError is a finding: another exception, a failed check, a
/// crash, a complaint of a sanitizer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace snug::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs `read`; a refusal must be a message that can be shown.
template <class Read>
void expect_answer(Read read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string message = error.what();
    SNUG_CHECK(!message.empty() && is_utf8(message), "a message in UTF-8");
    SNUG_CHECK(printable(message, kLongestMessage) == message,
               "a message without control characters, of bounded length");
    SNUG_CHECK(!error.where.empty() && !(error.got.empty() && error.expected.empty() && error.key.empty()),
               "a message that says where and what");
  }
}

/// The same of `read(kind, text)`: the first byte of the input says what the others are.
template <class Read>
void expect_answer(const std::uint8_t* data, std::size_t size, Read read) {
  if (size == 0) return;
  const auto kind = static_cast<char>(data[0]);
  const std::string text(text_of(data + 1, size - 1));
  expect_answer([&] { read(kind, text); });
}

}  // namespace snug::fuzz
