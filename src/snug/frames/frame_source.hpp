// FrameSource: frames that a command leaves at each look, or that appear in a folder.
#pragma once

#include <functional>
#include <string>

#include "snug/camera/frame_file.hpp"
#include "snug/camera/frame_source.hpp"

namespace snug::frames {

struct SourceSettings {
  std::string from;        ///< a folder that is there, else a command
  double patience = 30.0;  ///< s, until the frame of a look has to be there
  double grace = 1.0;      ///< s, between SIGTERM and SIGKILL for a command that does not end
  camera::FrameHints hints;
  std::function<bool()> is_interrupted = {};  ///< asked a hundred times a second: true ends the look, and a command
};

/// A command is split into words as a shell would, and nothing else of a shell is done: no variables, patterns or
/// pipes. In each word {frame} is the path of the frame to be written without its ending, {look} the number of the
/// look, {time} the plant's time in s; they are in the environment as well: SNUG_FRAME, SNUG_LOOK, SNUG_TIME. It has to
/// end with exit code 0 and to have left one of {frame}.png, .ply, .pcd and .h5, in a folder of its own that is removed
/// after the look. It runs in a process group of its own, with nothing on stdin; when its time is over or the user
/// interrupts, the group gets SIGTERM, after `grace` SIGKILL.
///
/// A folder: look.json is replaced in it, with the number of the look, and the first frame that is new there afterwards
/// is taken: one of another name, or of the same in another file. It has to be put there whole (written beside, then
/// renamed). Files whose names begin with a dot, and pictures that `snug camera` writes beside a frame, are none.
///
/// Throws InputError where `from` is neither a folder nor a command whose program can be run, has an open quote or asks
/// for a shell, and for a folder that cannot be written or is watched by another program of ours.
[[nodiscard]] camera::FrameSource make_frame_source(const SourceSettings& settings);

}  // namespace snug::frames
