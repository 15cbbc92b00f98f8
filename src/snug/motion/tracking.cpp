// Tracking: its words.
#include "snug/motion/tracking.hpp"

#include <fmt/format.h>

#include <array>

#include "snug/core/input_error.hpp"

namespace snug::motion {
namespace {

constexpr std::array<const char*, 3> kWords{"lagged", "exact", "fast"};  // in the order of the variant

}  // namespace

const char* name_of(const Tracking& tracking) { return kWords.at(tracking.index()); }

Tracking tracking_of(std::string_view word, const std::string& where) {
  if (word == kWords[0]) return LaggedTracking{};
  if (word == kWords[1]) return ExactTracking{};
  if (word == kWords[2]) return FastTracking{};
  throw InputError(where, "controller", fmt::format("'{}'", word), "lagged, exact or fast");
}

Tracking choose_tracking(const std::optional<std::string>& word, const std::optional<double>& tempo,
                         const Tracking& made_for, const std::string& where) {
  Tracking tracking = word ? tracking_of(*word, where) : tempo ? FastTracking{} : made_for;
  if (FastTracking* fast = std::get_if<FastTracking>(&tracking)) fast->tempo = tempo.value_or(tempo_of(made_for));
  return tracking;
}

}  // namespace snug::motion
