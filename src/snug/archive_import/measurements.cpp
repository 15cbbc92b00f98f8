// load: tells what kind of file it is, and joins several to one recording.
#include "snug/archive_import/measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/validation/log_table.hpp"

namespace snug::archive_import {
namespace {

namespace fs = std::filesystem;
using record::ArchiveRecording;

constexpr const char* kExpected =
    "CSV of Motive, RTDE or mc_rtc, a flat log of mc_rtc (.flat), MCAP or a bag of ROS (.mcap, .db3, .bag, a folder)";

std::string ending_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_bag(const fs::path& path) {
  const std::string ending = ending_of(path);
  return ending == ".mcap" || ending == ".db3" || ending == ".bag" || is_folder(path);
}

/// Motive and others write UTF-16 on request; the two bytes before it say so.
void refuse_utf16(std::string_view text, const std::string& name) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw InputError(name, "", "text in UTF-16", "UTF-8: save the table as 'CSV UTF-8'");
}

/// A table that begins like none of those that are read: what its first line has, and how theirs begin.
[[noreturn]] void refuse_unknown(std::string_view header, const std::string& name) {
  constexpr std::size_t kMostWords = 4, kLongestWord = 100;
  std::string words;
  bool has_names = false;
  std::size_t count = 0;
  while (!header.empty() && count < kMostWords) {
    const std::size_t end = std::min(header.find_first_of(",;\t"), header.size());
    const std::string word(trim(header.substr(0, std::min(end, kLongestWord))));
    header.remove_prefix(std::min(end + 1, header.size()));
    if (word.empty()) continue;
    has_names = has_names || word.find_first_not_of("0123456789+-.eE") != std::string::npos;
    words += (count++ == 0 ? "'" : ", '") + printable(word, 20) + "'";
  }
  const std::string got = count == 0  ? "an empty line"
                          : has_names ? "a table that begins with " + words
                                      : "numbers, no names of columns";
  throw InputError(name + ":1", "t", "no such column: " + got,
                   "'Format Version' of Motive, timestamp or actual_q_0 of RTDE, t of mc_rtc");
}

/// Has a log of mc_rtc its times?
bool has_column_t(std::string_view header) {
  const char separator = header.find(';') != std::string_view::npos ? ';' : ',';
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(separator), header.size());
    if (trim(header.substr(0, end)) == "t") return true;
    header.remove_prefix(std::min(end + 1, header.size()));
  }
  return false;
}

Imported load_table(const fs::path& path, const Hints& hints) {
  const std::string name = path.string();
  if (ending_of(path) == ".flat")
    return internal::read_flat_log(read_file(path, kExpected, internal::kLargestTable), name, hints);
  const std::string text = read_file(path, kExpected, internal::kLargestTable);
  if (text.starts_with("ANN"))  // "ANNE" and versions behind it
    throw InputError(name, "", "a binary log of mc_rtc",
                     "what its own program makes of it: mc_bin_to_flat " + path.filename().string() + " log.flat");
  refuse_utf16(text, name);
  check_utf8(text, name);
  const std::string_view table = without_byte_order_mark(text);
  if (internal::is_motive(table)) return internal::read_motive(table, name, hints);
  if (internal::is_early_motive(table))
    throw InputError(name + ":1", "", "an export of Tracking Tools, or of Motive before 1.2",
                     "the CSV of Motive 1.2 or later: open the take there and export it again");
  if (internal::is_rtde(table)) return internal::read_rtde(table, name, hints);
  std::string_view rest = table;
  if (const std::string_view header = internal::take_line(rest); !table.empty() && !has_column_t(header))
    refuse_unknown(header, name);
  Imported imported{validation::load_log(path), {}};
  ArchiveRecording& recording = imported.recording;
  recording.remarks.clear();
  // Links of the robot (robot/...) have no markers: its joints tell where they are.
  std::erase_if(recording.motion_capture.bodies,
                [](const record::BodyTrack& body) { return body.name.find('/') != std::string::npos; });
  for (record::BodyTrack& body : recording.motion_capture.bodies) body.name = internal::body_name(body.name, hints);
  if (recording.motion_capture.bodies.empty()) recording.motion_capture = {};
  internal::order_bodies(recording.motion_capture, name);
  internal::turn_wrenches(recording, hints);
  return imported;
}

void join(const Imported& from, const fs::path& path, std::array<fs::path, 3>& brought_by, Imported& into) {
  ArchiveRecording& to = into.recording;
  const auto take = [&](const char* source, const auto& part, auto& place, fs::path& by) {
    if (part.times.empty()) return;
    if (!place.times.empty())
      throw InputError(path.string(), source, "what " + by.filename().string() + " brings, too",
                       "each source in one of the files");
    place = part;
    by = path;
  };
  take("motion capture", from.recording.motion_capture, to.motion_capture, brought_by[0]);
  take("force/torque", from.recording.force_torque, to.force_torque, brought_by[1]);
  take("robot", from.recording.robot, to.robot, brought_by[2]);
  for (const std::string& remark : from.remarks) into.remarks.push_back(path.filename().string() + ": " + remark);
}

}  // namespace

bool is_import(const fs::path& path) {
  static constexpr std::array<std::string_view, 7> kEndings = {".csv", ".txt", ".tsv", ".flat",
                                                               ".bin", ".log", ".data"};
  return is_bag(path) || std::find(kEndings.begin(), kEndings.end(), ending_of(path)) != kEndings.end();
}

Imported load(const fs::path& path, const Hints& hints) { return load_all({path}, hints); }

Imported load_all(const std::vector<fs::path>& paths, const Hints& hints) {
  Imported all;
  std::array<fs::path, 3> brought_by;
  std::string note, begins;
  for (const fs::path& given : paths) {
    const fs::path path = given.has_filename() ? given : given.parent_path();  // "bag/" is "bag"
    Imported one = is_bag(path) ? internal::load_bag(path, hints) : load_table(path, hints);
    const std::string name = path.filename().string();
    note += (note.empty() ? "read from " : ", ") + name;
    if (all.recording.name.empty()) all.recording.name = is_folder(path) ? name : path.stem().string();
    if (const std::string off = internal::begin_at_zero(one.recording); !off.empty())
      begins += (begins.empty() ? "" : ", ") + name + " at " + off;
    join(one, path, brought_by, all);
  }
  all.recording.remarks = {{"note", note}};
  if (!begins.empty()) all.recording.remarks.emplace_back("begins", begins);
  return all;
}

std::map<std::string, std::string> parse_names(const std::vector<std::string>& words, const std::string& key) {
  std::map<std::string, std::string> names;
  for (const std::string& word : words) {
    const std::size_t at = word.rfind('=');
    if (at == std::string::npos || at == 0 || at + 1 == word.size())
      throw InputError("command line", key, "'" + word + "'", "OLD=NEW, such as 'Rigid Body 1=Box013'");
    names[word.substr(0, at)] = word.substr(at + 1);
  }
  return names;
}

}  // namespace snug::archive_import
