// LiveFile: frames of a run in a file that grows while it goes on, for who watches it from another process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "snug/core/descriptor.hpp"
#include "snug/replay/frame_coder.hpp"
#include "snug/runs/recorder.hpp"

namespace snug::serve {

/// A file takes at most this; later frames are left out, and its end says so.
inline constexpr std::size_t kMaxLiveFileBytes = std::size_t{64} << 20U;

/// Server-sent events `header`, `frames`, `end` as those of LiveRun, one after the other, each written at once: whoever
/// reads up to the last empty line reads whole ones. What is in it depends on the run alone, not on how fast it goes.
class LiveFile final : public runs::RunObserver {
 public:
  /// Begins the file anew. Throws InputError where it cannot be written. `name`: of the run, for people.
  LiveFile(const std::filesystem::path& path, std::string name);

  void begin(const record::RecordingHeader& header) override;
  /// Takes a frame in four, as many pictures as are seen: 31 a second of the run. Never stops the run; throws
  /// OutputError when writing fails.
  bool add(const record::Frame& frame) override;
  void add(const record::Event& event) override { events_.push_back(event); }
  /// The run is over.
  void finish();

 private:
  void flush();
  void write(const std::string& text);

  std::string path_, name_;
  Descriptor file_;
  record::RecordingHeader header_;
  std::optional<replay::FrameCoder> batch_;
  std::vector<record::Event> events_;
  std::size_t bytes_ = 0, frames_ = 0;
  bool is_over_ = false;
};

}  // namespace snug::serve
