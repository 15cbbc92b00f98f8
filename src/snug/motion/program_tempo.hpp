// Tempo of a program: a comment of its file says how fast it was packed to be done.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace snug::motion {

/// "# tempo: 0.8\n", for the head of the file of a program that is done with FastSettings::tempo.
[[nodiscard]] std::string format_tempo(double tempo);
/// The tempo that the comments of a program's text tell; none: it is for a tool that lags behind. Throws InputError
/// with file and line for one that is no number from 0.1 to 1, for a second one, and for a comment that is meant as one
/// but misspelt ("# tmepo: 1", "# tempo = 1"). `name` stands for the file.
[[nodiscard]] std::optional<double> find_tempo(std::string_view text, std::string_view name);
[[nodiscard]] std::optional<double> load_tempo(const std::filesystem::path& path);

}  // namespace snug::motion
