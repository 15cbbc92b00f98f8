// The readers behind load(), one for each kind of file, and what they share.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "snug/archive_import/measurements.hpp"

namespace snug::archive_import::internal {

/// Bytes of a table; minutes of a whole log have some 100 MB.
inline constexpr std::size_t kLargestTable = std::size_t{1} << 30U;
/// Columns of a robot's table: what the header of a compound type in HDF5 has room for.
inline constexpr std::size_t kMostColumns = 500;
/// Of a quaternion written with few digits.
inline constexpr double kUnitTolerance = 1e-2;

[[nodiscard]] bool is_motive(std::string_view text);
/// An export of Tracking Tools, or of Motive before 1.2: rows of several kinds, behind comments.
[[nodiscard]] bool is_early_motive(std::string_view text);
[[nodiscard]] Imported read_motive(std::string_view text, const std::string& name, const Hints& hints);

[[nodiscard]] bool is_rtde(std::string_view text);
[[nodiscard]] Imported read_rtde(std::string_view text, const std::string& name, const Hints& hints);

[[nodiscard]] Imported read_flat_log(std::string_view bytes, const std::string& name, const Hints& hints);

/// Runs the program below with the Python of the machine. `lines`: what it wrote.
[[nodiscard]] Imported load_bag(const std::filesystem::path& path, const Hints& hints);
[[nodiscard]] Imported read_bag_lines(std::string_view lines, const std::string& name, const Hints& hints);
/// Reads a bag by mcap or rosbags and writes its messages, one a line.
extern const char* const kBagProgram;

/// Takes a line from the text, without its end (LF or CR LF).
[[nodiscard]] std::string_view take_line(std::string_view& text);
/// A finite number, or NaN for nothing and `nan`. Throws InputError otherwise.
[[nodiscard]] double read_cell(std::string_view cell, const std::string& where, const std::string& column);
/// The name of a body in an archive: as the hints rename it, without what HDF5 and tables cannot have.
[[nodiscard]] std::string body_name(std::string_view body, const Hints& hints);
/// A rotation from four numbers, scaled to length 1. Throws InputError for a length far from it.
[[nodiscard]] Quaternion read_quaternion(double w, double x, double y, double z, const std::string& where,
                                         const std::string& column);
/// Times begin within the first second: the whole seconds before the first are taken off, and returned as a text, if
/// any.
[[nodiscard]] std::string begin_at_zero(record::ArchiveRecording& recording);
/// Refuses a recording of fewer than two rows.
void require_two_rows(std::size_t rows, const std::string& name);
/// The rate of times, at least two.
[[nodiscard]] double rate_of(const std::vector<double>& times);
/// Throws InputError for a time that does not come after the one before.
void require_growth(const std::vector<double>& times, double next, const std::string& where);
/// Sorts bodies by name; throws InputError for two of one name.
void order_bodies(record::MotionCaptureLog& log, const std::string& where);
/// All signs turn, if the hints say so.
void turn_wrenches(record::ArchiveRecording& recording, const Hints& hints);

}  // namespace snug::archive_import::internal
