// Frames that appear in a folder.
#include <fmt/format.h>
#include <sys/stat.h>

#include <chrono>
#include <map>
#include <memory>
#include <thread>
#include <tuple>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/text.hpp"
#include "snug/frames/internal/source_parts.hpp"

namespace snug::frames::internal {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kBetweenLooks(10);
constexpr std::size_t kMostFiles = 100'000;

/// Which file stands under a name, as far as the system tells: device, inode, size, time of its last change.
using Stamp = std::tuple<std::uint64_t, std::uint64_t, std::int64_t, std::int64_t, std::int64_t>;

class WatchedFolder {
 public:
  explicit WatchedFolder(const SourceSettings& settings)
      : settings_(settings), folder_(settings.from), request_(folder_ / "look.json") {}

  Expected<camera::Frame, std::string> look(std::uint64_t look, double time) {
    const std::map<std::string, Stamp> before = frames();
    ask(look, time);
    const Clock::time_point end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(settings_.patience));
    for (;;) {
      if (const auto path = find_new(before)) return read_frame(*path, settings_.hints);
      if (settings_.is_interrupted && settings_.is_interrupted()) return Unexpected<std::string>("interrupted");
      if (Clock::now() >= end) {
        return Unexpected<std::string>(fmt::format("no new frame (.png, .ply, .pcd, .h5) in {} within {} s",
                                                   printable(folder_.string(), kLongestMessage), settings_.patience));
      }
      std::this_thread::sleep_for(kBetweenLooks);
    }
  }

 private:
  void ask(std::uint64_t look, double time) {
    request_.replace(fmt::format("{{\"look\": {}, \"time_s\": {:.6f}}}\n", look, time));
    if (!request_.is_published()) request_.publish();
  }

  /// Frames that are there now.
  [[nodiscard]] std::map<std::string, Stamp> frames() const {
    std::map<std::string, Stamp> found;
    std::error_code error;
    std::size_t count = 0;
    for (fs::directory_iterator entry(folder_, error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
      if (++count > kMostFiles) break;
      const fs::path& path = entry->path();
      const std::string name = path.filename().string(), stem = path.stem().string();
      if (name.starts_with('.') || !is_frame_ending(path.extension().string())) continue;
      if (stem.ends_with("-intensity") || stem.ends_with("-labels")) continue;
      struct stat status = {};
      if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
      found[name] = {status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
    }
    return found;
  }

  /// Of several that are new the one that was written last.
  [[nodiscard]] std::optional<fs::path> find_new(const std::map<std::string, Stamp>& before) const {
    std::optional<fs::path> newest;
    std::pair<std::int64_t, std::int64_t> written;
    for (const auto& [name, stamp] : frames()) {
      const auto known = before.find(name);
      if (known != before.end() && known->second == stamp) continue;
      const std::pair time(std::get<3>(stamp), std::get<4>(stamp));
      if (newest && time < written) continue;
      newest = folder_ / name;
      written = time;
    }
    return newest;
  }

  SourceSettings settings_;
  fs::path folder_;
  OutputFile request_;
};

}  // namespace

camera::FrameSource make_folder_source(const SourceSettings& settings) {
  // Shared, because what is returned can be copied.
  const auto folder = std::make_shared<WatchedFolder>(settings);
  return [folder](std::uint64_t look, double time) { return folder->look(look, time); };
}

}  // namespace snug::frames::internal
