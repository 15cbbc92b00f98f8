// write_file: a whole file or none.
#pragma once

#include <string_view>

#include "snug/core/output_file.hpp"

namespace snug {

/// Writes and publishes. Throws InputError for a path that cannot be written (where the file is made), OutputError when
/// writing fails.
void write_file(OutputFile file, std::string_view bytes);

}  // namespace snug
