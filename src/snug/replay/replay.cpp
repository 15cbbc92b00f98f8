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
constexpr std::size_t kValuesPerContact = 11;

/// Numbers that the form of this recording may have. Each takes a byte or two, more while it is packed. Those of bodies
/// at rest take a seventh of a byte in a file: what claims much more than that was not recorded.
std::size_t most_values(const record::RecordingReader& reader) {
  constexpr std::size_t kFree = 15'000'000;
  constexpr std::size_t kPerByte = 8;
  return std::min(kMaxValues, kFree + kPerByte * reader.file_bytes());
}

[[noreturn]] void refuse_values(const std::string& name, const std::string& got, std::size_t values, std::size_t most) {
  throw InputError(name, "", got,
                   fmt::format("at most {} million numbers: take part of it with --from and --to, or every {}th frame "
                               "with --every {}",
                               most / 1'000'000, values / most + 1, values / most + 1));
}

void refuse_huge(const record::RecordingReader& reader, std::size_t frames, const std::string& name) {
  const std::vector<record::BodyInfo>& bodies = reader.header().bodies;
  const auto moving =
      static_cast<std::size_t>(std::count_if(bodies.begin(), bodies.end(), [](const record::BodyInfo& body) {
        return body.kind != record::BodyKind::Static;
      }));
  const std::size_t values = frames * (kValuesPerFrame + kValuesPerBody * moving);
  const std::size_t most = most_values(reader);
  if (values > most) refuse_values(name, fmt::format("{} frames of {} moving bodies", frames, moving), values, most);
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

std::string encode_recording(record::RecordingReader& reader, const std::string& name, const Selection& selection,
                             const RobotDescription& robot) {
  const std::vector<std::size_t> frames = select_frames(reader, name, selection);
  refuse_huge(reader, frames.size(), name);
  FrameCoder coder(reader.header());
  record::Frame frame;
  const std::size_t most = most_values(reader);
  for (const std::size_t index : frames) {
    reader.read_frame(index, frame);
    coder.add(frame);
    if (const std::size_t values = kValuesPerContact * coder.contact_points(); values > most) {
      refuse_values(name, fmt::format("{} contacts that differ", coder.contact_points()), values, most);
    }
  }
  HeaderInput input{name,
                    &reader.header(),
                    reader.events(),
                    reader.result(),
                    reader.is_complete(),
                    frames.size(),
                    reader.is_interrupted(),
                    robot};
  return encode_form(make_header_json(input), coder.finish());
}

}  // namespace snug::replay
