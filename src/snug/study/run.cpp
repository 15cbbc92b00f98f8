// run_study: a process for each row, its output read through pipes, its result appended to the table of its chunk.
#include "snug/study/run.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/input_log.hpp"
#include "snug/core/text.hpp"

namespace snug::study {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kMostTries = 3;
constexpr std::size_t kMostOutput = std::size_t{256} << 20U;  ///< bytes of a row's JSON
constexpr std::size_t kMostWords = 4096;                      ///< bytes kept of what it says on standard error
constexpr std::size_t kMostError = 300;

/// A chunk under way.
struct Chunk {
  std::optional<TableWriter> table;  ///< none without a folder
  std::uint64_t left = 0;            ///< rows not finished
};

/// A row under way.
struct Job {
  std::uint64_t row = 0;
  int tries = 0;
  std::shared_ptr<Chunk> chunk;
  pid_t process = -1;
  int out = -1, error = -1, reads = -1;
  std::string output, words, read;
  Clock::time_point start;
  bool is_over_time = false;
};

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// In the new process: never returns.
[[noreturn]] void be_row(const RowWork& work, std::uint64_t row, int out, int error, int reads) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a row whose caller is gone has nobody to tell
  ::setpgid(0, 0);                     // what a terminal sends goes to the caller, who passes it on
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, 0);
  ::dup2(out, 1);
  ::dup2(error, 2);
  constexpr int kReads = 3;
  if (reads == kReads) {
    ::fcntl(kReads, F_SETFD, FD_CLOEXEC);
  } else {
    ::dup3(reads, kReads, O_CLOEXEC);  // programs that the row starts do not keep it open
  }
  ::close_range(kReads + 1, ~0U, 0);  // tables, with their locks
  int code = 1;
  try {
    const InputLog log([](const std::string& path, std::uint64_t hash) {
      const std::string line =
          nlohmann::json{path, hash}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
      (void)!::write(kReads, line.data(), line.size());
    });
    code = work(row);
  } catch (const InputError& problem) {
    std::fprintf(stderr, "snug: error: %s\n", problem.what());
    code = 2;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
  }
  std::fflush(stdout);
  std::fflush(stderr);
  ::_exit(code);
}

void begin(const RowWork& work, Job& job) {
  int out[2], error[2], reads[2];
  if (::pipe2(out, O_CLOEXEC) != 0) fail("pipe");
  if (::pipe2(error, O_CLOEXEC) != 0) fail("pipe");
  if (::pipe2(reads, O_CLOEXEC) != 0) fail("pipe");
  std::fflush(stdout);
  std::fflush(stderr);
  job.output.clear();
  job.words.clear();
  job.read.clear();
  job.is_over_time = false;
  job.start = Clock::now();
  job.process = ::fork();
  if (job.process < 0) fail("fork");
  if (job.process == 0) be_row(work, job.row, out[1], error[1], reads[1]);
  ::close(out[1]);
  ::close(error[1]);
  ::close(reads[1]);
  job.reads = reads[0];
  job.out = out[0];
  job.error = error[0];
  ++job.tries;
}

/// Takes what there is; closes at the end.
void take(int& from, std::string& into, std::size_t most) {
  char buffer[65536];
  const ssize_t count = ::read(from, buffer, sizeof buffer);
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return;
  if (count <= 0) {
    ::close(from);
    from = -1;
    return;
  }
  if (into.size() < most) into.append(buffer, static_cast<std::size_t>(count));
}

/// By the system or a person: that says nothing about the row.
bool was_ended_by_others(int status) {
  if (!WIFSIGNALED(status)) return false;
  const int number = WTERMSIG(status);
  return number == SIGKILL || number == SIGTERM || number == SIGINT || number == SIGHUP;
}

/// The end of it, without the program's name before it.
std::string last_words(const std::string& words) {
  std::string line = words.substr(0, words.find_last_not_of('\n') + 1);
  for (const char* start : {"snug: error: ", "snug: failed: "}) {
    const std::size_t mark = line.rfind(start);
    if (mark != std::string::npos) line = line.substr(mark + 6);
  }
  return printable_end(line, kMostError);
}

/// What the row has read; files that were changed meanwhile are told as read with other bytes.
Inputs inputs_of(const std::string& version, const std::string& lines, OneWorld& world, std::uint64_t row) {
  Inputs inputs{version, {}};
  for (std::size_t begin = 0, end = lines.find('\n'); end != std::string::npos;
       begin = end + 1, end = lines.find('\n', begin)) {
    const nlohmann::json json = nlohmann::json::parse(lines.substr(begin, end - begin), nullptr, false);
    if (!json.is_array() || json.size() != 2 || !json[0].is_string() || !json[1].is_number_unsigned()) continue;
    const std::string path = json[0].get<std::string>();
    const std::uint64_t hash = json[1].get<std::uint64_t>();
    note_input_hash(path, hash);  // of a study in a row of another
    const bool is_new = inputs.files.emplace(path, hash).second;
    if (!is_new && inputs.files[path] != hash) {
      world.add(inputs, row);
      inputs.files[path] = hash;
      world.add(inputs, row);  // throws
    }
  }
  world.add(inputs, row);
  return inputs;
}

class Runner {
 public:
  /// `folder`: or null, no tables.
  Runner(const Study& study, const Folder* folder, const RowWork& work, const RunSettings& settings)
      : study_(study), folder_(folder), work_(work), settings_(settings) {}

  RunSummary run() {
    end_ = std::min(study_.chunks(), settings_.last_chunk == UINT64_MAX ? study_.chunks() : settings_.last_chunk + 1);
    next_chunk_ = settings_.first_chunk;
    next_told_ = next_chunk_ * static_cast<std::uint64_t>(study_.chunk);
    if (folder_ != nullptr) {
      world_ = folder_->read_world();
      world_.expect_now(settings_.version);
    }
    while (true) {
      if (!is_stopped_ && settings_.is_stopped && settings_.is_stopped()) stop();
      while (static_cast<int>(jobs_.size()) < settings_.processes && find_work()) {
      }
      if (jobs_.empty()) break;
      watch();
    }
    for (const auto& [row, told] : untold_) settings_.tell(told.first, told.second);
    return summary_;
  }

  ~Runner() { abandon(); }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

 private:
  /// Begins a row, if there is one.
  bool find_work() {
    while (waiting_.empty()) {
      if (next_chunk_ >= end_) return false;
      open_chunk(next_chunk_++);
    }
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    begin(work_, job);
    jobs_.push_back(std::move(job));
    return true;
  }

  void open_chunk(std::uint64_t index) {
    const auto size = static_cast<std::uint64_t>(study_.chunk);
    const std::uint64_t first = index * size, end = std::min(study_.rows(), first + size);
    const auto chunk = std::make_shared<Chunk>();
    std::map<std::uint64_t, RowResult> done;
    if (folder_ != nullptr) {
      done = folder_->read(index, &world_);
      if (done.size() < end - first) {  // without a lock: done is done
        chunk->table = TableWriter::open(folder_->table(index));
        done = folder_->read(index, &world_);
      }
    }
    for (const auto& [row, result] : done) tell(result, {});
    if (folder_ != nullptr && !chunk->table) {
      summary_.left_out += end - first - done.size();
      return;
    }
    for (std::uint64_t row = first; row < end; ++row) {
      if (done.contains(row)) continue;
      Job job;
      job.row = row;
      job.chunk = chunk;
      ++chunk->left;
      waiting_.push_back(std::move(job));
    }
    wanted_ += chunk->left;
  }

  void watch() {
    std::vector<pollfd> files;
    for (const Job& job : jobs_) {
      files.push_back({job.out, POLLIN, 0});
      files.push_back({job.error, POLLIN, 0});
      files.push_back({job.reads, POLLIN, 0});
    }
    const int patience = study_.time_limit > 0.0 || settings_.is_stopped ? 100 : -1;
    if (::poll(files.data(), files.size(), patience) < 0 && errno != EINTR) fail("poll");
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (files[3 * i].revents != 0) take(jobs_[i].out, jobs_[i].output, kMostOutput);
      if (files[3 * i + 1].revents != 0) take(jobs_[i].error, jobs_[i].words, kMostWords);
      if (files[3 * i + 2].revents != 0) take(jobs_[i].reads, jobs_[i].read, kMostOutput);
    }
    for (std::size_t i = jobs_.size(); i-- > 0;) {
      Job& job = jobs_[i];
      const std::chrono::duration<double> taken = Clock::now() - job.start;
      if (study_.time_limit > 0.0 && taken.count() > study_.time_limit && !job.is_over_time) {
        job.is_over_time = true;
        ::kill(job.process, SIGKILL);
      }
      if (job.out >= 0 || job.error >= 0 || job.reads >= 0) continue;
      Job ended = std::move(job);
      jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(i));
      finish(std::move(ended), taken.count());
    }
  }

  void finish(Job job, double seconds) {
    int status = 0;
    while (::waitpid(job.process, &status, 0) < 0 && errno == EINTR) {
    }
    if (was_ended_by_others(status) && !job.is_over_time) {
      if (is_stopped_) return;
      if (job.tries < kMostTries) {
        waiting_.push_front(std::move(job));
        return;
      }
      ++summary_.left_out;
      close(*job.chunk);
      return;
    }
    RowResult result;
    result.row = job.row;
    result.seconds = seconds;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (job.is_over_time) {
      result.error = kOverTime;
    } else if (WIFSIGNALED(status)) {
      result.error = "signal " + std::to_string(WTERMSIG(status)) + ": " + last_words(job.words);
    } else {
      if (result.exit_code != 0) result.error = last_words(job.words);
      static_cast<ResultValues&>(result) = values_of(study_, job.output);
    }
    if (is_stopped_) return tell(result, job.words);
    if (result.exit_code == 2 && job.row == 0) {
      job.chunk.reset();
      abandon();
      if (folder_ != nullptr) folder_->remove_if_new();
      throw InputError(study_.source, "row 0", result.error,
                       "rows that can be run: " + command_of(study_, row_of(study_, 0)));
    }
    const Inputs inputs = inputs_of(settings_.version, job.read, world_, job.row);
    result.inputs = inputs.hash();
    if (job.chunk->table) job.chunk->table->append(result, inputs);
    close(*job.chunk);
    ++summary_.done;
    summary_.failed += result.exit_code != 0 ? 1 : 0;
    summary_.row_seconds += seconds;
    if (settings_.progress) settings_.progress(summary_.done, wanted_);
    tell(result, job.words);
  }

  /// Hands results on in the order of the rows.
  void tell(const RowResult& result, const std::string& said) {
    if (!settings_.tell) return;
    untold_.emplace(result.row, std::pair(result, said));
    for (auto next = untold_.find(next_told_); next != untold_.end(); next = untold_.find(++next_told_)) {
      const auto told = std::move(next->second);
      untold_.erase(next);
      settings_.tell(told.first, told.second);
    }
  }

  void stop() {
    is_stopped_ = true;
    waiting_.clear();
    next_chunk_ = end_;
    for (const Job& job : jobs_) ::kill(job.process, SIGTERM);
  }

  /// Rows under way are killed and tables closed.
  void abandon() {
    for (const Job& job : jobs_) {
      ::kill(job.process, SIGKILL);
      ::waitpid(job.process, nullptr, 0);
      if (job.out >= 0) ::close(job.out);
      if (job.error >= 0) ::close(job.error);
      if (job.reads >= 0) ::close(job.reads);
    }
    jobs_.clear();
    waiting_.clear();
  }

  static void close(Chunk& chunk) {
    if (--chunk.left == 0 && chunk.table) chunk.table->sync();
  }

  const Study& study_;
  const Folder* const folder_;
  const RowWork& work_;
  const RunSettings& settings_;
  OneWorld world_{folder_ != nullptr ? folder_->path().string() : study_.source};
  std::uint64_t next_chunk_ = 0, end_ = 0, wanted_ = 0, next_told_ = 0;
  bool is_stopped_ = false;
  std::map<std::uint64_t, std::pair<RowResult, std::string>> untold_;  ///< some row before them is still under way
  std::deque<Job> waiting_;
  std::vector<Job> jobs_;
  RunSummary summary_;
};

}  // namespace

RunSummary run_rows(const Study& study, const Folder* folder, const RowWork& work, const RunSettings& settings) {
  return Runner(study, folder, work, settings).run();
}

namespace {

RowWork work_of(const Study& study, const Verb& verb) {
  return [&study, &verb](std::uint64_t row) {
    std::vector<std::string> words = words_of(study, row_of(study, row));
    words.emplace_back("--json");
    return verb(words);
  };
}

}  // namespace

RunSummary run_study(const Study& study, const Folder& folder, const Verb& verb, const RunSettings& settings) {
  return run_rows(study, &folder, work_of(study, verb), settings);
}

RunSummary run_study(const Study& study, const Verb& verb, const RunSettings& settings) {
  return run_rows(study, nullptr, work_of(study, verb), settings);
}

}  // namespace snug::study
