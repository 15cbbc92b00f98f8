// Runs: commands `snug pack` as processes of their own, started, watched and stopped; what they leave is in the folder.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "snug/workspace/folder.hpp"
#include "snug/workspace/run_progress.hpp"

namespace snug::workspace {

inline constexpr int kMostPlants = 100;    ///< of one order, in one request
inline constexpr int kMostWaiting = 1000;  ///< runs that wait for their turn

/// What is packed, as words of `snug pack`.
struct RunRequest {
  std::string name;      ///< of its files: NAME.txt, NAME.jsonl, NAME.h5, NAME.program.csv
  std::string scenario;  ///< a file of the folder
  std::string items;     ///< a file of the folder; empty: the scenario's own
  std::string sequence;
  std::uint64_t plant_seed = 0;
  std::optional<double> tempo;  ///< 0.5 to 1
  std::string plant;            ///< where a cell is that another program serves, or a robot; empty: simulated
  std::string observe;          ///< of a robot: where boxes are told; empty: nowhere
  bool moves_a_robot = false;   ///< one that is not on this machine
  std::string perception;       ///< of `plant`; empty: exact
  bool holds = false;           ///< who operates is waited for at the first box
  std::string resumes;          ///< name of a run that was killed; empty: none
  int threads = 0;              ///< 0: all cores
};

/// "snug", "pack", ... for a shell in the folder; each a word of its own.
[[nodiscard]] std::vector<std::string> command_of(const RunRequest& request);
/// "snug", "picture", ... that make `what` of a run: picture, film, glb or mcap; of the command that packed it, as a
/// shell line: urscript or ros. Throws InputError for others, and where the command names no scenario or items of a
/// folder.
[[nodiscard]] std::vector<std::string> make_command(const std::string& name, const std::string& what,
                                                    const std::string& packed_by = {});
/// The words as one line that a shell takes apart in the same way.
[[nodiscard]] std::string as_shell_line(const std::vector<std::string>& words);
/// The words of such a line.
[[nodiscard]] std::vector<std::string> words_of(std::string_view shell_line);
/// Throws InputError for names that kind_of_name() refuses, numbers out of range, and words that are none.
void check(const RunRequest& request);

enum class RunState {
  Waiting,     ///< for its turn
  Running,     ///< this process or another has it
  Done,        ///< to its end
  Failed,      ///< it ended without packing, see RunStatus::message
  Ended,       ///< before its end: it was killed, and can be resumed
  NotStarted,  ///< whoever had it waiting has ended
  Unread,      ///< its log has not been read yet: ask again
};
[[nodiscard]] const char* name_of(RunState state);

struct RunStatus {
  std::string name;
  RunState state = RunState::NotStarted;
  bool can_be_stopped = false;  ///< it is a process of this one
  std::string command;
  std::string message;  ///< the last line that it printed about a failure
  RunProgress progress;
  std::vector<std::string> files;
};

/// All may be called from several threads.
///
/// A process holds a lock on its NAME.txt while it lives, also when the one that started it was killed: so every
/// program that looks into the folder can tell what goes on from what was killed.
class Runs {
 public:
  /// `program`: the file of snug; `at_once`: processes, at least 1. The folder must outlive it.
  Runs(const Folder& folder, std::filesystem::path program, int at_once);
  /// Interrupts the runs of this process, and waits until they have written their end.
  ~Runs();
  Runs(const Runs&) = delete;
  Runs& operator=(const Runs&) = delete;

  /// Waits for its turn, then runs. Throws InputError for a request that is wrong and a name that is taken.
  void start(const RunRequest& request);
  /// It ends after the item at hand; at a second time at once. False: it is no run of this process.
  bool stop(const std::string& name);
  /// At once, whatever it does: a robot that it moves stands within 0.2 s of its clock. False: as stop().
  bool stop_now(const std::string& name);
  /// A line of who operates. Throws InputError for what is no order, and for a run that does not go on.
  void operate(const std::string& name, const std::string& line);
  /// All its files. Throws InputError for no run, and for one that goes on.
  void remove(const std::string& name);
  /// Throws InputError where there is no run of that name.
  [[nodiscard]] RunStatus status(const std::string& name);
  /// By name. A run that cannot be read has its state Failed and says why. Logs are read for `patience` at most; those
  /// of the rest are Unread and read in the background.
  [[nodiscard]] std::vector<RunStatus> list(std::chrono::milliseconds patience = std::chrono::hours(1));
  /// NAME.html, made of NAME.h5 with `snug report` unless it is there and newer; where the folder cannot be written it
  /// is made elsewhere and not kept. Throws InputError with what the command said.
  [[nodiscard]] std::string report(const std::string& name);
  /// Makes what can be taken away of a run by the command that is returned. Throws InputError as report(), OutputError
  /// where the folder cannot be written.
  std::vector<std::string> make(const std::string& name, const std::string& what);

 private:
  struct Job {
    std::vector<std::string> words;
    Descriptor output;  ///< holds the lock until the process has it
  };
  void work();
  /// Runs the words in the folder; their exit code, 128 and more for a signal.
  int run(const std::vector<std::string>& words, int output, const std::string& name);
  /// Runs a short command in the folder. Throws InputError with what it said where it fails.
  void run_to_end(const std::vector<std::string>& words, const char* what);
  /// Nothing where the files are those of no run. `reads`: whether it may read a log that nobody has read.
  [[nodiscard]] std::optional<RunStatus> look(const std::string& name, const std::vector<std::string>& files,
                                              bool reads = true);
  /// Nothing where nobody has read the log and it may not be read.
  [[nodiscard]] std::optional<RunProgress> progress_of(const std::string& name, bool reads);
  /// Reads the logs of these runs in a thread of its own.
  void read_in_background(std::vector<std::string> names);

  const Folder& folder_;
  const std::filesystem::path program_;
  std::mutex mutex_, reports_;
  std::condition_variable changed_;
  std::deque<std::string> waiting_;
  std::map<std::string, Job> jobs_;         ///< those that wait
  std::map<std::string, pid_t> processes_;  ///< those that run
  std::map<std::string, int> interrupts_;   ///< how often they were told to stop
  std::atomic<bool> is_ending_ = false;
  std::vector<std::thread> workers_;
  std::mutex logs_mutex_;
  std::map<std::string, LogReader> logs_;
  std::mutex background_mutex_;
  std::thread background_;  ///< reads logs
  std::atomic<bool> is_reading_ = false;
};

}  // namespace snug::workspace
