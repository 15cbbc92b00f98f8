// Log tables: measurements as CSV: a log of mc_rtc read as a recording of an archive, a recording written as tables.
#pragma once

#include <filesystem>
#include <vector>

#include "snug/record/archive.hpp"

namespace snug::validation {

/// Reads a table with the column names of mc_rtc logs (docs/formats.md): `t`, `BODY_FloatingBase_orientation_{w,x,y,z}`
/// (world -> body), `BODY_FloatingBase_position_{x,y,z}`, and perhaps `UR10FTSensor_{cx,cy,cz,fx,fy,fz}` and
/// `tool_...`; separated by ';' or ','; other columns are left out; empty cells, and `nan`, are what was not measured.
/// All sources share the clock `t`, and poses are in W. Throws InputError (file:line, column) for what cannot be read
/// as such a table.
[[nodiscard]] record::ArchiveRecording load_log(const std::filesystem::path& path);

/// Writes one table for each source of the recording, as they have clocks of their own: NAME-mocap.csv, NAME-ft.csv,
/// NAME-robot.csv. Poses as the archive has them, with the names and the convention that load_log reads. Each file is
/// whole or not there. Returns what was written.
std::vector<std::filesystem::path> save_tables(const record::ArchiveRecording& recording,
                                               const std::filesystem::path& folder);

}  // namespace snug::validation
