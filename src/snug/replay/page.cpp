// Page: the report, one HTML file: the page that viewer/ builds with recordings inside.
#include "snug/replay/page.hpp"

#include <cstdint>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::replay {

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      triple = (triple << 8U) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k > bytes.size() ? '=' : kDigits[(triple >> (18U - 6U * k)) & 0x3FU]);
    }
  }
  return text;
}

std::string assemble_page(std::string_view page, std::span<const PageRecording> recordings) {
  const std::size_t at = page.find(kRecordingsMark);
  if (at == std::string_view::npos || page.find(kRecordingsMark, at + 1) != std::string_view::npos) {
    throw InputError("page", std::string(kRecordingsMark), at == std::string_view::npos ? "none" : "several",
                     "exactly one in the page that viewer/ builds");
  }
  std::string out(page.substr(0, at));
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    out += "<script type=\"application/octet-stream;base64\" id=\"snug-recording-" + std::to_string(i) +
           "\" data-name=\"" + escape_markup(recordings[i].name) + "\">" + base64(recordings[i].bytes) + "</script>\n";
  }
  out += page.substr(at + kRecordingsMark.size());
  return out;
}

}  // namespace snug::replay
