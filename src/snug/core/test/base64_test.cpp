// base64: the examples of RFC 4648, section 10.
#include "snug/core/base64.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace snug {
namespace {

TEST(Base64, IsAsRfc4648Has) {
  const std::pair<std::string, std::string> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : examples) EXPECT_EQ(base64(plain), coded);
}

}  // namespace
}  // namespace snug
