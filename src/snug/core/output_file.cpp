// OutputFile: a file that is written whole or not at all, by one writer at a time.
#include "snug/core/output_file.hpp"

#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/descriptor.hpp"
#include "snug/core/file_lock.hpp"
#include "snug/core/follow_links.hpp"
#include "snug/core/input_error.hpp"

namespace snug {
namespace {

constexpr const char* kDraftSuffix = ".snug-part";
constexpr const char* kNextSuffix = ".snug-next";  ///< of a draft or file that is about to be replaced
constexpr int kEnding[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

/// Paths of drafts for the handler of signals, which may neither lock nor allocate. Beyond so many at a time (no verb
/// has them) a draft may be left behind. Busy: a thread creates, moves or removes the draft; that thread holds the
/// signals back, so a handler in another one can wait for it.
struct DraftSlot {
  enum State : int { Free, Busy, Ready };
  std::atomic<int> state{Free};
  std::array<char, PATH_MAX> path{};
};
std::array<DraftSlot, 16> g_drafts;
std::atomic<bool> g_is_ending{false};  ///< a handler runs

class Registration {
 public:
  Registration() = default;
  ~Registration() { set(DraftSlot::Free); }
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  /// A busy one.
  void take(const std::string& path) {
    for (DraftSlot& slot : g_drafts) {
      int free = DraftSlot::Free;
      if (path.size() >= slot.path.size() || !slot.state.compare_exchange_strong(free, DraftSlot::Busy)) continue;
      std::memcpy(slot.path.data(), path.c_str(), path.size() + 1);
      slot_ = &slot;
      break;
    }
    if (!g_is_ending) return;  // else the handler may have passed the slot
    set(DraftSlot::Free);
    while (true) ::pause();  // the program ends
  }
  void set(DraftSlot::State state) {
    if (slot_ != nullptr) slot_->state = state;
    if (state == DraftSlot::Free) slot_ = nullptr;
  }

 private:
  DraftSlot* slot_ = nullptr;
};

void remove_drafts(int signal) {
  constexpr timespec kMoment{0, 1'000'000};
  constexpr int kMoments = 1000;  // a file system that does not answer keeps nobody from ending the program
  g_is_ending = true;
  for (const DraftSlot& slot : g_drafts) {
    for (int i = 0; i < kMoments && slot.state == DraftSlot::Busy; ++i) ::nanosleep(&kMoment, nullptr);
    if (slot.state == DraftSlot::Ready) ::unlink(slot.path.data());
  }
  ::signal(signal, SIG_DFL);
  sigset_t own;
  ::sigemptyset(&own);
  ::sigaddset(&own, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &own, nullptr);
  ::raise(signal);  // now it ends the program
}

/// Holds back the signals that remove drafts from this thread, while it is busy with one.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t held;
    ::sigemptyset(&held);
    for (const int signal : kEnding) ::sigaddset(&held, signal);
    ::pthread_sigmask(SIG_BLOCK, &held, &before_);
  }
  /// Where the handler runs in another thread it does not return: a thread that went on could write a file anew that is
  /// removed already.
  ~SignalsHeld() {
    while (g_is_ending) ::pause();
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_ = {};
};

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw InputError(path.empty() ? "a file to write" : path.string(), "", why, "a file that can be written");
}

[[noreturn]] void refuse_busy(const std::filesystem::path& path) {
  throw InputError(path.string(), "", "a file that another run is writing", "one that nobody else writes");
}

/// Is `path` itself, not what it links to, the open file?
bool names_file(const std::filesystem::path& path, int descriptor) {
  struct stat named = {}, open = {};
  return ::lstat(path.c_str(), &named) == 0 && ::fstat(descriptor, &open) == 0 && named.st_dev == open.st_dev &&
         named.st_ino == open.st_ino;
}

/// Creates and locks the draft. The lock is on the draft's own inode and goes where publish() moves it; a draft
/// that nobody has locked was left by a killed process. Never opens what it did not create for writing: in a folder
/// of others the name may be a link to something precious.
Descriptor create_draft(const std::filesystem::path& path, const std::filesystem::path& draft) {
  for (;;) {
    Descriptor file(::open(draft.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (file.is_open()) {
      if (try_lock(file.get(), LockByte::Writer, LockKind::Exclusive) && names_file(draft, file.get())) return file;
      continue;  // somebody took it for left over before it was locked
    }
    if (errno != EEXIST) refuse(path, std::strerror(errno));
    const Descriptor other(::open(draft.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!other.is_open() && errno == ENOENT) continue;
    if (!other.is_open()) refuse(draft, std::strerror(errno));
    if (!try_lock(other.get(), LockByte::Writer, LockKind::Exclusive)) refuse_busy(path);
    if (names_file(draft, other.get()) && ::unlink(draft.c_str()) != 0) refuse(draft, std::strerror(errno));
  }
}

/// The draft's name and its open, locked file; removed with the object unless it was moved to its place.
class Draft {
 public:
  Draft(const std::filesystem::path& path, std::filesystem::path location) : location_(std::move(location)) {
    const SignalsHeld held;
    registration_.take(location_.string());
    descriptor_ = create_draft(path, location_);
    registration_.set(DraftSlot::Ready);
  }
  ~Draft() {
    const SignalsHeld held;
    registration_.set(DraftSlot::Busy);
    if (!is_moved_ && names_file(location_, descriptor_.get())) ::unlink(location_.c_str());
    registration_.set(DraftSlot::Free);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// False when the system does not let us; errno tells why.
  [[nodiscard]] bool move_to(const std::filesystem::path& place) {
    if (!names_file(location_, descriptor_.get())) {
      errno = ESTALE;  // removed, or replaced where the file system knows no locks
      return false;
    }
    const SignalsHeld held;
    registration_.set(DraftSlot::Busy);
    const bool has_moved = ::rename(location_.c_str(), place.c_str()) == 0;
    registration_.set(has_moved ? DraftSlot::Free : DraftSlot::Ready);
    if (!has_moved) return false;
    location_ = place;
    is_moved_ = true;
    return true;
  }
  /// The bytes in a new file that takes the place of this one, locked like it. False: errno tells why.
  [[nodiscard]] bool replace(std::string_view bytes) {
    const std::string next = location_.string() + kNextSuffix;
    const SignalsHeld held;
    registration_.set(DraftSlot::Busy);
    const bool has_replaced = write_next(next, bytes);
    registration_.set(DraftSlot::Ready);
    return has_replaced;
  }
  [[nodiscard]] const std::filesystem::path& location() const { return location_; }
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  [[nodiscard]] bool is_moved() const { return is_moved_; }

 private:
  [[nodiscard]] bool write_next(const std::string& next, std::string_view bytes) {
    ::unlink(next.c_str());  // of a killed process: who has the lock here writes there
    Descriptor file(::open(next.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    struct stat now = {};
    bool is_good = file.is_open() && ::fstat(descriptor_.get(), &now) == 0;
    if (is_good && ::fchown(file.get(), now.st_uid, now.st_gid) != 0) errno = 0;  // only root may give files away
    is_good = is_good && ::fchmod(file.get(), now.st_mode & 07777U) == 0 &&
              try_lock(file.get(), LockByte::Writer, LockKind::Exclusive);
    while (is_good && !bytes.empty()) {
      const ssize_t count = ::write(file.get(), bytes.data(), bytes.size());
      is_good = count > 0 || (count < 0 && errno == EINTR);
      if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    is_good = is_good && ::rename(next.c_str(), location_.c_str()) == 0;
    if (!is_good) {
      const int why = errno;
      ::unlink(next.c_str());
      errno = why;
      return false;
    }
    descriptor_ = std::move(file);
    return true;
  }

  std::filesystem::path location_;
  Descriptor descriptor_;
  Registration registration_;
  bool is_moved_ = false;
};

/// The status of what is at `place`, if there is anything; throws InputError when it is not ours to replace.
std::optional<struct stat> look_at(const std::filesystem::path& path, const std::filesystem::path& place) {
  struct stat status = {};
  const bool exists = ::stat(place.c_str(), &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) refuse(path, "something that is not a regular file");
  if (!place.has_filename()) refuse(path, "no name of a file");
  if (place.extension() == kDraftSuffix) refuse(path, std::string("a name that ends in ") + kDraftSuffix);
  if (!exists) return std::nullopt;
  if (::access(place.c_str(), W_OK) != 0) refuse(path, std::strerror(errno));
  return status;
}

bool is_written_by_another(const std::filesystem::path& place) {
  Descriptor file(::open(place.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (!file.is_open()) file = Descriptor(::open(place.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
  return file.is_open() && is_locked(file.get(), LockByte::Writer);
}

}  // namespace

std::filesystem::path follow_links(const std::filesystem::path& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  std::filesystem::path place = path;
  std::error_code error;
  for (int i = 0; std::filesystem::is_symlink(place, error); ++i) {
    const std::filesystem::path next = std::filesystem::read_symlink(place, error);
    if (error || i == kMostLinks) refuse(path, std::strerror(ELOOP));
    place = next.is_absolute() ? next : place.parent_path() / next;
  }
  return place;
}

std::filesystem::path draft_of(const std::filesystem::path& path) { return follow_links(path).string() + kDraftSuffix; }

OutputError::OutputError(const std::string& where, const std::string& why)
    : std::runtime_error(where + ": could not be written: " + why) {}

struct OutputFile::Impl {
  explicit Impl(const std::filesystem::path& as_asked);
  ~Impl() {
    if (stream != nullptr) std::fclose(stream);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  /// Over a copy of the draft's descriptor.
  [[nodiscard]] bool open_stream();
  void fail() const { throw OutputError(path.string(), std::strerror(errno)); }

  std::filesystem::path path, place;
  std::optional<struct stat> old;  ///< what is to be replaced
  Draft draft;
  std::FILE* stream = nullptr;  ///< over a copy of the draft's descriptor
};

OutputFile::Impl::Impl(const std::filesystem::path& as_asked)
    : path(as_asked), place(follow_links(as_asked)), old(look_at(path, place)), draft(path, draft_of(place)) {
  // Behind the draft: a writer that has published its file holds the lock there, one that has not holds the draft.
  if (is_written_by_another(place)) refuse_busy(path);
  if (old) {
    (void)!::fchown(draft.descriptor(), old->st_uid, old->st_gid);  // only root may give files away
    if (::fchmod(draft.descriptor(), old->st_mode & 07777U) != 0) refuse(path, std::strerror(errno));
  }
  if (!open_stream()) refuse(path, std::strerror(errno));
}

bool OutputFile::Impl::open_stream() {
  if (stream != nullptr) std::fclose(stream);
  const int copy = ::fcntl(draft.descriptor(), F_DUPFD_CLOEXEC, 0);
  stream = copy >= 0 ? ::fdopen(copy, "wb") : nullptr;
  const int why = errno;
  if (stream == nullptr && copy >= 0) ::close(copy);
  errno = why;
  return stream != nullptr;
}

OutputFile::OutputFile(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}
OutputFile::~OutputFile() = default;
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;

const std::filesystem::path& OutputFile::path() const { return impl_->path; }
const std::filesystem::path& OutputFile::location() const { return impl_->draft.location(); }
bool OutputFile::replaces_file() const { return impl_->old.has_value(); }
bool OutputFile::is_published() const { return impl_->draft.is_moved(); }

void OutputFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), impl_->stream) != bytes.size()) impl_->fail();
}

void OutputFile::replace(std::string_view bytes) {
  if (!impl_->draft.replace(bytes) || !impl_->open_stream()) impl_->fail();
}

void OutputFile::publish() {
  SNUG_CHECK(!is_published(), "published once");
  if (std::fflush(impl_->stream) != 0 || ::fsync(impl_->draft.descriptor()) != 0) impl_->fail();
  if (!impl_->draft.move_to(impl_->place)) impl_->fail();
}

void remove_drafts_when_interrupted() {
  for (const int signal : kEnding) {
    struct sigaction before = {}, action = {};
    if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;  // nohup, background jobs
    action.sa_handler = remove_drafts;
    for (const int other : kEnding) ::sigaddset(&action.sa_mask, other);  // a second one does not come in between
    ::sigaction(signal, &action, nullptr);
  }
}

}  // namespace snug
