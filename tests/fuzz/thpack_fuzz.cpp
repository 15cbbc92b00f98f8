// Container loading instances (thpack text).
#include "fuzz.hpp"
#include "snug/packing/instances.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  snug::fuzz::expect_answer([&] { (void)snug::packing::parse_instances(snug::fuzz::text_of(data, size), "x.txt"); });
  return 0;
}
