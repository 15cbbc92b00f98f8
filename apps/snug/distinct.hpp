// refuse_same_file: an output that is also an input would be lost.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace snug::app {

/// Throws InputError when an output that was asked for is one of the inputs or another output, also by another name.
void refuse_same_file(const std::vector<std::string>& inputs, const std::vector<std::optional<std::string>>& outputs);

}  // namespace snug::app
