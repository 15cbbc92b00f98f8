// Arms (URDF), without meshes.
#include "fuzz.hpp"
#include "snug/robot/arm.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  fuzz::expect_answer([&] {
    const robot::ArmModel arm =
        robot::parse_urdf(std::string(fuzz::text_of(data, size)), "x.urdf", "tool0", "/nonexistent");
    for (const robot::Link& link : arm.links) SNUG_CHECK(is_utf8(link.name), "names in UTF-8");
  });
  return 0;
}
