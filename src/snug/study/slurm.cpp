// Slurm: the script, and sbatch with it.
#include "snug/study/slurm.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <stdexcept>

#include "snug/core/text.hpp"

namespace snug::study {

ArrayPlan plan_array(const Study& study, const Folder& folder, std::uint64_t most_tasks) {
  std::vector<std::uint64_t> missing;
  const auto size = static_cast<std::uint64_t>(study.chunk);
  for (std::uint64_t chunk = 0; chunk < study.chunks(); ++chunk) {
    if (folder.read(chunk).size() < std::min(size, study.rows() - chunk * size)) missing.push_back(chunk);
  }
  ArrayPlan plan;
  const std::uint64_t each = (missing.size() + most_tasks - 1) / most_tasks;
  for (std::size_t i = 0; i < missing.size(); i += each) {
    plan.tasks.emplace_back(missing[i], missing[std::min(missing.size(), i + each) - 1]);
  }
  return plan;
}

std::string array_script(const Study& study, const Folder& folder, const ArrayPlan& plan, const std::string& program,
                         const std::string& file) {
  const std::string here = std::filesystem::current_path().string();
  const std::string log = (std::filesystem::absolute(folder.path()) / "slurm-%a.log").string();
  std::string text =
      "#!/bin/sh\n# An array of jobs: task k does the k-th range of chunks. Rows that are done are not done again.\n";
  text += fmt::format("#SBATCH --job-name={}\n#SBATCH --array=0-{}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n",
                      quoted(study.name), plan.tasks.size() - 1);
  text += fmt::format("#SBATCH --chdir={}\n#SBATCH --output={}\n", quoted(here), quoted(log));
  for (const auto& [option, value] : study.slurm)
    text += fmt::format("#SBATCH --{}{}\n", option, value.empty() ? "" : "=" + quoted(value));
  text += "set -eu\nset --";
  for (const auto& [first, last] : plan.tasks) text += fmt::format(" {}-{}", first, last);
  text += "\nshift \"$SLURM_ARRAY_TASK_ID\"\n";
  text += fmt::format("exec {} study {} --dir {} --chunks \"$1\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
                      quoted(program), quoted(file), quoted(folder.path().string()));
  return text;
}

std::string submit(const std::filesystem::path& script) {
  const std::string command = "sbatch " + quoted(script.string()) + " 2>&1";
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("sbatch cannot be started");
  std::string said;
  std::array<char, 512> buffer{};
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) said += buffer.data();
  const int status = ::pclose(pipe);
  while (!said.empty() && said.back() == '\n') said.pop_back();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw std::runtime_error("sbatch is not installed; the script is " + script.string());
  if (status != 0) throw std::runtime_error("sbatch: " + said);
  return printable(said, kLongestMessage);
}

}  // namespace snug::study
