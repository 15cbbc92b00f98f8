// Files of measurements that are read from disk: frames of cameras (PNG, PLY, PCD, HDF5) and what is said beside them,
// archives (HDF5) and logs of controllers and windows of comparison (CSV), by the first byte.
#include "fuzz.hpp"
#include "scratch_file.hpp"
#include "snug/camera/camera_file.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/log_table.hpp"
#include "snug/validation/validate.hpp"

namespace {

snug::validation::SimulatedRun run_of_two_boxes() {
  snug::validation::SimulatedRun run;
  run.header.sequence = "1";
  for (const char* name : {"BOX001", "BOX002"}) run.header.bodies.emplace_back().name = name;
  return run;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  static const fuzz::ScratchFile file(".csv");
  fuzz::expect_answer(data, size, [](char kind, const std::string& bytes) {
    file.write(bytes);
    switch (kind) {
      case 'a':
        (void)record::load_archive(file.path());
        break;
      case 'w': {
        static const validation::SimulatedRun run = run_of_two_boxes();
        (void)validation::load_windows(file.path(), run);
        break;
      }
      case 'l':
        (void)validation::load_log(file.path());
        break;
      case 'b':
        (void)camera::parse_camera_file(bytes, "x.yaml");
        break;
      default: {
        camera::FrameHints hints;
        hints.camera_is_given = kind == 'c';
        (void)camera::load_frame(file.path(), hints);
      }
    }
  });
  return 0;
}
