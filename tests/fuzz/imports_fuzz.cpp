// Measurements of other programs: tables of motion capture, of RTDE and of mc_rtc, and flat logs, by the first byte.
#include "fuzz.hpp"
#include "scratch_file.hpp"
#include "snug/archive_import/measurements.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  static const fuzz::ScratchFile table(".csv"), flat(".flat");
  fuzz::expect_answer(data, size, [](char kind, const std::string& bytes) {
    const fuzz::ScratchFile& file = kind == 'f' ? flat : table;
    file.write(bytes);
    archive_import::Hints hints;
    if (kind == 'w') hints.wrench = "ft_raw_wrench";
    if (kind == 'z') hints.up = archive_import::UpAxis::Z;
    if (kind == 'r') {
      hints.rate = 125.0;
      hints.length_unit = "cm";
      hints.rotation = "XYZ";
    }
    const archive_import::Imported imported = archive_import::load(file.path(), hints);
    for (const std::string& remark : imported.remarks) SNUG_CHECK(is_utf8(remark), "remarks in UTF-8");
  });
  return 0;
}
