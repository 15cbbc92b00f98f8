// Inputs: what a row is a function of besides its words, and whether the rows of a study are of one world.
#include "snug/study/inputs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/input_log.hpp"
#include "snug/study/internal/line.hpp"

namespace snug::study {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kExpected =
    "the files as they were, or another folder (--dir) for the changed study: rows of two versions do not mix";

std::string digits(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string told(const std::string& version) { return version.empty() ? "an older snug" : "snug " + version; }

}  // namespace

std::string Inputs::hash() const {
  std::set<std::pair<std::string, std::uint64_t>> all;
  for (const auto& [path, bytes] : files) all.emplace(std::filesystem::path(path).filename().string(), bytes);
  Hash hash;
  hash.add(version);
  for (const auto& [name, bytes] : all) {
    hash.add(std::string_view("\n"));
    hash.add(name);
    hash.add(bytes);
  }
  return digits(hash.value());
}

std::string format_inputs(const Inputs& inputs, std::uint64_t first_row) {
  Json files = Json::object();
  for (const auto& [path, bytes] : inputs.files) files[path] = digits(bytes);
  return internal::with_sum(
      Json{{"inputs", inputs.hash()}, {"row", first_row}, {"version", inputs.version}, {"files", files}});
}

std::optional<InputsLine> parse_inputs(const std::string& line) {
  if (!line.starts_with("{\"inputs\":")) return std::nullopt;
  const std::optional<Json> json = internal::without_sum(line);
  if (!json) return std::nullopt;
  try {
    InputsLine result;
    result.first_row = json->at("row").get<std::uint64_t>();
    result.inputs.version = json->at("version").get<std::string>();
    for (const auto& [path, bytes] : json->at("files").items())
      result.inputs.files[path] = std::stoull(bytes.get<std::string>(), nullptr, 16);
    if (json->at("inputs").get<std::string>() != result.inputs.hash()) return std::nullopt;
    return result;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  } catch (const std::logic_error&) {  // no number
    return std::nullopt;
  }
}

void OneWorld::add(const Inputs& inputs, std::uint64_t row) {
  if (unknown_) {
    throw InputError(folder_, fmt::format("row {}", row),
                     fmt::format("by {}, and row {} by an older snug", told(inputs.version), *unknown_), kExpected);
  }
  if (!version_) version_.emplace(inputs.version, row);
  if (version_->first != inputs.version) {
    throw InputError(
        folder_, fmt::format("row {}", row),
        fmt::format("by {}, and row {} by {}", told(inputs.version), version_->second, told(version_->first)),
        kExpected);
  }
  for (const auto& [path, hash] : inputs.files) {
    const Seen& seen = files_.try_emplace(path, Seen{hash, row}).first->second;
    if (seen.hash == hash) continue;
    throw InputError(folder_, fmt::format("row {}", row), fmt::format("with another '{}' than row {}", path, seen.row),
                     kExpected);
  }
}

void OneWorld::add_unknown(std::uint64_t row) {
  if (!unknown_) unknown_ = row;
  if (!version_) return;
  throw InputError(folder_, fmt::format("row {}", row),
                   fmt::format("by an older snug, and row {} by {}", version_->second, told(version_->first)),
                   kExpected);
}

void OneWorld::expect_now(const std::string& version) const {
  if (unknown_) {
    throw InputError(folder_, fmt::format("row {}", *unknown_), "by an older snug, which did not record what it read",
                     "another folder (--dir): rows of two programs do not mix");
  }
  if (version_ && version_->first != version) {
    throw InputError(folder_, fmt::format("row {}", version_->second),
                     fmt::format("by {}, and this is {}", told(version_->first), told(version)), kExpected);
  }
  for (const auto& [path, seen] : files_) {
    const std::uint64_t now = hash_of_file(path);
    if (now == seen.hash) continue;
    throw InputError(
        path, "",
        now == 0 ? "gone, and rows were done with it" : fmt::format("not the file that row {} was done with", seen.row),
        kExpected);
  }
}

}  // namespace snug::study
