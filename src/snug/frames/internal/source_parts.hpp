// The two kinds of sources.
#pragma once

#include "snug/frames/frame_source.hpp"

namespace snug::frames::internal {

/// Throws as make_frame_source.
[[nodiscard]] camera::FrameSource make_command_source(const SourceSettings& settings);
[[nodiscard]] camera::FrameSource make_folder_source(const SourceSettings& settings);

/// The frame there, or why it cannot be used.
[[nodiscard]] Expected<camera::Frame, std::string> read_frame(const std::filesystem::path& path,
                                                              const camera::FrameHints& hints);
/// Endings of the names of frames.
[[nodiscard]] bool is_frame_ending(const std::string& ending);

}  // namespace snug::frames::internal
