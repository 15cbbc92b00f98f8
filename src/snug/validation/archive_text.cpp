// What is in an archive of measurements, as text and as JSON.
#include "snug/validation/archive_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace snug::validation {
namespace {

using Json = nlohmann::ordered_json;
using record::ArchiveRecording;

Json times_as_json(const std::vector<double>& times) {
  if (times.size() < 2) return {{"samples", times.size()}};
  const double duration = times.back() - times.front();
  return {{"samples", times.size()},
          {"start_s", times.front()},
          {"duration_s", duration},
          {"rate_Hz", static_cast<double>(times.size() - 1) / duration}};
}

double percent_tracked(const record::BodyTrack& track) {
  if (track.poses.empty()) return 0.0;
  const auto count = std::count_if(track.poses.begin(), track.poses.end(), record::is_tracked);
  return 100.0 * static_cast<double>(count) / static_cast<double>(track.poses.size());
}

Json recording_as_json(const ArchiveRecording& recording) {
  Json json = {{"name", recording.name}, {"remarks", Json::object()}, {"sources", Json::object()}};
  for (const auto& [key, text] : recording.remarks) json["remarks"][key] = text;
  const auto add = [&](const char* source, const std::vector<double>& times) {
    if (!times.empty()) json["sources"][source] = times_as_json(times);
  };
  add("motion_capture", recording.motion_capture.times);
  add("force_torque", recording.force_torque.times);
  add("robot", recording.robot.times);
  json["bodies"] = Json::array();
  for (const record::BodyTrack& track : recording.motion_capture.bodies)
    json["bodies"].push_back({{"name", track.name}, {"tracked_percent", percent_tracked(track)}});
  json["objects"] = Json::array();
  for (const record::ArchiveObject& object : recording.objects)
    json["objects"].push_back({{"name", object.name}, {"mass_kg", object.mass}});
  return json;
}

std::string recording_as_text(const ArchiveRecording& recording) {
  std::string text = recording.name + '\n';
  for (const auto& [key, value] : recording.remarks) text += fmt::format("  {}: {}\n", key, value);
  const auto add = [&](const char* source, const std::vector<double>& times) {
    if (times.size() < 2) return;
    const double duration = times.back() - times.front();
    text += fmt::format("  {:<15} {:>8} samples, {:.1f} Hz, {:.1f} s\n", source, times.size(),
                        static_cast<double>(times.size() - 1) / duration, duration);
  };
  add("motion capture", recording.motion_capture.times);
  add("force/torque", recording.force_torque.times);
  add("robot", recording.robot.times);
  for (const record::BodyTrack& track : recording.motion_capture.bodies)
    text += fmt::format("    {:<20} tracked {:5.1f} %\n", track.name, percent_tracked(track));
  return text;
}

}  // namespace

std::string contents_text(const record::ArchiveReader& reader) {
  std::string text;
  for (std::size_t i = 0; i < reader.size(); ++i) text += recording_as_text(reader.read(i));
  return text;
}

std::string contents_json(const record::ArchiveReader& reader) {
  Json json = {{"recordings", Json::array()}};
  for (std::size_t i = 0; i < reader.size(); ++i) json["recordings"].push_back(recording_as_json(reader.read(i)));
  return json.dump(2) + "\n";
}

std::string defects_json(const record::ArchiveReader& reader, const std::vector<InputError>& defects) {
  Json findings = Json::array();
  for (const InputError& error : defects)
    findings.push_back({{"path", error.key}, {"got", error.got}, {"expected", error.expected}});
  const Json json = {{"ok", findings.empty()}, {"recordings", reader.names()}, {"findings", findings}};
  return json.dump(2) + "\n";
}

}  // namespace snug::validation
