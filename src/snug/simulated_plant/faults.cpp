// Faults: what goes wrong in a simulated plant because somebody asked for it: "drop@3,noseal@5".
#include "snug/simulated_plant/faults.hpp"

#include <array>
#include <charconv>

#include "snug/core/input_error.hpp"

namespace snug::simulated_plant {
namespace {

constexpr std::array kKinds{FaultKind::NoSeal, FaultKind::Drop,   FaultKind::Stop, FaultKind::Displace,
                            FaultKind::Push,   FaultKind::Object, FaultKind::Clear};
constexpr int kMostItems = 100'000;

Fault parse_fault(std::string_view word) {
  const std::size_t at = word.find('@');
  const std::string_view kind = word.substr(0, at);
  for (const FaultKind known : kKinds) {
    if (kind != name_of(known)) continue;
    Fault fault{known, 0};
    const std::string_view number = at == std::string_view::npos ? std::string_view() : word.substr(at + 1);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), fault.item);
    const bool is_whole = error == std::errc() && end == number.data() + number.size();
    if (!is_whole || fault.item < 1 || fault.item > kMostItems) {
      throw InputError("command line", "--fault", "'" + std::string(word) + "'",
                       "KIND@N with N the number of the item, from 1, such as drop@3");
    }
    return fault;
  }
  throw InputError("command line", "--fault", "'" + std::string(word) + "'",
                   "noseal, drop, stop, displace, push, object or clear, each with @N, separated by commas");
}

}  // namespace

const char* name_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::NoSeal:
      return "noseal";
    case FaultKind::Drop:
      return "drop";
    case FaultKind::Stop:
      return "stop";
    case FaultKind::Displace:
      return "displace";
    case FaultKind::Push:
      return "push";
    case FaultKind::Object:
      return "object";
    case FaultKind::Clear:
      return "clear";
  }
  return "";
}

std::vector<Fault> parse_faults(std::string_view text) {
  std::vector<Fault> faults;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    faults.push_back(parse_fault(text.substr(0, comma)));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
    if (text.empty()) faults.push_back(parse_fault(text));  // a comma at the end: refused
  }
  return faults;
}

}  // namespace snug::simulated_plant
