// What a reader says of bad input.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "snug/core/input_error.hpp"

namespace snug::archive_import::test {

/// Runs `read`, which must throw an InputError whose message has `part`.
template <class Read>
void expect_refusal(Read read, const std::string& part) {
  try {
    (void)read();
    ADD_FAILURE() << "was read, without: " << part;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace snug::archive_import::test
