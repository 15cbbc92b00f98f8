// RecordingsPage: the report, one HTML file: the page that viewer/ builds with recordings inside.
#include "snug/report/recordings_page.hpp"

#include "snug/core/base64.hpp"
#include "snug/core/input_error.hpp"
#include "snug/report/escape.hpp"

namespace snug::report {

std::string assemble_page(std::string_view page, std::span<const PageRecording> recordings) {
  const std::size_t at = page.find(kRecordingsMark);
  if (at == std::string_view::npos || page.find(kRecordingsMark, at + 1) != std::string_view::npos) {
    throw InputError("page", std::string(kRecordingsMark), at == std::string_view::npos ? "none" : "several",
                     "exactly one in the page that viewer/ builds");
  }
  std::string out(page.substr(0, at));
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    out += "<script type=\"application/octet-stream;base64\" id=\"snug-recording-" + std::to_string(i) +
           "\" data-name=\"" + escape(recordings[i].name) + "\">" + base64(recordings[i].bytes) + "</script>\n";
  }
  out += page.substr(at + kRecordingsMark.size());
  return out;
}

}  // namespace snug::report
