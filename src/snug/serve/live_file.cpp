// LiveFile: frames of a run in a file that grows while it goes on, for who watches it from another process.
#include "snug/serve/live_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/serve/internal/live_form.hpp"

namespace snug::serve {
namespace {

constexpr std::size_t kFramesAPicture = 4;    ///< of 8 ms
constexpr std::size_t kPicturesAnEvent = 16;  ///< half a second: small enough to follow, large enough to deflate

}  // namespace

LiveFile::LiveFile(const std::filesystem::path& path, std::string name)
    : path_(path.string()),
      name_(std::move(name)),
      file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (!file_.is_open()) throw InputError(path_, "", std::strerror(errno), "a place for the frames that are watched");
}

void LiveFile::begin(const record::RecordingHeader& header) {
  header_ = header;
  batch_.emplace(header);
}

bool LiveFile::add(const record::Frame& frame) {
  if (frames_ == 0) write(internal::server_event("header", internal::header_data(name_, header_, frame)));
  if (frames_++ % kFramesAPicture != 0 || bytes_ >= kMaxLiveFileBytes) return true;
  batch_->add(frame);
  if (batch_->frames() >= kPicturesAnEvent) flush();
  return true;
}

void LiveFile::flush() {
  if (!batch_ || batch_->frames() == 0) return;
  write(internal::server_event("frames", internal::frames_data(*batch_, events_)));
  events_.clear();
}

void LiveFile::finish() {
  if (std::exchange(is_over_, true)) return;
  flush();
  const char* why = bytes_ >= kMaxLiveFileBytes ? "the run is too long to be watched to its end" : "";
  write(internal::server_event("end", std::string("{\"failure\":\"") + why + "\"}"));
}

void LiveFile::write(const std::string& text) {
  bytes_ += text.size();
  for (std::string_view rest = text; !rest.empty();) {
    const ssize_t written = ::write(file_.get(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw OutputError(path_, std::strerror(errno));
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace snug::serve
