// Tables: lines of JSON with a sum, appended in one write each.
#include "snug/study/table.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/core/file_lock.hpp"
#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"

namespace snug::study {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::string_view kSum = ",\"sum\":\"";
constexpr const char* kCopy = "study.yaml";
constexpr std::size_t kMostColumns = 1000;

bool tells_of_a_clock(std::string_view name) {
  for (const std::string_view word : {"seconds", "wall", "real_time"}) {
    if (name.find(word) != std::string_view::npos) return true;
  }
  return false;
}

Cell as_cell(const Json& json) {
  if (json.is_boolean()) return json.get<bool>() ? 1.0 : 0.0;
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_structured()) return json.dump();  // only where a study names it
  return {};
}

void flatten(const Json& json, const std::string& prefix, std::vector<std::pair<std::string, Cell>>& values) {
  for (const auto& [key, value] : json.items()) {
    if (tells_of_a_clock(key) || values.size() >= kMostColumns) continue;
    if (value.is_object()) {
      flatten(value, prefix + key + ".", values);
    } else if (!value.is_array() && !value.is_null()) {
      values.emplace_back(prefix + key, as_cell(value));
    }
  }
}

/// "monte_carlo.items.0.succeeded"; keys themselves may hold dots.
const Json* find(const Json& json, const std::string& path) {
  if (json.is_object() && json.contains(path)) return &json[path];
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
    const std::string first = path.substr(0, dot), rest = path.substr(dot + 1);
    if (json.is_object() && json.contains(first)) {
      if (const Json* found = find(json[first], rest)) return found;
    }
    if (json.is_array() && !first.empty() && first.find_first_not_of("0123456789") == std::string::npos &&
        first.size() < 7 && std::stoul(first) < json.size()) {
      if (const Json* found = find(json[std::stoul(first)], rest)) return found;
    }
  }
  if (json.is_array() && !path.empty() && path.find_first_not_of("0123456789") == std::string::npos &&
      path.size() < 7 && std::stoul(path) < json.size())
    return &json[std::stoul(path)];
  return nullptr;
}

std::string sum_of(std::string_view text) {
  Hash hash;
  hash.add(text);
  return fmt::format("{:016x}", hash.value());
}

}  // namespace

std::vector<std::pair<std::string, Cell>> values_of(const Study& study, const std::string& text) {
  std::vector<std::pair<std::string, Cell>> values;
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return values;
  if (study.outputs.empty()) {
    if (json.is_object()) flatten(json, "", values);
    return values;
  }
  for (const Output& output : study.outputs) {
    const Json* found = find(json, output.name);
    values.emplace_back(output.name, found != nullptr ? as_cell(*found) : Cell{});
  }
  return values;
}

std::string format_line(const RowResult& result) {
  Json values = Json::object();
  for (const auto& [name, value] : result.values) {
    if (const auto* number = std::get_if<double>(&value)) {
      values[name] = *number;
    } else if (const auto* word = std::get_if<std::string>(&value)) {
      values[name] = *word;
    } else {
      values[name] = nullptr;
    }
  }
  const Json json{{"row", result.row},
                  {"exit", result.exit_code},
                  {"seconds", result.seconds},
                  {"error", result.error},
                  {"values", values}};
  std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  line.pop_back();
  return line + std::string(kSum) + sum_of(line) + "\"}\n";
}

std::optional<RowResult> parse_line(const std::string& line) {
  const std::size_t sum = line.rfind(kSum);
  if (sum == std::string::npos || line.substr(sum + kSum.size()) != sum_of(line.substr(0, sum)) + "\"}")
    return std::nullopt;
  const Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  try {
    RowResult result;
    result.row = json.at("row").get<std::uint64_t>();
    result.exit_code = json.at("exit").get<int>();
    result.seconds = json.at("seconds").get<double>();
    result.error = json.at("error").get<std::string>();
    for (const auto& [name, value] : json.at("values").items()) result.values.emplace_back(name, as_cell(value));
    return result;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // the sum is right, but somebody else's
  }
}

Folder::Folder(const Study& study, std::filesystem::path path, bool may_make) : study_(study), path_(std::move(path)) {
  std::error_code error;
  const std::filesystem::path copy = path_ / kCopy;
  if (!std::filesystem::exists(copy, error)) {
    if (!may_make) throw InputError(path_.string(), "", "no such study", "the folder of a study that was begun");
    const bool is_begun = std::filesystem::exists(copy.string() + ".snug-part", error);  // by another, at this moment
    if (!is_begun && std::filesystem::exists(path_, error) && !std::filesystem::is_empty(path_, error))
      throw InputError(path_.string(), "", "a folder with other things", "a folder of its own for the study");
    has_made_folder_ = std::filesystem::create_directories(path_, error);
    if (error) throw InputError(path_.string(), "", error.message(), "a folder that can be made");
    try {
      write_file(OutputFile(copy), study.text);
      has_begun_ = true;
    } catch (const InputError&) {  // begun by several at once: one of them writes it
      for (int i = 0; i < 100 && !std::filesystem::exists(copy, error); ++i) ::usleep(50'000);
    }
  }
  if (read_file(copy, "the file of a study") != study.text)
    throw InputError(study.source, "", "not the study that was begun in " + path_.string(),
                     "the same file, or another folder (--dir)");
}

std::filesystem::path Folder::table(std::uint64_t chunk) const {
  return path_ / fmt::format("chunk-{:06}.jsonl", chunk);
}

std::vector<std::filesystem::path> Folder::files() const {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(path_)) {
    const std::string name = entry.path().filename().string();
    if (name == kCopy || (name.starts_with("chunk-") && name.ends_with(".jsonl"))) files.push_back(entry.path());
  }
  return files;
}

std::map<std::uint64_t, RowResult> Folder::read(std::uint64_t chunk) const {
  std::map<std::uint64_t, RowResult> rows;
  std::ifstream file(table(chunk), std::ios::binary);
  const auto size = static_cast<std::uint64_t>(study_.chunk);
  for (std::string line; std::getline(file, line);) {
    std::optional<RowResult> result = parse_line(line);
    if (!result || result->row / size != chunk || result->row >= study_.rows()) continue;
    const auto [at, is_new] = rows.try_emplace(result->row, *result);
    if (is_new || at->second == *result) continue;
    throw InputError(table(chunk).string(), "row " + std::to_string(result->row), "two different results",
                     "a run that is a function of its words alone (exit codes " + std::to_string(at->second.exit_code) +
                         " and " + std::to_string(result->exit_code) + ")");
  }
  return rows;
}

void Folder::remove_if_new() const {
  if (!has_begun_) return;
  const std::vector<std::filesystem::path> all = files();
  std::vector<TableWriter> locks;
  for (const std::filesystem::path& file : all) {
    if (file.filename() == kCopy) continue;
    std::optional<TableWriter> lock = TableWriter::open(file);
    if (!lock) return;
    locks.push_back(std::move(*lock));
  }
  std::error_code ignored;  // what stays is found by who begins the study again
  for (const std::filesystem::path& file : all) std::filesystem::remove(file, ignored);
  if (has_made_folder_) std::filesystem::remove(path_, ignored);
}

TableWriter::TableWriter(TableWriter&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}
TableWriter& TableWriter::operator=(TableWriter&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  return *this;
}
TableWriter::~TableWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<TableWriter> TableWriter::open(const std::filesystem::path& path) {
  TableWriter writer;
  writer.path_ = path;
  writer.descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (writer.descriptor_ < 0) throw OutputError(path.string(), std::strerror(errno));
  if (!try_lock(writer.descriptor_, LockByte::Writer, LockKind::Exclusive)) return std::nullopt;
  // What a kill cut short ends here.
  const off_t end = ::lseek(writer.descriptor_, 0, SEEK_END);
  char last = '\n';
  if (end > 0 && ::pread(writer.descriptor_, &last, 1, end - 1) == 1 && last != '\n') {
    if (::write(writer.descriptor_, "\n", 1) != 1) throw OutputError(path.string(), std::strerror(errno));
  }
  return writer;
}

void TableWriter::append(const RowResult& result) {
  const std::string line = format_line(result);
  ssize_t written = 0;
  do {
    written = ::write(descriptor_, line.data(), line.size());
  } while (written < 0 && errno == EINTR);
  if (written != static_cast<ssize_t>(line.size()))
    throw OutputError(path_.string(), written < 0 ? std::strerror(errno) : "the disk is full");
}

void TableWriter::sync() {
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    throw OutputError(path_.string(), std::strerror(errno));
}

}  // namespace snug::study
