// recordings: what verbs that show a recording have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"
#include "snug/record/reader.hpp"
#include "snug/replay/replay.hpp"
#include "snug/replay/robot_description.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {

/// --from, --to and --every.
void add_selection(const Verb& verb, replay::Selection& selection);
/// --urdf of the robot in a recording.
void add_urdf(const Verb& verb, std::optional<std::string>& urdf);

/// Throws InputError for more recordings than one and another that is laid over it.
void expect_one_or_two(const std::vector<std::string>& recordings);
/// Throws InputError for a recording without frames and for an instant that was not recorded: what is drawn of it would
/// show another. `path`: of the recording; `time`: s.
void expect_recorded(const record::RecordingReader& reader, const std::string& path, const std::optional<double>& time);

/// How the robot of a recording looks: `urdf` if it was given, else the file that its scenario names, looked for beside
/// the recording, in this folder and among the shipped scenarios. Nothing, said on stderr, where there is none: links
/// are then drawn from the shapes that touch. Throws InputError for a file that was given and cannot be read.
[[nodiscard]] replay::RobotDescription find_robot(const record::RecordingReader& reader, const std::string& recording,
                                                  const std::optional<std::string>& urdf);

/// Recordings as the viewer reads them, with the robots in them.
[[nodiscard]] report::PageRecording encode_recording(record::RecordingReader& reader, const std::string& path,
                                                     const replay::Selection& selection,
                                                     const std::optional<std::string>& urdf);
[[nodiscard]] std::vector<report::PageRecording> encode_recordings(const std::vector<std::string>& paths,
                                                                   const replay::Selection& selection,
                                                                   const std::optional<std::string>& urdf);

}  // namespace snug::app
