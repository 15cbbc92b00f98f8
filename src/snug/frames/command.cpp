// Frames that a command leaves.
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
#include <memory>
#include <utility>

#include "snug/core/descriptor.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/core/text.hpp"
#include "snug/frames/internal/source_parts.hpp"
#include "snug/frames/internal/words.hpp"

extern char** environ;

namespace snug::frames::internal {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kMoment = 10;              // ms, between looks whether it has ended
constexpr std::size_t kMostKept = 4096;  // bytes of what it says, the last ones
constexpr const char* kBaseName = "frame";

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (std::string& text : texts) all.push_back(text.data());
  all.push_back(nullptr);
  return all;
}

[[noreturn]] void be_command(const char* program, char* const* argv, char* const* environment, int in, int out,
                             int trouble, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // one that hangs does not outlive the program, however that ends
  if (::getppid() != parent) ::_exit(127);
  ::setpgid(0, 0);  // a Ctrl-C is for the program that asks: that ends the command, and what it has started
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(signal, SIG_DFL);
  ::dup2(in, 0);
  ::dup2(out, 1);
  ::dup2(out, 2);
  ::execve(program, argv, environment);
  const int reason = errno;
  (void)!::write(trouble, &reason, sizeof reason);  // closed by a program that starts
  ::_exit(127);
}

/// One run of the command, to its end.
class Child {
 public:
  /// Empty, or why it did not start.
  std::string start(const std::string& program, std::vector<std::string> words, std::vector<std::string> variables) {
    std::array<int, 2> out{}, trouble{};
    in_ = Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    if (!in_.is_open() || ::pipe2(out.data(), O_CLOEXEC) != 0) return std::strerror(errno);
    from_ = Descriptor(out[0]);
    Descriptor to(out[1]);
    if (::pipe2(trouble.data(), O_CLOEXEC) != 0) return std::strerror(errno);
    const Descriptor trouble_from(trouble[0]);
    Descriptor trouble_to(trouble[1]);
    for (char** one = environ; *one != nullptr; ++one) {
      if (!std::string_view(*one).starts_with("SNUG_FRAME=") && !std::string_view(*one).starts_with("SNUG_LOOK=") &&
          !std::string_view(*one).starts_with("SNUG_TIME="))
        variables.emplace_back(*one);
    }
    const std::vector<char*> argv = pointers(words), environment = pointers(variables);
    const pid_t self = ::getpid();
    process_ = ::fork();
    if (process_ == 0)
      be_command(program.c_str(), argv.data(), environment.data(), in_.get(), out[1], trouble[1], self);
    if (process_ < 0) return std::strerror(errno);
    ::setpgid(process_, process_);  // both do, so that it is done before either goes on
    to = Descriptor();
    trouble_to = Descriptor();
    ::fcntl(from_.get(), F_SETFL, ::fcntl(from_.get(), F_GETFL) | O_NONBLOCK);
    int reason = 0;
    if (::read(trouble_from.get(), &reason, sizeof reason) != sizeof reason) return {};
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
    return std::strerror(reason);
  }

  explicit Child(double grace) : grace_(grace) {}
  ~Child() { end(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Has it ended? Waits a moment for that.
  bool has_ended() {
    pollfd waiting = {from_.get(), POLLIN, 0};
    if (is_silent_) {
      ::usleep(kMoment * 1000);
    } else {
      (void)::poll(&waiting, 1, kMoment);
    }
    listen();
    return ::waitpid(process_, &status_, WNOHANG) == process_ && (process_ = -1, listen(), true);
  }

  /// The group is told to end, then made to.
  void end() {
    if (process_ <= 0) return;
    const Clock::time_point last = Clock::now() + std::chrono::duration_cast<Clock::duration>(grace_);
    ::kill(-process_, SIGTERM);
    const pid_t group = process_;
    while (Clock::now() < last) {
      if (has_ended()) break;
    }
    ::kill(-group, SIGKILL);  // what the command has started, too
    if (process_ > 0) ::waitpid(std::exchange(process_, -1), &status_, 0);
  }

  /// Empty, or how it ended and what it said last.
  [[nodiscard]] std::string find_trouble() const {
    if (WIFEXITED(status_) && WEXITSTATUS(status_) == 0) return {};
    const std::string how = WIFEXITED(status_) ? fmt::format("with exit code {}", WEXITSTATUS(status_))
                                               : fmt::format("by signal {}", WTERMSIG(status_));
    return "the command ended " + how + words();
  }
  /// What it said last, for people.
  [[nodiscard]] std::string words() const {
    const std::string_view said = trim(std::string_view(said_).substr(0, said_.find_last_not_of('\n') + 1));
    return said.empty() ? std::string() : ": " + printable_end(said, kLongestMessage);
  }

 private:
  void listen() {
    std::array<char, 4096> buffer{};
    // So much at a time that one who never stops talking does not keep us from looking at the clock.
    for (int i = 0; i < 16; ++i) {
      const ssize_t count = ::read(from_.get(), buffer.data(), buffer.size());
      if (count == 0) is_silent_ = true;
      if (count <= 0) return;
      said_.append(buffer.data(), static_cast<std::size_t>(count));
      if (said_.size() > kMostKept) said_.erase(0, said_.size() - kMostKept);
    }
  }

  std::chrono::duration<double> grace_;
  pid_t process_ = -1;
  Descriptor in_, from_;
  bool is_silent_ = false;  ///< nobody can say anything any more
  std::string said_;
  int status_ = 0;
};

class Command {
 public:
  explicit Command(const SourceSettings& settings)
      : settings_(settings), words_(split_command(settings.from)), program_(find_program(words_.front())) {
    if (!program_.empty()) return;
    throw InputError(
        "command line", "--frames", "'" + printable(settings.from, kLongestMessage) + "'",
        "a folder that exists, or a command: no program '" + printable(words_.front(), 120) + "' can be run");
  }

  Expected<camera::Frame, std::string> look(std::uint64_t look, double time) {
    folder_.empty();
    const std::string frame = (folder_.path() / kBaseName).string();
    Child child(settings_.grace);
    const std::string why =
        child.start(program_, fill_in(words_, frame, look, time),
                    {"SNUG_FRAME=" + frame, fmt::format("SNUG_LOOK={}", look), fmt::format("SNUG_TIME={:.6f}", time)});
    if (!why.empty()) return Unexpected<std::string>(program_ + ": " + why);
    std::string trouble = wait(child);
    if (trouble.empty()) trouble = child.find_trouble();
    if (!trouble.empty()) return Unexpected<std::string>(std::move(trouble));
    return take(child);
  }

 private:
  /// Empty, or why it was ended.
  std::string wait(Child& child) const {
    const Clock::time_point end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(settings_.patience));
    while (!child.has_ended()) {
      if (settings_.is_interrupted && settings_.is_interrupted()) {
        child.end();
        return "interrupted";
      }
      if (Clock::now() < end) continue;
      child.end();
      return fmt::format("the command did not end within {} s", settings_.patience) + child.words();
    }
    return {};
  }

  Expected<camera::Frame, std::string> take(const Child& child) const {
    std::optional<fs::path> found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_.path(), error)) {
      if (entry.path().stem() != kBaseName || !is_frame_ending(entry.path().extension().string())) continue;
      if (found) {
        return Unexpected<std::string>("the command left two frames: " + found->filename().string() + " and " +
                                       entry.path().filename().string());
      }
      found = entry.path();
    }
    if (found) return read_frame(*found, settings_.hints);
    return Unexpected<std::string>(
        "the command ended with exit code 0 but wrote no frame: {frame}.png, .ply, .pcd or .h5" + child.words());
  }

  SourceSettings settings_;
  std::vector<std::string> words_;
  std::string program_;
  TemporaryFolder folder_{"snug-frames"};
};

}  // namespace

camera::FrameSource make_command_source(const SourceSettings& settings) {
  // Shared, because what is returned can be copied.
  const auto command = std::make_shared<Command>(settings);
  return [command](std::uint64_t look, double time) { return command->look(look, time); };
}

}  // namespace snug::frames::internal
