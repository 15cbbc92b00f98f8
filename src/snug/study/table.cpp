// Tables: lines of JSON with a sum, appended in one write each.
#include "snug/study/table.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/core/descriptor.hpp"
#include "snug/core/file_lock.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/study/internal/line.hpp"

namespace snug::study {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kCopy = "study.yaml";
constexpr std::size_t kMostColumns = 1000;

constexpr const char* kOfClock = "of_clock";

bool tells_of_a_clock(std::string_view name) {
  for (const std::string_view word : {"seconds", "wall", "real_time"}) {
    if (name.find(word) != std::string_view::npos) return true;
  }
  return false;
}

/// Names of values that depend on a clock, as the result says; of those of other programs, and of older ones, by name.
class ClockNames {
 public:
  explicit ClockNames(const Json& json) {
    if (!json.is_object() || !json.contains(kOfClock) || !json[kOfClock].is_array()) return;
    names_.emplace();
    for (const Json& name : json[kOfClock]) {
      if (name.is_string()) names_->insert(name.get<std::string>());
    }
  }
  [[nodiscard]] bool has_key(const std::string& key) const {
    return names_ ? key == kOfClock || names_->contains(key) : tells_of_a_clock(key);
  }
  /// A path of keys with dots between.
  [[nodiscard]] bool has_path(const std::string& path) const {
    for (std::size_t begin = 0; begin <= path.size();) {
      const std::size_t end = std::min(path.size(), path.find('.', begin));
      if (has_key(path.substr(begin, end - begin))) return true;
      begin = end + 1;
    }
    return false;
  }

 private:
  std::optional<std::set<std::string>> names_;
};

Cell as_cell(const Json& json) {
  if (json.is_boolean()) return json.get<bool>() ? 1.0 : 0.0;
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_structured()) return json.dump();  // only where a study names it
  return {};
}

void flatten(const Json& json, const std::string& prefix, const ClockNames& clock,
             std::vector<std::pair<std::string, Cell>>& values) {
  for (const auto& [key, value] : json.items()) {
    if (clock.has_key(key) || values.size() >= kMostColumns) continue;
    if (value.is_object()) {
      flatten(value, prefix + key + ".", clock, values);
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

Json as_json(const std::vector<std::pair<std::string, Cell>>& cells) {
  Json values = Json::object();
  for (const auto& [name, value] : cells) {
    if (const auto* number = std::get_if<double>(&value)) {
      values[name] = *number;
    } else if (const auto* word = std::get_if<std::string>(&value)) {
      values[name] = *word;
    } else {
      values[name] = nullptr;
    }
  }
  return values;
}

void take_cells(const Json& values, std::vector<std::pair<std::string, Cell>>& cells) {
  for (const auto& [name, value] : values.items()) cells.emplace_back(name, as_cell(value));
}

/// A file of a table without following links: in a folder that others can write, a link would lead rows elsewhere, or
/// take them from there.
Descriptor open_table(const std::filesystem::path& path, int flags) {
  Descriptor file(::open(path.c_str(), flags | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666));
  if (!file.is_open() && errno == ENOENT && (flags & O_CREAT) == 0) return file;
  if (!file.is_open()) {
    if (errno == ELOOP) throw InputError(path.string(), "", "a link", "a table of the study itself");
    throw OutputError(path.string(), std::strerror(errno));
  }
  struct stat status = {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_nlink != 1) {
    throw InputError(path.string(), "", "a file with another name, or none that is regular",
                     "a table of the study itself");
  }
  return file;
}

/// A folder that somebody else owns, or everybody can write, is none for results.
void expect_own(const std::filesystem::path& path) {
  struct stat folder = {}, link = {};
  if (::stat(path.c_str(), &folder) != 0 || ::lstat(path.c_str(), &link) != 0) return;  // what follows will say so
  const uid_t user = ::geteuid();
  const bool is_own = user == 0 || (folder.st_uid == user && link.st_uid == user);
  if (is_own && (folder.st_mode & S_IWOTH) == 0) return;
  throw InputError(path.string(), "", is_own ? "a folder that everybody can write" : "a folder of somebody else",
                   "a folder of your own that others cannot write: who can, could lead the study's tables elsewhere");
}

/// Which of two results of one row counts, where they may both be right: one that passed the time limit says how busy
/// the machine was.
bool is_over_time(const RowResult& result) { return result.exit_code == -1 && result.error == kOverTime; }

}  // namespace

ResultValues values_of(const Study& study, const std::string& text) {
  ResultValues values;
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return values;
  const ClockNames clock(json);
  if (study.outputs.empty()) {
    if (json.is_object()) flatten(json, "", clock, values.values);
    return values;
  }
  for (const Output& output : study.outputs) {
    const Json* found = find(json, output.name);
    auto& column = clock.has_path(output.name) ? values.clock : values.values;
    column.emplace_back(output.name, found != nullptr ? as_cell(*found) : Cell{});
  }
  return values;
}

std::string format_line(const RowResult& result) {
  Json json{{"row", result.row},
            {"exit", result.exit_code},
            {"seconds", result.seconds},
            {"error", result.error},
            {"values", as_json(result.values)}};
  if (!result.clock.empty()) json["clock"] = as_json(result.clock);
  if (!result.inputs.empty()) json["of"] = result.inputs;
  return internal::with_sum(json);
}

std::optional<RowResult> parse_line(const std::string& line) {
  const std::optional<Json> json = internal::without_sum(line);
  if (!json) return std::nullopt;
  try {
    RowResult result;
    result.row = json->at("row").get<std::uint64_t>();
    result.exit_code = json->at("exit").get<int>();
    result.seconds = json->at("seconds").get<double>();
    result.error = json->at("error").get<std::string>();
    take_cells(json->at("values"), result.values);
    if (json->contains("clock")) take_cells(json->at("clock"), result.clock);
    if (json->contains("of")) result.inputs = json->at("of").get<std::string>();
    return result;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // the sum is right, but somebody else's
  }
}

Folder::Folder(const Study& study, std::filesystem::path path, bool may_make) : study_(study), path_(std::move(path)) {
  std::error_code error;
  const std::filesystem::path copy = path_ / kCopy;
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(copy, error)))
    throw InputError(copy.string(), "", "a link", "the file of a study itself");
  expect_own(path_);
  if (!std::filesystem::exists(copy, error)) {
    if (!may_make) throw InputError(path_.string(), "", "no such study", "the folder of a study that was begun");
    const bool is_begun = std::filesystem::exists(copy.string() + ".snug-part", error);  // by another, at this moment
    if (!is_begun && std::filesystem::exists(path_, error) && !std::filesystem::is_empty(path_, error))
      throw InputError(path_.string(), "", "a folder with other things", "a folder of its own for the study");
    has_made_folder_ = std::filesystem::create_directories(path_, error);
    if (error) throw InputError(path_.string(), "", error.message(), "a folder that can be made");
    expect_own(path_);
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

void Folder::for_each_line(std::uint64_t chunk, const std::function<bool(const std::string& line)>& take) const {
  const Descriptor file = open_table(table(chunk), O_RDONLY);
  if (!file.is_open()) return;
  std::string text;
  for (char buffer[65536];;) {
    const ssize_t count = ::read(file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(table(chunk).string(), "", std::strerror(errno), "a table of the study");
    if (count == 0) return;
    text.append(buffer, static_cast<std::size_t>(count));
    std::size_t begin = 0;
    for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
      if (!take(text.substr(begin, end - begin))) return;
      begin = end + 1;
    }
    text.erase(0, begin);
  }
}

std::map<std::uint64_t, RowResult> Folder::read(std::uint64_t chunk, OneWorld* world) const {
  std::map<std::uint64_t, RowResult> rows;
  const auto size = static_cast<std::uint64_t>(study_.chunk);
  for_each_line(chunk, [&](const std::string& line) {
    if (const std::optional<InputsLine> inputs = parse_inputs(line)) {
      if (world != nullptr) world->add(inputs->inputs, inputs->first_row);
      return true;
    }
    std::optional<RowResult> result = parse_line(line);
    if (!result || result->row / size != chunk || result->row >= study_.rows()) return true;
    if (world != nullptr && result->inputs.empty()) world->add_unknown(result->row);
    const auto [at, is_new] = rows.try_emplace(result->row, *result);
    if (is_new || at->second == *result || is_over_time(*result)) return true;
    if (is_over_time(at->second)) {
      at->second = std::move(*result);
      return true;
    }
    throw InputError(table(chunk).string(), "row " + std::to_string(result->row), "two different results",
                     "a run that depends on its command line alone (exit codes " +
                         std::to_string(at->second.exit_code) + " and " + std::to_string(result->exit_code) + ")");
  });
  return rows;
}

OneWorld Folder::read_world() const {
  OneWorld world(path_.string());
  for (std::uint64_t chunk = 0; chunk < study_.chunks(); ++chunk) {
    for_each_line(chunk, [&](const std::string& line) {
      if (const std::optional<InputsLine> inputs = parse_inputs(line)) {
        world.add(inputs->inputs, inputs->first_row);
        return true;
      }
      const std::optional<RowResult> result = parse_line(line);
      if (!result) return true;  // cut short, or somebody else's
      if (result->inputs.empty()) world.add_unknown(result->row);
      return false;
    });
  }
  return world;
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
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      known_(std::move(other.known_)) {}
TableWriter& TableWriter::operator=(TableWriter&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  std::swap(known_, other.known_);
  return *this;
}
TableWriter::~TableWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<TableWriter> TableWriter::open(const std::filesystem::path& path) {
  TableWriter writer;
  writer.path_ = path;
  Descriptor file = open_table(path, O_RDWR | O_CREAT | O_APPEND);
  if (!try_lock(file.get(), LockByte::Writer, LockKind::Exclusive)) return std::nullopt;
  writer.descriptor_ = ::fcntl(file.get(), F_DUPFD_CLOEXEC, 0);  // with its lock, which is that of the open file
  if (writer.descriptor_ < 0) throw OutputError(path.string(), std::strerror(errno));
  // What a kill cut short ends here.
  const off_t end = ::lseek(writer.descriptor_, 0, SEEK_END);
  char last = '\n';
  if (end > 0 && ::pread(writer.descriptor_, &last, 1, end - 1) == 1 && last != '\n') {
    if (::write(writer.descriptor_, "\n", 1) != 1) throw OutputError(path.string(), std::strerror(errno));
  }
  return writer;
}

void TableWriter::append(const RowResult& result, const Inputs& inputs) {
  std::string line;
  if (!result.inputs.empty() && known_.insert(result.inputs).second) line = format_inputs(inputs, result.row);
  line += format_line(result);
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
