// StepLines: how many steps somebody allows who types lines.
#include "snug/served_cell/step_lines.hpp"

#include <unistd.h>

#include <charconv>

#include "snug/served_cell/server.hpp"

namespace snug::served_cell {

int StepLines::read(int descriptor) {
  char bytes[256];
  const ssize_t count = ::read(descriptor, bytes, sizeof bytes);
  if (count == 0) return -1;  // nobody will type any more
  if (count > 0) text_.append(bytes, static_cast<std::size_t>(count));
  int steps = 0;
  for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
    const std::string line = text_.substr(0, end);
    text_.erase(0, end + 1);
    if (line == "c") return -1;
    if (line == "r") return kReset;
    steps += steps_of(line);
  }
  if (text_.size() > 4096) text_.clear();
  return steps;
}

int StepLines::steps_of(const std::string& line) const {
  if (line.empty()) return 1;
  int steps = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), steps);
  if (error == std::errc() && end == line.data() + line.size() && steps > 0 && steps <= 1000000) return steps;
  complain_("'" + line + "': an empty line, a number of steps, c or r is expected");
  return 0;
}

}  // namespace snug::served_cell
