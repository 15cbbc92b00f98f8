// Tempo of a program: a comment of its file says how fast it was packed to be done.
#include "snug/motion/program_tempo.hpp"

#include <fmt/format.h>

#include <charconv>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"

namespace snug::motion {
namespace {

constexpr std::string_view kKey = "tempo:";
constexpr double kLeast = 0.1;  ///< as FastSettings

}  // namespace

std::string format_tempo(double tempo) { return fmt::format("# {} {}\n", kKey, tempo); }

std::optional<double> find_tempo(std::string_view text, std::string_view name) {
  std::optional<double> found;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view row = trim(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!row.starts_with('#')) continue;
    row = trim(row.substr(1));
    if (!row.starts_with(kKey)) continue;
    row = trim(row.substr(kKey.size()));
    double tempo = 0.0;
    const auto [last, error] = std::from_chars(row.data(), row.data() + row.size(), tempo);
    const bool is_number = error == std::errc() && last == row.data() + row.size();
    if (found || !is_number || !(tempo >= kLeast && tempo <= 1.0)) {
      throw InputError(fmt::format("{}:{}", name, line), "tempo", fmt::format("'{}'", row),
                       found ? "one tempo" : fmt::format("a number from {} to 1", kLeast));
    }
    found = tempo;
  }
  return found;
}

std::optional<double> load_tempo(const std::filesystem::path& path) {
  return find_tempo(read_file(path, "a program file (CSV)"), path.string());
}

}  // namespace snug::motion
