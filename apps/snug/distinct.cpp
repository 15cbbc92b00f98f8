// refuse_same_file: an output that is also an input would be lost.
#include "distinct.hpp"

#include <filesystem>

#include "snug/core/input_error.hpp"

namespace snug::app {

void refuse_same_file(const std::vector<std::string>& inputs, const std::vector<std::optional<std::string>>& outputs) {
  std::vector<std::filesystem::path> taken;
  for (const std::string& input : inputs) taken.push_back(std::filesystem::weakly_canonical(input));
  for (const std::optional<std::string>& output : outputs) {
    if (!output) continue;
    const std::filesystem::path path = std::filesystem::weakly_canonical(*output);
    for (const std::filesystem::path& other : taken)
      if (path == other) throw InputError("command line", *output, "named twice", "another file for each output");
    taken.push_back(path);
  }
}

}  // namespace snug::app
