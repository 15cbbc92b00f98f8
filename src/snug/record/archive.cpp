// Archive: what its values mean, without the file.
#include "snug/record/archive.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "snug/record/internal/archive_layout.hpp"

namespace snug::record {

bool is_tracked(const PoseSample& sample) { return std::isfinite(sample.p.x()); }

PoseSample lost_pose() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  return {Vector3::Constant(kNaN), Quaternion(kNaN, kNaN, kNaN, kNaN)};
}

std::string_view find_remark(const ArchiveRecording& recording, std::string_view key) {
  for (const auto& [name, text] : recording.remarks)
    if (name == key) return text;
  return {};
}

std::string archive_name(std::string_view body) {
  std::string name(body);
  const bool is_numbered_box =
      name.size() > 3 && name.starts_with("BOX") && std::isdigit(static_cast<unsigned char>(name[3])) != 0;
  if (is_numbered_box) name.replace(0, 3, "Box");
  return name;
}

bool is_same_body(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

Archive load_archive(const std::filesystem::path& path) {
  const ArchiveReader reader(path);
  Archive archive;
  for (std::size_t i = 0; i < reader.size(); ++i) archive.recordings.push_back(reader.read(i));
  return archive;
}

void save_archive(OutputFile file, const Archive& archive) {
  ArchiveWriter writer(std::move(file));
  for (const ArchiveRecording& recording : archive.recordings) writer.add(recording);
  writer.close();
}

namespace internal {

void require_times(const std::vector<double>& times, const std::string& part, const Complain& complain) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]))
      return complain(part, "a time that is no number at index " + std::to_string(i), "seconds");
    if (i > 0 && !(times[i] > times[i - 1]))
      return complain(part,
                      std::to_string(times[i]) + " s at index " + std::to_string(i) + " after " +
                          std::to_string(times[i - 1]) + " s",
                      "times that grow");
  }
}

void require_frequency(const std::vector<double>& times, double frequency, const std::string& part,
                       const Complain& complain) {
  if (!(frequency > 0.0) || !std::isfinite(frequency))
    return complain(part, std::to_string(frequency), "a rate in Hz, above 0");
  if (times.size() < 2) return;
  const double found = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  if (std::abs(found - frequency) > 0.05 * frequency)
    complain(part, std::to_string(frequency) + " Hz, but times with " + std::to_string(found) + " Hz",
             "the rate of the times");
}

void require_length(std::size_t length, std::size_t times, const std::string& part, const Complain& complain) {
  if (length != times)
    complain(part, std::to_string(length) + " instants", std::to_string(times) + ", one for each time");
}

}  // namespace internal
}  // namespace snug::record
