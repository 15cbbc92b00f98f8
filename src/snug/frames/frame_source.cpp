// FrameSource: frames that a command leaves at each look, or that appear in a folder.
#include "snug/frames/frame_source.hpp"

#include <algorithm>
#include <array>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/frames/internal/source_parts.hpp"

namespace snug::frames {

camera::FrameSource make_frame_source(const SourceSettings& settings) {
  std::error_code error;
  return std::filesystem::is_directory(settings.from, error) ? internal::make_folder_source(settings)
                                                             : internal::make_command_source(settings);
}

namespace internal {

Expected<camera::Frame, std::string> read_frame(const std::filesystem::path& path, const camera::FrameHints& hints) {
  try {
    return camera::load_frame(path, hints);
  } catch (const InputError& error) {
    return Unexpected<std::string>(printable(error.what(), 4 * kLongestMessage));
  }
}

bool is_frame_ending(const std::string& ending) {
  constexpr std::array kEndings = {".png", ".ply", ".pcd", ".h5"};
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

}  // namespace internal
}  // namespace snug::frames
