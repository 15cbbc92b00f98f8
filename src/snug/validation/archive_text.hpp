// What is in an archive of measurements, as text and as JSON (docs/formats.md).
#pragma once

#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/record/archive.hpp"

namespace snug::validation {

/// Of each recording its remarks, its sources with samples, rate [Hz] and duration [s], and how much of each body was
/// tracked [%]. Reads all of it: throws InputError for what cannot be read.
[[nodiscard]] std::string contents_text(const record::ArchiveReader& reader);
/// The same, and the mass [kg] of each object.
[[nodiscard]] std::string contents_json(const record::ArchiveReader& reader);
/// Whether the archive is whole, its recordings, and each of `defects` by its path.
[[nodiscard]] std::string defects_json(const record::ArchiveReader& reader, const std::vector<InputError>& defects);

}  // namespace snug::validation
