// recordings: what verbs that show a recording have in common.
#include "apps/snug/common/recordings.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {

void add_selection(const Verb& verb, replay::Selection& selection) {
  verb.option("--from", selection.from, "SECONDS", "leave out everything before this time", finite());
  verb.option("--to", selection.to, "SECONDS", "leave out everything after this time", finite());
  verb.option("--every", selection.every, "N",
              "use only every Nth frame (default: all; in a page as many as it can hold)", whole(1, kMostThings));
}

void add_urdf(const Verb& verb, std::optional<std::string>& urdf) {
  verb.option("--urdf", urdf, "FILE.urdf", "looks of the robot (default: the file that the scenario names)");
}

void expect_one_or_two(const std::vector<std::string>& recordings) {
  if (recordings.size() <= 2) return;
  throw InputError("command line", "recordings", std::to_string(recordings.size()) + " of them",
                   "one, or two to overlay");
}

void expect_recorded(const record::RecordingReader& reader, const std::string& path,
                     const std::optional<double>& time) {
  if (reader.times().empty()) throw InputError(path, "", "a recording without frames", "at least one frame");
  const double first = reader.times().front(), last = reader.times().back();
  constexpr double kRounding = 1e-6;  // s, of times as people write them
  if (!time || (*time >= first - kRounding && *time <= last + kRounding)) return;
  throw InputError("command line", "--time", fmt::format("{}", *time),
                   fmt::format("an instant of {}: {:.3f} s to {:.3f} s", path, first, last));
}

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
  std::fprintf(stderr, "snug: the robot is drawn from its collision shapes: %s is missing; --urdf names it\n",
               name.c_str());
  return {};
}

report::PageRecording encode_recording(record::RecordingReader& reader, const std::string& path,
                                       const replay::Selection& selection, const std::optional<std::string>& urdf) {
  const std::string name = file_name(path);
  return {name, replay::encode_recording(reader, name, selection, find_robot(reader, path, urdf))};
}

std::vector<report::PageRecording> encode_recordings(const std::vector<std::string>& paths,
                                                     const replay::Selection& selection,
                                                     const std::optional<std::string>& urdf) {
  std::vector<report::PageRecording> recordings;
  for (const std::string& path : paths) {
    record::RecordingReader reader(path);
    recordings.push_back(encode_recording(reader, path, selection, urdf));
  }
  return recordings;
}

}  // namespace snug::app
