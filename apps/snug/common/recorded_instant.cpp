// The instant of a recording that --time names.
#include "apps/snug/common/recorded_instant.hpp"

#include <fmt/format.h>

#include "snug/core/input_error.hpp"

namespace snug::app {

void expect_recorded(const record::RecordingReader& reader, const std::string& path,
                     const std::optional<double>& time) {
  if (reader.times().empty()) throw InputError(path, "", "a recording without frames", "at least one frame");
  const double first = reader.times().front(), last = reader.times().back();
  constexpr double kRounding = 1e-6;  // s, of times as people write them
  if (!time || (*time >= first - kRounding && *time <= last + kRounding)) return;
  throw InputError("command line", "--time", fmt::format("{}", *time),
                   fmt::format("an instant of {}: {:.3f} s to {:.3f} s", path, first, last));
}

}  // namespace snug::app
