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

/// Bytes of what a page makes of the channels: decode.ts counts them alike and refuses more than kMostDecoded.
std::size_t decoded_bytes(const std::vector<ChannelWriter>& channels) {
  std::size_t bytes = 0;
  for (const ChannelWriter& channel : channels) {
    const ChannelSpec& spec = channel.spec();
    const bool is_exact = spec.name == "time" || (spec.quantum == 1.0 && spec.name.starts_with("contacts."));
    bytes += channel.rows() * spec.columns.size() * (is_exact ? 8 : 4);
  }
  return bytes;
}

constexpr std::size_t kMostDecoded = 180'000'000;

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
  const auto every = static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, selection.every));
  for (auto i = first - times.begin(); i < last - times.begin(); i += every) {
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
  const std::vector<ChannelWriter> channels = coder.finish();
  if (const std::size_t bytes = decoded_bytes(channels); bytes > kMostDecoded && selection.every == 0) {
    Selection fewer = selection;
    fewer.every = (bytes + kMostDecoded - 1) / kMostDecoded;
    return encode_recording(reader, name, fewer, robot);
  }
  HeaderInput input{name,
                    &reader.header(),
                    reader.events(),
                    reader.result(),
                    reader.is_complete(),
                    frames.size(),
                    reader.is_interrupted(),
                    robot};
  return encode_form(make_header_json(input), channels);
}

}  // namespace snug::replay
