// Replay: a recording as the one small file that the report page and the live view draw from.
#include "snug/replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/replay/frame_coder.hpp"

namespace snug::replay {
namespace {

constexpr std::size_t kValuesPerFrame = 60;  ///< tool, cup, solver, references of contacts
constexpr std::size_t kValuesPerBody = 8;

void refuse_huge(const record::RecordingHeader& header, std::size_t frames, const std::string& name) {
  const auto moving = static_cast<std::size_t>(
      std::count_if(header.bodies.begin(), header.bodies.end(),
                    [](const record::BodyInfo& body) { return body.kind != record::BodyKind::Static; }));
  const std::size_t values = frames * (kValuesPerFrame + kValuesPerBody * moving);
  if (values <= kMaxValues) return;
  throw InputError(name, "", fmt::format("{} frames of {} moving bodies", frames, moving),
                   fmt::format("at most {} million numbers: take part of it with --from and --to, or every {}th frame "
                               "with --every {}",
                               kMaxValues / 1'000'000, values / kMaxValues + 1, values / kMaxValues + 1));
}

}  // namespace

std::vector<std::size_t> select_frames(const record::RecordingReader& reader, const std::string& name,
                                       const Selection& selection) {
  const std::vector<double>& times = reader.times();
  if (times.empty()) throw InputError(name, "", "a recording without frames", "at least one frame");
  const auto first = std::lower_bound(times.begin(), times.end(), selection.from);
  const auto last = std::upper_bound(times.begin(), times.end(), selection.to);
  std::vector<std::size_t> frames;
  for (auto i = first - times.begin(); i < last - times.begin(); i += static_cast<std::ptrdiff_t>(selection.every)) {
    frames.push_back(static_cast<std::size_t>(i));
  }
  if (frames.empty()) {
    throw InputError(name, "--from, --to", "no frame between these times",
                     fmt::format("times within {:.3f} s to {:.3f} s", times.front(), times.back()));
  }
  return frames;
}

std::string encode_recording(record::RecordingReader& reader, const std::string& name, const Selection& selection) {
  const std::vector<std::size_t> frames = select_frames(reader, name, selection);
  refuse_huge(reader.header(), frames.size(), name);
  FrameCoder coder(reader.header());
  record::Frame frame;
  for (const std::size_t index : frames) {
    reader.read_frame(index, frame);
    coder.add(frame);
  }
  HeaderInput input{name,          &reader.header(),       reader.events(), reader.result(), reader.is_complete(),
                    frames.size(), reader.is_interrupted()};
  return encode_form(make_header_json(input), coder.finish());
}

}  // namespace snug::replay
