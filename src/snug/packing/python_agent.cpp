// Python agents: a process with two pipes.
#include "snug/packing/python_agent.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/packing/remote_agent.hpp"

extern char** environ;

namespace snug::packing {
namespace {

constexpr std::size_t kLongestAnswer = std::size_t{16} << 20U;

std::string interpreter() {
  if (const char* asked = std::getenv("SNUG_PYTHON"); asked != nullptr && *asked != '\0') return asked;
  return ::access("/usr/bin/python3", X_OK) == 0 ? "/usr/bin/python3" : "python3";
}

class Interpreter {
 public:
  Interpreter(std::string words, const std::string& script) : words_(std::move(words)) {
    const std::string program = interpreter();
    std::array<int, 2> in{}, out{};
    if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0)
      throw AgentError(words_ + ": no pipe: " + std::strerror(errno));
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, in[0], 0);
    ::posix_spawn_file_actions_adddup2(&actions, out[1], 1);
    std::array<std::string, 3> texts = {program, script, words_};
    std::array<char*, 4> argv = {texts[0].data(), texts[1].data(), texts[2].data(), nullptr};
    const int failed = ::posix_spawnp(&process_, program.c_str(), &actions, nullptr, argv.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(in[0]);
    ::close(out[1]);
    to_ = in[1];
    from_ = out[0];
    if (failed != 0) {
      process_ = -1;
      throw InputError("command line", "--agent", "no interpreter '" + program + "': " + std::strerror(failed),
                       "a Python 3, named by SNUG_PYTHON");
    }
  }
  ~Interpreter() {
    if (to_ >= 0) ::close(to_);  // the end of its input ends it
    if (from_ >= 0) ::close(from_);
    if (process_ > 0) ::waitpid(process_, nullptr, 0);
  }
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  void say(std::string line) {
    line += '\n';
    for (std::size_t at = 0; at < line.size();) {
      const ssize_t count = ::write(to_, line.data() + at, line.size() - at);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw AgentError(words_ + ": its interpreter has ended (see its messages)");
      at += static_cast<std::size_t>(count);
    }
  }
  std::string hear() {
    while (true) {
      const std::size_t end = heard_.find('\n');
      if (end != std::string::npos) {
        std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        return line;
      }
      std::array<char, 65536> buffer{};
      const ssize_t count = ::read(from_, buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw AgentError(words_ + ": its interpreter has ended (see its messages)");
      heard_.append(buffer.data(), static_cast<std::size_t>(count));
      if (heard_.size() > kLongestAnswer) throw AgentError(words_ + ": an answer of more than 16 MB");
    }
  }

 private:
  std::string words_;
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
  std::string heard_;
};

}  // namespace

bool is_python_agent(const std::string& words) { return words.find(':') != std::string::npos; }

Ask start_python_agent(const std::string& words, const std::filesystem::path& script) {
  ::signal(SIGPIPE, SIG_IGN);  // an interpreter that has ended is said, not died of
  // Shared, because what is returned can be copied.
  const auto process = std::make_shared<Interpreter>(words, script.string());
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
