// Runs: commands `snug pack` as processes of their own, started, watched and stopped; what they leave is in the folder.
#include "snug/workspace/runs.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/core/text.hpp"
#include "snug/session/operator.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace snug::workspace {
namespace {

constexpr std::size_t kLongestWord = 200;      // bytes
constexpr std::chrono::seconds kPatience(10);  // for a process that was interrupted
constexpr int kLessUrgent = 5;                 // nicer than the server
constexpr std::array<const char*, 12> kEndings = {".txt",      ".jsonl", ".h5",  ".program.csv", ".html",     ".live",
                                                  ".operator", ".png",   ".glb", ".script",      ".ros.yaml", ".mcap"};

void require_kind(const std::string& name, FileKind kind, const char* key, const char* expected) {
  if (kind_of_name(name) != kind) throw InputError("run", key, name, expected);
}

void require_run_name(const std::string& name) { (void)kind_of_name(name + ".program.csv"); }

/// What of a name stands before an ending of runs; empty for other files.
std::string run_of(const std::string& file) {
  for (const char* ending : {".jsonl", ".txt"}) {
    if (file.ends_with(ending)) return file.substr(0, file.size() - std::strlen(ending));
  }
  return {};
}

void print_to(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(file, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;  // the process will say that the disk is full
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

/// Does somebody hold the lock of this file?
bool is_locked(const Folder& folder, const std::string& file) {
  const Descriptor opened(::openat(folder.descriptor(), file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  return opened.is_open() && ::flock(opened.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

bool has_file(const Folder& folder, const std::string& name, struct stat& status) {
  return ::fstatat(folder.descriptor(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(status.st_mode);
}

/// Frames for who watched: the recording has them all.
void drop_live(const Folder& folder, const std::string& name) {
  struct stat status {};
  if (has_file(folder, name + ".h5", status) && has_file(folder, name + ".live", status))
    ::unlinkat(folder.descriptor(), (name + ".live").c_str(), 0);
}

/// A cell that another process serves, or a robot, sets the pace.
bool drives_robot(const std::vector<std::string>& words) { return std::ranges::find(words, "--plant") != words.end(); }

/// The last line that begins with "snug: ", without that.
std::string find_message(const std::string& text) {
  const std::size_t at = text.rfind("\nsnug: ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + 7;
  return printable(text.substr(begin, text.find('\n', begin) - begin), kLongestMessage);
}

}  // namespace

const char* name_of(RunState state) {
  switch (state) {
    case RunState::Waiting:
      return "waiting";
    case RunState::Running:
      return "running";
    case RunState::Done:
      return "done";
    case RunState::Failed:
      return "failed";
    case RunState::Ended:
      return "ended early";
    case RunState::NotStarted:
      return "not started";
    case RunState::Unread:
      return "being read";
  }
  return "";
}

namespace {

void check_plant(const RunRequest& request) {
  const auto is_address = [](const std::string& word, std::initializer_list<std::string_view> schemes) {
    return word.size() <= kLongestWord && is_printable(word) && word.find(' ') == std::string::npos &&
           std::ranges::any_of(schemes, [&](std::string_view one) { return word.starts_with(one); });
  };
  if (!request.plant.empty() && !is_address(request.plant, {"click://", "click+ipc://", "ur://"}))
    throw InputError("run", "plant", printable(request.plant, kLongestWord),
                     "click://HOST:PORT, click+ipc://PATH or ur://HOST");
  if (!request.observe.empty() && !is_address(request.observe, {"tcp://", "ipc://"}))
    throw InputError("run", "observe", printable(request.observe, kLongestWord), "tcp://HOST:PORT or ipc://PATH");
  const bool is_robot = request.plant.starts_with("ur://");
  if (!is_robot && (!request.observe.empty() || request.moves_a_robot))
    throw InputError("run", request.moves_a_robot ? "moves_a_robot" : "observe", request.plant, "a plant ur://HOST");
  static constexpr std::array<std::string_view, 5> kKinds = {"", "exact", "noisy", "dead-reckoning", "camera"};
  if (std::ranges::find(kKinds, request.perception) == kKinds.end())
    throw InputError("run", "perception", printable(request.perception, 40), "exact, noisy, dead-reckoning or camera");
}

}  // namespace

void check(const RunRequest& request) {
  require_run_name(request.name);
  require_kind(request.scenario, FileKind::Scenario, "scenario", "a file that ends in .yaml");
  if (!request.items.empty()) require_kind(request.items, FileKind::Items, "items", "a file that ends in .csv");
  if (!request.resumes.empty()) require_run_name(request.resumes);
  const std::string& sequence = request.sequence;
  // A word that begins with a dash would be an option.
  if (sequence.empty() || sequence.size() > kLongestWord || sequence.front() == '-' || !is_printable(sequence))
    throw InputError("run", "sequence", printable(sequence, kLongestWord), "the name of a sequence or an order");
  if (request.tempo && !(*request.tempo >= 0.5 && *request.tempo <= 1.0))
    throw InputError("run", "tempo", std::to_string(*request.tempo), "0.5 to 1");
  check_plant(request);
}

namespace {

/// What a run packed, as words of `snug export`. The line may be anybody's: names are those of files of the folder.
std::vector<std::string> cell_words(const std::string& packed_by) {
  const std::vector<std::string> said = words_of(packed_by);
  std::vector<std::string> words;
  const std::string scenario = said.size() > 2 ? said[2] : std::string();
  if (said.size() < 2 || said[0] != "snug" || said[1] != "pack")
    throw InputError("run", "command", printable(packed_by, 60), "a run whose NAME.txt begins with its command");
  require_kind(scenario, FileKind::Scenario, "scenario", "a file that ends in .yaml");
  words.insert(words.end(), {"--scenario", scenario});
  for (std::size_t i = 3; i + 1 < said.size(); ++i) {
    if (said[i] != "--items" && said[i] != "--sequence") continue;
    if (said[i] == "--items") require_kind(said[i + 1], FileKind::Items, "items", "a file that ends in .csv");
    if (said[i + 1].empty() || said[i + 1].front() == '-')
      throw InputError("run", "sequence", printable(said[i + 1], kLongestWord), "the name of a sequence or an order");
    words.insert(words.end(), {said[i], said[i + 1]});
    ++i;
  }
  return words;
}

}  // namespace

std::vector<std::string> make_command(const std::string& name, const std::string& what, const std::string& packed_by) {
  require_run_name(name);
  if (what == "urscript" || what == "ros") {
    const bool is_script = what == "urscript";
    std::vector<std::string> words = {"snug", "export", name + ".program.csv"};
    const std::vector<std::string> cell = cell_words(packed_by);
    words.insert(words.end(), cell.begin(), cell.end());
    words.insert(words.end(), {"--format", is_script ? "urscript" : "ros-trajectory", "-o",
                               name + (is_script ? ".script" : ".ros.yaml")});
    return words;
  }
  if (what == "picture") return {"snug", "picture", name + ".h5", "-o", name + ".png"};
  if (what == "film")
    return {"snug", "picture", name + ".h5", "--video", name + "-film", "--fps", "10", "--speed", "4"};
  if (what == "glb" || what == "mcap")
    return {"snug", "export", name + ".h5", "--format", what, "-o", name + "." + what};
  throw InputError("request", "what", printable(what, 40), "picture, film, glb, mcap, urscript or ros");
}

std::vector<std::string> command_of(const RunRequest& request) {
  std::vector<std::string> words = {"snug", "pack", request.scenario};
  const auto add = [&](const char* option, const std::string& value) { words.insert(words.end(), {option, value}); };
  if (!request.items.empty()) add("--items", request.items);
  add("--sequence", request.sequence);
  const bool is_served = !request.plant.empty();
  if (is_served) add("--plant", request.plant);
  if (!request.observe.empty()) add("--observe", request.observe);
  if (request.moves_a_robot) words.emplace_back("--yes-this-moves-a-robot");
  if (!request.perception.empty()) add("--perception", request.perception);
  if (!is_served) add("--plant-seed", std::to_string(request.plant_seed));
  if (request.tempo) {
    std::string text = std::to_string(*request.tempo);
    text.resize(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    add("--tempo", text);
  }
  if (request.threads > 0) add("--threads", std::to_string(request.threads));
  if (!request.resumes.empty()) add("--resume", request.resumes + ".jsonl");
  add("--log", request.name + ".jsonl");
  add("--operator", request.name + ".operator");
  add("--program", request.name + ".program.csv");
  if (is_served) return words;  // what it records is what serves it
  add("--live", request.name + ".live");
  add("-o", request.name + ".h5");
  return words;
}

std::string as_shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    const bool is_plain = !word.empty() && std::ranges::all_of(word, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
             c == '-' || c == '/';
    });
    if (!line.empty()) line += ' ';
    if (is_plain) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

std::vector<std::string> words_of(std::string_view shell_line) {
  std::vector<std::string> words;
  bool is_quoted = false, is_in_word = false;
  for (std::size_t i = 0; i < shell_line.size(); ++i) {
    const char c = shell_line[i];
    if (c == ' ' && !is_quoted) {
      is_in_word = false;
      continue;
    }
    if (!is_in_word) words.emplace_back();
    is_in_word = true;
    if (c == '\'') {
      is_quoted = !is_quoted;
    } else if (c == '\\' && !is_quoted && i + 1 < shell_line.size()) {
      words.back() += shell_line[++i];
    } else {
      words.back() += c;
    }
  }
  return words;
}

Runs::Runs(const Folder& folder, std::filesystem::path program, int at_once)
    : folder_(folder), program_(std::move(program)) {
  for (int i = 0; i < std::max(1, at_once); ++i) workers_.emplace_back([this] { work(); });
}

Runs::~Runs() {
  std::unique_lock lock(mutex_);
  is_ending_ = true;
  changed_.notify_all();
  for (const auto& [name, process] : processes_) ::kill(process, SIGINT);
  if (!changed_.wait_for(lock, kPatience, [this] { return processes_.empty(); })) {
    for (const auto& [name, process] : processes_) ::kill(process, SIGKILL);
  }
  lock.unlock();
  for (std::thread& worker : workers_) worker.join();
  const std::lock_guard background(background_mutex_);
  if (background_.joinable()) background_.join();
}

void Runs::start(const RunRequest& request) {
  check(request);
  (void)folder_.read(request.scenario);  // no link, and a file
  if (!request.items.empty()) (void)folder_.read(request.items);
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= static_cast<std::size_t>(kMostWaiting))
    throw InputError("run", "", "too many runs that wait", "at most " + std::to_string(kMostWaiting));
  for (const char* ending : kEndings) {
    struct stat status {};
    if (::fstatat(folder_.descriptor(), (request.name + ending).c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0)
      throw InputError("run", "name", request.name, "a name that is free: there is a file " + request.name + ending);
  }
  Job job{command_of(request), folder_.create(request.name + ".txt")};
  const Descriptor said = [&] {
    try {
      return folder_.create(request.name + ".operator");
    } catch (const std::exception&) {
      ::unlinkat(folder_.descriptor(), (request.name + ".txt").c_str(), 0);  // no half of a run stays
      throw;
    }
  }();
  if (request.holds) print_to(said.get(), "next hold\n");
  (void)::flock(job.output.get(), LOCK_EX | LOCK_NB);  // nobody else knows of it yet
  print_to(job.output.get(), "$ " + as_shell_line(job.words) + "\n");
  jobs_.emplace(request.name, std::move(job));
  {
    const std::lock_guard logs(logs_mutex_);
    logs_.erase(request.name);
  }
  waiting_.push_back(request.name);
  changed_.notify_all();
}

void Runs::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (is_ending_) return;
    const std::string name = waiting_.front();
    waiting_.pop_front();
    const auto node = jobs_.extract(name);
    processes_[name] = 0;  // 0: about to be started
    lock.unlock();
    const int code = run(node.mapped().words, node.mapped().output.get(), name);
    if (code == 0) drop_live(folder_, name);
    lock.lock();
    processes_.erase(name);
    interrupts_.erase(name);
    changed_.notify_all();
  }
}

int Runs::run(const std::vector<std::string>& words, int output, const std::string& name) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  ::posix_spawn_file_actions_addfchdir_np(&actions, folder_.descriptor());
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);  // connections of the server
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // Ctrl-C in the terminal is the server's alone
  std::vector<std::string> own = words;
  std::vector<char*> pointers;
  for (std::string& word : own) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t process = 0;
  int failed = 0;
  {
    const std::lock_guard lock(mutex_);
    failed = is_ending_ ? ECANCELED
                        : ::posix_spawn(&process, program_.c_str(), &actions, &attributes, pointers.data(), environ);
    // The page that shows a run comes first: a run takes all cores while it plans. Threads inherit this.
    if (failed == 0 && !drives_robot(words))
      (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(process), ::getpriority(PRIO_PROCESS, 0) + kLessUrgent);
    if (failed == 0 && !name.empty()) {
      processes_[name] = process;
      if (interrupts_.contains(name)) ::kill(process, SIGINT);
    }
  }
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (failed != 0) {
    print_to(output, std::string("snug: not started: ") + std::strerror(failed) + "\n");
    return 127;
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool Runs::stop(const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (const auto waits = std::ranges::find(waiting_, name); waits != waiting_.end()) {
    waiting_.erase(waits);
    print_to(jobs_.at(name).output.get(), "snug: stopped before it began\n");
    jobs_.erase(name);
    return true;
  }
  const auto found = processes_.find(name);
  if (found == processes_.end()) return false;
  const int before = interrupts_[name]++;
  if (found->second > 0) ::kill(found->second, before == 0 ? SIGINT : SIGKILL);
  return true;
}

bool Runs::stop_now(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = processes_.find(name);
  if (found == processes_.end() || found->second <= 0) return false;
  ++interrupts_[name];
  ::kill(found->second, SIGKILL);
  return true;
}

void Runs::operate(const std::string& name, const std::string& line) {
  require_run_name(name);
  const std::optional<session::OperatorOrder> order = session::parse_operator_order(line, "order", 1);
  if (!order || line.find_first_of("\n\r") != std::string::npos)
    throw InputError("order", "", printable(line, 60), "one line: AT ACTION");
  const RunStatus now = status(name);
  if (now.state != RunState::Running && now.state != RunState::Waiting)
    throw InputError("run", "name", name, "a run that goes on");
  folder_.append(name + ".operator", session::format_operator_order(*order) + "\n");
}

void Runs::remove(const std::string& name) {
  const RunStatus now = status(name);
  if (now.state == RunState::Running || now.state == RunState::Waiting)
    throw InputError("run", "name", name, "a run that is over: stop it first");
  for (const std::string& file : now.files) folder_.remove(file);
  const std::lock_guard lock(logs_mutex_);
  logs_.erase(name);
}

std::optional<RunProgress> Runs::progress_of(const std::string& name, bool reads) {
  const std::lock_guard lock(logs_mutex_);
  if (!reads && !logs_.contains(name)) return std::nullopt;
  LogReader& reader = logs_[name];
  reader.read(folder_, name + ".jsonl");
  return reader.progress();
}

void Runs::read_in_background(std::vector<std::string> names) {
  const std::lock_guard lock(background_mutex_);
  if (is_ending_ || is_reading_) return;
  if (background_.joinable()) background_.join();
  is_reading_ = true;
  background_ = std::thread([this, names = std::move(names)] {
    for (const std::string& name : names) {
      if (is_ending_) break;
      LogReader reader;  // no lock while it reads: lists are answered meanwhile
      try {
        reader.read(folder_, name + ".jsonl");
      } catch (const std::exception&) {  // whoever looks at this run hears it: as far as it can be read
      }
      const std::lock_guard logs(logs_mutex_);
      logs_.try_emplace(name, std::move(reader));
    }
    is_reading_ = false;
  });
}

std::optional<RunStatus> Runs::look(const std::string& name, const std::vector<std::string>& files, bool reads) {
  RunStatus status;
  status.name = name;
  status.files = files;
  const auto has = [&](const char* ending) { return std::ranges::find(files, name + ending) != files.end(); };
  {
    const std::lock_guard lock(mutex_);
    const bool waits = std::ranges::find(waiting_, name) != waiting_.end();
    status.can_be_stopped = waits || processes_.contains(name);
    if (status.can_be_stopped) status.state = waits ? RunState::Waiting : RunState::Running;
  }
  const bool is_held = has(".txt") && !status.can_be_stopped && is_locked(folder_, name + ".txt");
  if (is_held) status.state = RunState::Running;
  constexpr std::string_view kBegin = "$ snug pack ";
  try {
    const std::string text = has(".txt") ? folder_.read(name + ".txt") : std::string();
    if (text.starts_with(kBegin)) {
      status.command = printable(text.substr(2, text.find('\n') - 2), 4 * kLongestMessage);
      status.message = find_message(text);
    } else {
      std::erase(status.files, name + ".txt");  // somebody's notes
    }
    if (has(".jsonl")) {
      std::optional<RunProgress> progress = progress_of(name, reads);
      if (!progress) {
        if (!status.can_be_stopped && !is_held) status.state = RunState::Unread;
        return status;
      }
      status.progress = *std::move(progress);
    }
  } catch (const InputError& error) {
    if (!status.can_be_stopped && !is_held) status.state = RunState::Failed;
    status.message = error.what();
  }
  if (status.command.empty() && status.progress.items == 0) return std::nullopt;
  if (status.state == RunState::Failed) return status;
  if (status.can_be_stopped || is_held) return status;
  if (status.progress.is_over) {
    const bool is_good = status.progress.failure.empty() && !status.message.starts_with("failed");
    status.state = is_good ? RunState::Done : RunState::Failed;
    if (status.message.empty()) status.message = status.progress.failure;
  } else if (status.progress.items > 0) {
    status.state = RunState::Ended;
  } else if (!status.message.empty()) {
    status.state = RunState::Failed;
  }
  return status;
}

namespace {

/// Files of each run.
std::map<std::string, std::vector<std::string>> find_runs(const Folder& folder) {
  const std::vector<Entry> entries = folder.list();
  std::map<std::string, std::vector<std::string>> runs;
  for (const Entry& entry : entries) {
    if (const std::string name = run_of(entry.name); !name.empty()) runs[name];
  }
  for (const Entry& entry : entries) {
    for (const char* ending : kEndings) {
      if (!entry.name.ends_with(ending)) continue;
      const auto found = runs.find(entry.name.substr(0, entry.name.size() - std::strlen(ending)));
      if (found != runs.end()) found->second.push_back(entry.name);
    }
  }
  return runs;
}

}  // namespace

RunStatus Runs::status(const std::string& name) {
  require_run_name(name);
  const auto runs = find_runs(folder_);
  const auto found = runs.find(name);
  std::optional<RunStatus> status;
  if (found != runs.end()) status = look(name, found->second);
  if (!status) throw InputError("run", "name", name, "a run of the folder");
  return *std::move(status);
}

std::vector<RunStatus> Runs::list(std::chrono::milliseconds patience) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<RunStatus> all;
  std::vector<std::string> unread;
  for (const auto& [name, files] : find_runs(folder_)) {
    std::optional<RunStatus> status = look(name, files, std::chrono::steady_clock::now() - begin < patience);
    if (!status) continue;
    if (status->state == RunState::Unread) unread.push_back(name);
    all.push_back(*std::move(status));
  }
  if (!unread.empty()) read_in_background(std::move(unread));
  return all;
}

std::string Runs::report(const std::string& name) {
  require_run_name(name);
  const std::lock_guard one_at_a_time(reports_);
  struct stat page {
  }, recording{};
  const bool has_page = ::fstatat(folder_.descriptor(), (name + ".html").c_str(), &page, AT_SYMLINK_NOFOLLOW) == 0;
  if (has_page && !S_ISREG(page.st_mode)) throw InputError(name + ".html", "", "something that is no file", "a report");
  if (!has_file(folder_, name + ".h5", recording))
    throw InputError("run", "name", name, "a run with a recording " + name + ".h5: it is written at the end");
  if (has_page && page.st_mtime >= recording.st_mtime) return folder_.read(name + ".html");
  if (folder_.can_be_written()) {
    run_to_end({"snug", "report", name + ".h5", "-o", name + ".html"}, "report");
    return folder_.read(name + ".html");
  }
  const TemporaryFolder elsewhere("snug-report-");
  run_to_end({"snug", "report", name + ".h5", "-o", (elsewhere.path() / "report.html").string()}, "report");
  return read_file(elsewhere.path() / "report.html", "the report that snug report made", kLargestRead);
}

std::vector<std::string> Runs::make(const std::string& name, const std::string& what) {
  const bool is_program = what == "urscript" || what == "ros";
  std::vector<std::string> words = make_command(name, what, is_program ? status(name).command : std::string());
  const std::lock_guard one_at_a_time(reports_);
  const std::string source = name + (is_program ? ".program.csv" : ".h5");
  struct stat found {};
  if (!has_file(folder_, source, found))
    throw InputError("run", "name", name, "a run with a file " + source + ": it is written at the end");
  if (!folder_.can_be_written()) throw OutputError(words.back(), "this folder can only be read");
  run_to_end(words, "what is made of it");
  return words;
}

void Runs::run_to_end(const std::vector<std::string>& words, const char* what) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) throw InputError("run", what, std::strerror(errno), "a pipe");
  const Descriptor reading(ends[0]);
  int code = 0;
  {
    const Descriptor writing(ends[1]);  // who prints more than the pipe holds does not wait: the rest is lost
    code = run(words, writing.get(), "");
  }
  if (code == 0) return;
  std::string said = "\n";
  std::array<char, 4096> buffer{};
  if (const ssize_t count = ::read(reading.get(), buffer.data(), buffer.size()); count > 0)
    said.append(buffer.data(), static_cast<std::size_t>(count));
  throw InputError("run", what, find_message(said), "a recording that " + words[0] + " " + words[1] + " can read");
}

}  // namespace snug::workspace
