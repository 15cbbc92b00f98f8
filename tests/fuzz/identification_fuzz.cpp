// Measurements that parameters are identified from: static poses and releases (JSON, CSV), motions and lifts (CSV), by
// the first byte.
#include "fuzz.hpp"
#include "snug/identification/payload_file.hpp"
#include "snug/identification/recorded_motion.hpp"
#include "snug/identification/releases.hpp"
#include "snug/identification/static_poses.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  static const model::SceneTask task =
      model::load_scene_task(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/tosses/task.yaml");
  fuzz::expect_answer(data, size, [](char kind, const std::string& text) {
    switch (kind) {
      case 'p':
        (void)identification::parse_static_poses_json(text, "x.json");
        break;
      case 'P':
        (void)identification::parse_static_poses_csv(text, "x.csv");
        break;
      case 'r':
        (void)identification::parse_releases_json(text, "x.json");
        break;
      case 'R':
        (void)identification::parse_releases_csv(text, "x.csv");
        break;
      case 'w':
        (void)identification::parse_lift(text, "x.csv");
        break;
      default:
        (void)identification::parse_motions(task, text, "x.csv");
    }
  });
  return 0;
}
