// Python agents: a process with two pipes.
#include "snug/packing/python_agent.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/python_interpreter.hpp"
#include "snug/packing/remote_agent.hpp"

namespace snug::packing {
namespace {

constexpr std::size_t kLongestAnswer = std::size_t{16} << 20U;

[[noreturn]] void be_interpreter(char* const* argv, int in, int out, int trouble, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // one that hangs does not outlive the program, however that ends
  if (::getppid() != parent) ::_exit(127);
  // It is ended by the end of its input, or by us: a Ctrl-C is for the program that asks.
  ::setpgid(0, 0);
  ::dup2(in, 0);
  ::dup2(out, 1);
  ::signal(SIGPIPE, SIG_DFL);
  ::execvp(argv[0], argv);
  const int reason = errno;
  (void)!::write(trouble, &reason, sizeof reason);  // closed by a program that starts
  ::_exit(127);
}

class Interpreter {
 public:
  Interpreter(std::string words, const std::string& script, AgentLimits limits)
      : words_(std::move(words)), limits_(std::move(limits)), patience_(limits_.patience) {
    const std::string program = python_interpreter();
    std::array<int, 2> in{}, out{}, trouble{};
    if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0 ||
        ::pipe2(trouble.data(), O_CLOEXEC) != 0)
      throw AgentError(words_ + ": no pipe: " + std::strerror(errno));
    std::array<std::string, 3> texts = {program, script, words_};
    std::array<char*, 4> argv = {texts[0].data(), texts[1].data(), texts[2].data(), nullptr};
    const pid_t self = ::getpid();
    process_ = ::fork();
    if (process_ == 0) be_interpreter(argv.data(), in[0], out[1], trouble[1], self);
    ::close(in[0]);
    ::close(out[1]);
    ::close(trouble[1]);
    to_ = in[1];
    from_ = out[0];
    if (process_ < 0) throw AgentError(words_ + ": no process: " + std::strerror(errno));
    int reason = 0;
    const bool has_failed = ::read(trouble[0], &reason, sizeof reason) == sizeof reason;
    ::close(trouble[0]);
    if (has_failed) {
      end();
      throw InputError("command line", "--agent", "no interpreter '" + program + "': " + std::strerror(reason),
                       "a Python 3, named by SNUG_PYTHON");
    }
    for (const int end : {to_, from_}) ::fcntl(end, F_SETFL, ::fcntl(end, F_GETFL) | O_NONBLOCK);
  }
  ~Interpreter() { end(); }
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  void say(std::string line) {
    line += '\n';
    const Clock::time_point deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(patience_);
    for (std::size_t at = 0; at < line.size();) {
      wait_for(to_, POLLOUT, deadline);
      const ssize_t count = ::write(to_, line.data() + at, line.size() - at);
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (count <= 0) fail_ended();
      at += static_cast<std::size_t>(count);
    }
  }
  std::string hear() {
    const Clock::time_point deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(patience_);
    while (true) {
      const std::size_t end = heard_.find('\n');
      if (end != std::string::npos) {
        std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        return line;
      }
      wait_for(from_, POLLIN, deadline);
      std::array<char, 65536> buffer{};
      const ssize_t count = ::read(from_, buffer.data(), buffer.size());
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (count <= 0) fail_ended();
      heard_.append(buffer.data(), static_cast<std::size_t>(count));
      if (heard_.size() > kLongestAnswer) throw AgentError(words_ + ": an answer of more than 16 MB");
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Throws AgentError when the time is over, or the user ends the program.
  void wait_for(int pipe, short event, Clock::time_point deadline) const {
    constexpr int kMoment = 100;  // ms, between looks whether the program was interrupted
    for (;;) {
      if ((limits_.is_interrupted && limits_.is_interrupted()))
        throw AgentError(words_ + ": interrupted before it answered");
      if (Clock::now() >= deadline)
        throw AgentError(fmt::format("{}: no answer within {} s (--agent-timeout)", words_, patience_.count()));
      pollfd waiting = {pipe, event, 0};
      if (::poll(&waiting, 1, kMoment) > 0) return;
    }
  }

  [[noreturn]] void fail_ended() {
    throw AgentError(words_ + ": its interpreter '" + python_interpreter() + "' has ended (see its messages)");
  }

  /// It is asked to end by the end of its input, then told, then made to.
  void end() {
    for (int* pipe : {&to_, &from_}) {
      if (*pipe >= 0) ::close(std::exchange(*pipe, -1));
    }
    if (process_ <= 0) return;
    constexpr int kMoments = 50;  // of 20 ms
    for (const int signal : {0, SIGTERM, SIGKILL}) {
      if (signal != 0) ::kill(-process_, signal);
      if (signal != 0) ::kill(process_, signal);
      for (int i = 0; i < kMoments || signal == SIGKILL; ++i) {
        if (::waitpid(process_, nullptr, WNOHANG) != 0) return;
        if (signal == 0 && (limits_.is_interrupted && limits_.is_interrupted())) break;
        ::usleep(20'000);
      }
    }
  }

  std::string words_;
  AgentLimits limits_;
  std::chrono::duration<double> patience_;
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
  std::string heard_;
};

}  // namespace

bool is_python_agent(const std::string& words) { return words.find(':') != std::string::npos; }

Ask start_python_agent(const std::string& words, const std::filesystem::path& script, const AgentLimits& limits) {
  ::signal(SIGPIPE, SIG_IGN);  // an interpreter that has ended is said, not died of
  // Shared, because what is returned can be copied.
  const auto process = std::make_shared<Interpreter>(words, script.string(), limits);
  const nlohmann::json first = nlohmann::json::parse(process->hear(), nullptr, false);
  if (!first.is_object() || !first.contains("ready")) {
    const bool has_reason = first.is_object() && first.contains("error") && first["error"].is_string();
    throw InputError("command line", "--agent",
                     "'" + words + "'" + (has_reason ? ": " + first["error"].get<std::string>() : ""),
                     "module:Class, a module that Python finds from this folder and a class with decide()");
  }
  return [process](const std::string& line) {
    process->say(line);
    return process->hear();
  };
}

}  // namespace snug::packing
