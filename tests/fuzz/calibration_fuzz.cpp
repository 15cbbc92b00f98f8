// Measurements (CSV), a controller's deviations and a driver's calibration (YAML), by the first byte.
#include "fuzz.hpp"
#include "snug/calibration/dh.hpp"
#include "snug/calibration/exact_arm.hpp"
#include "snug/core/table.hpp"
#include "snug/robot/arm.hpp"

namespace {

const snug::robot::ArmModel& nominal() {
  static const snug::robot::ArmModel arm =
      snug::robot::load_urdf(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/robots/ur10.urdf", "tool0");
  return arm;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  fuzz::expect_answer(data, size, [](char kind, const std::string& text) {
    switch (kind) {
      case 't':
        (void)parse_table(text, "x.csv", {"x", "y", "z", "rx", "ry", "rz"});
        break;
      case 'd':
        (void)calibration::parse_deltas(text, "x.conf");
        break;
      default: {
        const auto reading = kind == 'u' ? calibration::AngleReading::Urdf : calibration::AngleReading::EulerXyz;
        const robot::ArmModel arm = calibration::parse_calibration_yaml(text, "x.yaml", reading, nominal());
        (void)calibration::format_calibration_yaml(arm, reading);
      }
    }
  });
  return 0;
}
