// Event logs: the events of a session as lines of JSON, written while it goes on, and read back.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/descriptor.hpp"
#include "snug/session/event.hpp"

namespace snug::session {

/// Takes events one by one, while they happen.
using EventSink = std::function<void(const SessionEvent&)>;

/// One line, without its end: {"event":"...", fields}.
[[nodiscard]] std::string format_event(const SessionEvent& one);
/// Throws InputError with `where:line` and the path of the key.
[[nodiscard]] SessionEvent parse_event(std::string_view text, const std::string& where, int line);

/// What fold() relies on: whoever reads a file of others has to hear where it breaks off. Kinds of events that fold()
/// makes nothing of may be left out.
class EventOrder {
 public:
  /// Throws InputError with `place` for an event that cannot come now, or an item that is not of the session.
  void add(const SessionEvent& one, const std::string& place);

 private:
  struct UnderWay {
    model::ItemIndex item;
    int sends = 0;
  };
  template <class Event>
  void check(const Event& event, const std::string& place) const;

  int items_ = -1;  ///< below 0: the session has not started
  std::vector<UnderWay> under_way_;
};

struct EventLog {
  std::vector<SessionEvent> events;
  bool is_whole = true;  ///< false: the last line is broken off, the session was killed; it is left out
};
/// Throws InputError with file and line for a line that it does not understand; a last line without its end is left
/// out.
[[nodiscard]] EventLog parse_log(std::string_view text, const std::string& name);
[[nodiscard]] EventLog load_log(const std::filesystem::path& path);

/// A file of JSON lines that has every event up to the last one, whatever ends the program.
class LogFile {
 public:
  /// The file is begun anew. Throws InputError where it cannot be written.
  explicit LogFile(const std::filesystem::path& path);
  /// One line, in the system's hands when this returns. Throws OutputError.
  void write(const SessionEvent& one);

 private:
  std::string path_;
  Descriptor file_;
};

}  // namespace snug::session
