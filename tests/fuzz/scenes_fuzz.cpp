// Scenes of other simulators (MJCF, SDF), without files beside them.
#include "fuzz.hpp"
#include "snug/scene_import/import_scene.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  fuzz::expect_answer([&] {
    const scene_import::Imported scene =
        scene_import::parse_scene(std::string(fuzz::text_of(data, size)), "x.xml", "/nonexistent");
    SNUG_CHECK(is_utf8(scene.yaml) && is_utf8(scene.refusal), "a scenario in UTF-8");
    for (const scene_import::Remark& remark : scene.remarks)
      SNUG_CHECK(printable(to_text(remark), 2000) == to_text(remark), "remarks that can be shown");
  });
  return 0;
}
