// Measurements as other programs left them, made into a recording of an archive.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "snug/record/archive.hpp"

namespace snug::archive_import {

enum class UpAxis { Y, Z };

/// What a file does not say, or not as an archive needs it. Empty: as the file has it.
struct Hints {
  UpAxis up = UpAxis::Y;         ///< of motion capture by Motive, whose files do not say it
  std::string length_unit = {};  ///< of the same, where the header has none: m, cm, mm, in or ft
  std::string rotation = {};     ///< of the same, where the header has none: order of its angles, such as XYZ
  double rate = 0.0;             ///< of RTDE without a column `timestamp`: rows a second [Hz]; 0: not said
  std::map<std::string, std::string> names = {};  ///< bodies: as the file calls them -> as the archive does
  std::string tool = {};                          ///< of a bag: topic of poses, or frame of /tf, that is the tool E
  std::string wrench = {};    ///< of a bag: topic; of a log of mc_rtc: sensor; of RTDE: columns (ft_raw_wrench)
  bool turns_wrench = false;  ///< its forces are those of the robot on the load: all signs turn
  std::vector<std::string> joints = {};  ///< of a bag: names from base to tool
  std::string fixed_frame = {};          ///< of a bag: the frame of /tf that poses are wanted in
};

/// Of "OLD=NEW". InputError for another form; `key` names where they stand.
[[nodiscard]] std::map<std::string, std::string> parse_names(const std::vector<std::string>& words,
                                                             const std::string& key);

struct Imported {
  record::ArchiveRecording recording;  ///< named after the file
  std::vector<std::string> remarks;    ///< a line for each thing that was left out or taken in one of several ways
};

/// Is it a file, or a folder, that load() reads, by the ending of its name? Others are archives.
[[nodiscard]] bool is_import(const std::filesystem::path& path);

/// Reads, by what the file begins with and its ending:
/// - CSV of Motive: rigid bodies in any of its units and rotations. Its axes become z up by a quarter turn about x, of
///   the bodies' own axes, too, so that a body that lies as when it was defined has no rotation. Bodies that are lost
///   have empty cells.
/// - CSV of RTDE (a column `timestamp`, or one named actual_... or target_... and `Hints::rate`; separated by blanks,
///   commas, semicolons or tabs): all columns of numbers, each once; the tool by `actual_TCP_pose`.
/// - logs of mc_rtc as CSV or flat binary (.flat): as validation::load_log; joints as well of a flat one.
/// - MCAP and bags of ROS 1 and 2 (.mcap, .db3, .bag, a folder with metadata.yaml): JointState, WrenchStamped,
///   PoseStamped, PoseWithCovarianceStamped, TransformStamped, TFMessage, in CDR, ROS 1 or JSON, through Python.
/// Clocks begin within their first second: a controller's counts from when it was switched on, others from 1970. The
/// remark `begins` has the whole seconds that were taken off, the same for all sources of a file.
/// Throws InputError (file:line, column) for what cannot be read as one of these.
[[nodiscard]] Imported load(const std::filesystem::path& path, const Hints& hints);

/// Several files as one recording: each brings sources that no other has. Throws InputError where two bring the same.
[[nodiscard]] Imported load_all(const std::vector<std::filesystem::path>& paths, const Hints& hints);

}  // namespace snug::archive_import
