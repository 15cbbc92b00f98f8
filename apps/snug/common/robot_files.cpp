// robot_files: where the URDF is that a recording only names.
#include "apps/snug/common/robot_files.hpp"

#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {

replay::RobotDescription find_robot(const record::RecordingReader& reader, const std::string& recording,
                                    const std::optional<std::string>& urdf) {
  namespace fs = std::filesystem;
  if (urdf) return replay::read_robot(*urdf);
  const std::string name = replay::named_urdf(reader.header());
  if (name.empty()) return {};
  const fs::path shipped = find_shipped((fs::path("scenarios") / name).string());
  for (const fs::path& path : {fs::path(recording).parent_path() / name, fs::path(name), shipped}) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) continue;
    try {
      return replay::read_robot(path);
    } catch (const InputError&) {  // some other file of that name
    }
  }
  std::fprintf(stderr, "snug: the robot is drawn from the shapes that touch: %s is not here; --urdf names it\n",
               name.c_str());
  return {};
}

}  // namespace snug::app
