// CSV: a recording as one table with the column names of mc_rtc logs, for spreadsheets and plotting programs.
#pragma once

#include <filesystem>

#include "snug/record/recording.hpp"

namespace snug::record {

/// Writes `recording` as docs/formats.md describes: separator ';', first column t [s] strictly increasing, an empty
/// cell where a value is missing (body not in the cell, not a number). Numbers read back to the same double.
///
/// Orientations are quaternions of the rotation world -> body (the inverse of ours), as mc_rtc logs them. Written
/// beside `path` and then renamed, so that a table at `path` is always whole. Throws InputError when it cannot.
void write_csv(const Recording& recording, const std::filesystem::path& path);

}  // namespace snug::record
