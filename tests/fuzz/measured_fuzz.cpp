// Files of measurements that are read from disk: frames of cameras (PNG, PLY, HDF5), archives (HDF5) and logs of
// controllers (CSV), by the first byte.
#include "fuzz.hpp"
#include "scratch_file.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/log_table.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  static const fuzz::ScratchFile file(".csv");
  fuzz::expect_answer(data, size, [](char kind, const std::string& bytes) {
    file.write(bytes);
    switch (kind) {
      case 'a':
        (void)record::load_archive(file.path());
        break;
      case 'l':
        (void)validation::load_log(file.path());
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
