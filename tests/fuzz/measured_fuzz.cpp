// Files of measurements that are read from disk: frames of cameras (PNG, PLY, HDF5), archives (HDF5) and logs of
// controllers (CSV), by the first byte.
#include "fuzz.hpp"
#include "scratch_file.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/log_table.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  if (size == 0) return 0;
  static const fuzz::ScratchFile file(".csv");
  file.write(fuzz::text_of(data + 1, size - 1));
  fuzz::expect_answer([&] {
    switch (data[0]) {
      case 'a':
        (void)record::load_archive(file.path());
        break;
      case 'l':
        (void)validation::load_log(file.path());
        break;
      default: {
        camera::FrameHints hints;
        hints.camera_is_given = data[0] == 'c';
        (void)camera::load_frame(file.path(), hints);
      }
    }
  });
  return 0;
}
