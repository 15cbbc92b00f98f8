// Replay: a recording as the one small file that the report page draws from.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "snug/record/reader.hpp"
#include "snug/replay/form.hpp"
#include "snug/replay/robot_description.hpp"

namespace snug::replay {

/// Which frames to take.
struct Selection {
  double from = -std::numeric_limits<double>::infinity();  ///< s
  double to = std::numeric_limits<double>::infinity();     ///< s
  std::size_t every = 0;                                   ///< 2 takes every other frame; 0: all that a page can hold
  bool operator==(const Selection&) const = default;
};

/// A page is refused more numbers than this: browsers keep all of them in memory. Fewer for small files (replay.cpp).
inline constexpr std::size_t kMaxValues = 50'000'000;

/// Everything that a header tells about a run, from what the recording holds. What cannot be read any more (a scenario
/// of an earlier version, say) is null there.
struct HeaderInput {
  std::string name;  ///< file name
  const record::RecordingHeader* header = nullptr;
  std::vector<record::Event> events;
  std::string result_json;  ///< or empty
  bool is_complete = false;
  std::size_t frames = 0;
  bool is_interrupted = false;
  RobotDescription robot = {};
};
[[nodiscard]] std::string make_header_json(const HeaderInput& input);

/// The frames of `selection` of a recording called `name`, in the replay form of docs/formats.md. Throws InputError for
/// a recording without such frames, and for one of more than kMaxValues numbers, saying what to do.
[[nodiscard]] std::string encode_recording(record::RecordingReader& reader, const std::string& name,
                                           const Selection& selection = {}, const RobotDescription& robot = {});

/// The indices of the frames selected, growing. Throws InputError naming `name` when there are none.
[[nodiscard]] std::vector<std::size_t> select_frames(const record::RecordingReader& reader, const std::string& name,
                                                     const Selection& selection);

}  // namespace snug::replay
