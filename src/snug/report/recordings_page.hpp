// RecordingsPage: the report, one HTML file: the page that viewer/ builds with recordings inside.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace snug::report {

struct PageRecording {
  std::string name;   ///< file name, shown to people
  std::string bytes;  ///< replay form
};

/// Where the recordings go in the page that viewer/ builds.
inline constexpr std::string_view kRecordingsMark = "<!--snug:recordings-->";

/// `page` with the recordings in the place of its mark. Throws InputError when `page` does not have exactly one.
[[nodiscard]] std::string assemble_page(std::string_view page, std::span<const PageRecording> recordings);

}  // namespace snug::report
