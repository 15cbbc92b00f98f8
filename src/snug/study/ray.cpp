// Ray: the program that hands out chunks.
#include "snug/study/ray.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "snug/core/write_file.hpp"

namespace snug::study {
namespace {

// A node that is cut off may go on filling a table for a while: a task that finds it locked tries again.
constexpr const char* kRayProgram = R"(
import ctypes
import os
import signal
import socket
import subprocess
import sys
import time

try:
    import ray
except ImportError:
    print(f"snug: error: {sys.executable}: no package ray; expected a Python that has it (pip install ray), named by "
          "SNUG_PYTHON", file=sys.stderr)
    sys.exit(2)


def die_with_worker():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


@ray.remote(num_cpus=1, max_retries=-1)
def fill(chunks):
    """Fills tables; the exit code and the last words of the program."""
    for attempt in range(ATTEMPTS):
        done = subprocess.run([*COMMAND, "--chunks", chunks], cwd=FOLDER, capture_output=True, text=True,
                              preexec_fn=die_with_worker)
        if done.returncode != 1:
            break
        time.sleep(min(30.0, 0.5 * 2.0 ** attempt))
    return done.returncode, done.stderr[-4000:]


def expect_answer():
    """Ray itself waits for minutes where nobody listens."""
    host, colon, port = ADDRESS.removeprefix("ray://").rpartition(":")
    if colon and port.isdigit():
        socket.create_connection((host.strip("[]"), int(port)), timeout=10.0).close()


def main():
    try:
        expect_answer()
        ray.init(address=None if ADDRESS == "local" else ADDRESS, log_to_driver=False, include_dashboard=False
                 if ADDRESS == "local" else None)
    except (OSError, ValueError, RuntimeError) as error:
        print(f"snug: error: --ray {ADDRESS}: {str(error).splitlines()[0]}; expected the address of a Ray cluster, or "
              "local", file=sys.stderr)
        return 2
    waiting, lost, worst = {fill.remote(chunks): chunks for chunks in CHUNKS}, 0, 0
    while waiting:
        ready, _ = ray.wait(list(waiting))
        chunks = waiting.pop(ready[0])
        try:
            code, words = ray.get(ready[0])
        except ray.exceptions.RayError as error:  # of a lost node, where Ray itself does not begin the task again
            lost += 1
            if lost > MOST_LOST:
                raise
            print(f"chunks {chunks}: begun again: {type(error).__name__}", file=sys.stderr)
            waiting[fill.remote(chunks)] = chunks
            continue
        if code:
            print(f"chunks {chunks}: {words.strip()}", file=sys.stderr)
        worst = max(worst, code)
        if sys.stderr.isatty():
            print(f"\r{len(CHUNKS) - len(waiting)} of {len(CHUNKS)} tasks", end="", file=sys.stderr)
    return worst


sys.exit(main())
)";

}  // namespace

std::string ray_program(const Study& study, const Folder& folder, const ArrayPlan& plan, const std::string& program,
                        const std::string& file, const std::string& address) {
  const auto literal = [](const auto& value) { return nlohmann::json(value).dump(); };  // also one of Python
  std::string ranges;
  for (const auto& [first, last] : plan.tasks)
    ranges += (ranges.empty() ? "" : ", ") + literal(fmt::format("{}-{}", first, last));
  const std::vector<std::string> command = {
      program, "study", file, "--dir", std::filesystem::absolute(folder.path()).string(), "--threads", "1"};
  return fmt::format(
             "# Study {}: hands its chunks to a Ray cluster. Rows that are done are not done again.\n"
             "ADDRESS = {}\nFOLDER = {}\nCOMMAND = {}\nCHUNKS = [{}]\nATTEMPTS = 8\nMOST_LOST = 1000\n",
             literal(study.name), literal(address), literal(std::filesystem::current_path().string()), literal(command),
             ranges) +
         kRayProgram;
}

std::filesystem::path write_tasks(const Study& study, const Folder& folder, const ArrayPlan& plan,
                                  const std::string& program, const std::string& file,
                                  const std::optional<std::string>& address) {
  std::filesystem::path script = folder.path() / (address ? "ray-tasks.py" : "array.sh");
  write_file(OutputFile(script), address ? ray_program(study, folder, plan, program, file, *address)
                                         : array_script(study, folder, plan, program, file));
  return script;
}

}  // namespace snug::study
