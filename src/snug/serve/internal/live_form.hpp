// LiveForm: frames and events of a run that goes on, as watchers are told of them: server-sent events.
#pragma once

#include <string>
#include <vector>

#include "snug/record/recording.hpp"
#include "snug/replay/frame_coder.hpp"

namespace snug::serve::internal {

/// "event: NAME", "data: DATA", an empty line.
[[nodiscard]] std::string server_event(const char* name, const std::string& data);
/// Data of the event `header`: the replay form of a run called `name` without frames, in base64.
[[nodiscard]] std::string header_data(const std::string& name, const record::RecordingHeader& header,
                                      const record::Frame& first);
/// Data of the event `frames`: what was coded, and events, in base64. The coder is empty then.
[[nodiscard]] std::string frames_data(replay::FrameCoder& coder, const std::vector<record::Event>& events);

}  // namespace snug::serve::internal
