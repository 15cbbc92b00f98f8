// Folder: scenarios, items and logs of runs as plain files of one folder, for who must not reach beyond it.
#include "snug/workspace/folder.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/text.hpp"
#include "snug/model/items_file.hpp"
#include "snug/model/scenario.hpp"
#include "snug/workspace/arm_edit.hpp"

namespace snug::workspace {
namespace {

constexpr std::string_view kNameRule =
    "at most 100 letters, digits, '.', '_' and '-', a letter or digit first, ending in .yaml or .csv (arms: .urdf, "
    ".stl, .obj, .dae; files of runs: .jsonl, .txt, .h5, .program.csv, .html, .live, .operator, .png, .glb, .script, "
    ".ros.yaml, .mcap)";

bool is_letter_or_digit(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

/// `name` opened without following links; throws InputError unless it is a regular file of at most `most` bytes.
Descriptor open_file(int folder, const std::string& name, std::size_t most, struct stat& status) {
  Descriptor file(::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file.is_open()) {
    const bool is_link = errno == ELOOP;
    throw InputError(name, "", is_link ? "a symbolic link" : std::strerror(errno), "a file of the folder");
  }
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    throw InputError(name, "", "something that is no file", "a file of the folder");
  if (static_cast<std::uintmax_t>(status.st_size) > most)
    throw InputError(name, "", std::to_string(status.st_size) + " bytes", "at most " + std::to_string(most));
  return file;
}

/// The draft beside a file, held by this process alone. A draft that a killed process left is taken over.
Descriptor open_draft(int folder, const std::string& name, const std::string& draft) {
  Descriptor file(::openat(folder, draft.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666));
  if (!file.is_open() && (errno == ELOOP || errno == ENXIO || errno == EISDIR))  // a link, a pipe, a folder
    throw InputError(name, "", draft + ", which is no draft", "a folder without it");
  if (!file.is_open()) throw OutputError(name, std::strerror(errno));
  struct stat opened {
  }, named{};
  const bool is_ours = ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 && ::fstat(file.get(), &opened) == 0 &&
                       ::fstatat(folder, draft.c_str(), &named, AT_SYMLINK_NOFOLLOW) == 0 &&
                       opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
  if (!is_ours) throw InputError(name, "", "a file that is being written", "one writer at a time");
  if (!S_ISREG(opened.st_mode) || opened.st_nlink != 1)  // a hard link would be another file that is written to
    throw InputError(name, "", draft + ", which is no draft", "a folder without it");
  return file;
}

bool write_whole(int file, std::string_view text) {
  if (::ftruncate(file, 0) != 0) return false;
  while (!text.empty()) {
    const ssize_t count = ::write(file, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return ::fsync(file) == 0;
}

}  // namespace

FileKind kind_of_name(std::string_view name) {
  const bool is_plain =
      !name.empty() && name.size() <= kLongestName && is_letter_or_digit(name.front()) &&
      std::ranges::all_of(name, [](char c) { return is_letter_or_digit(c) || c == '.' || c == '_' || c == '-'; });
  static constexpr std::array<std::pair<std::string_view, FileKind>, 21> kEndings = {
      {{".ros.yaml", FileKind::Trajectory},
       {".yaml", FileKind::Scenario},
       {".program.csv", FileKind::Program},
       {".csv", FileKind::Items},
       {".jsonl", FileKind::Log},
       {".txt", FileKind::Words},
       {".h5", FileKind::Recording},
       {".html", FileKind::Report},
       {".live", FileKind::Live},
       {".operator", FileKind::Operator},
       {".png", FileKind::Picture},
       {".glb", FileKind::Scene},
       {".script", FileKind::Script},
       {".mcap", FileKind::Mcap},
       {".urdf", FileKind::Urdf},
       {".stl", FileKind::Mesh},
       {".obj", FileKind::Mesh},
       {".dae", FileKind::Mesh},
       {".STL", FileKind::Mesh},
       {".OBJ", FileKind::Mesh},
       {".DAE", FileKind::Mesh}}};
  for (const auto& [ending, kind] : kEndings) {
    if (is_plain && name.ends_with(ending)) return kind;
  }
  throw InputError("name", "", "'" + printable(name, kLongestName) + "'", std::string(kNameRule));
}

Folder::Folder(const std::filesystem::path& path)
    : path_(path), folder_(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (!folder_.is_open()) throw InputError(path.string(), "", std::strerror(errno), "a folder");
}

std::vector<Entry> Folder::list() const {
  // Opened anew: a descriptor has one place of reading for all who share it.
  const int again = ::openat(folder_.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, int (*)(DIR*)> stream(again < 0 ? nullptr : ::fdopendir(again), ::closedir);
  if (!stream) throw InputError(path_.string(), "", std::strerror(errno), "a folder that can be read");
  std::vector<Entry> entries;
  while (const dirent* one = ::readdir(stream.get())) {
    Entry entry{one->d_name, FileKind::Scenario, 0};
    try {
      entry.kind = kind_of_name(entry.name);
    } catch (const InputError&) {
      continue;  // other people's files
    }
    struct stat status {};
    if (::fstatat(folder_.get(), entry.name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode))
      continue;
    entry.bytes = static_cast<std::uintmax_t>(status.st_size);
    if (entries.size() == kMostEntries)
      throw InputError(path_.string(), "", "more files", "at most " + std::to_string(kMostEntries));
    entries.push_back(std::move(entry));
  }
  std::ranges::sort(entries, {}, &Entry::name);
  return entries;
}

std::string Folder::read_from(const std::string& name, std::uintmax_t offset, std::size_t most) const {
  const FileKind kind = kind_of_name(name);
  const bool is_written_here = kind == FileKind::Scenario || kind == FileKind::Items || kind == FileKind::Urdf;
  struct stat status {};
  const Descriptor file = open_file(folder_.get(), name, is_written_here ? kLargestUpload : kLargestRead, status);
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  std::string text(std::min(most, static_cast<std::size_t>(size - std::min(size, offset))), '\0');
  std::size_t done = 0;
  while (done < text.size()) {  // a log that grows meanwhile is read up to where it was
    const ssize_t count =
        ::pread(file.get(), text.data() + done, text.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(name, "", std::strerror(errno), "a file that can be read");
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  text.resize(done);
  return text;
}

bool Folder::can_be_written() const { return ::faccessat(folder_.get(), ".", W_OK | X_OK, AT_EACCESS) == 0; }

bool Folder::has(const std::string& name) const {
  (void)kind_of_name(name);
  struct stat status {};
  return ::fstatat(folder_.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(status.st_mode);
}

std::uintmax_t Folder::size(const std::string& name) const {
  (void)kind_of_name(name);
  struct stat status {};
  (void)open_file(folder_.get(), name, SIZE_MAX, status);
  return static_cast<std::uintmax_t>(status.st_size);
}

void Folder::check(const std::string& name, std::string_view text) const {
  const FileKind kind = kind_of_name(name);
  if (kind != FileKind::Scenario && kind != FileKind::Items && kind != FileKind::Urdf && kind != FileKind::Mesh)
    throw InputError(name, "", "a file that runs write",
                     "a scenario (.yaml), items (.csv), an arm (.urdf) or its mesh");
  const std::size_t largest = kind == FileKind::Mesh ? kLargestMesh : kLargestUpload;
  if (text.size() > largest)
    throw InputError(name, "", std::to_string(text.size()) + " bytes", "at most " + std::to_string(largest));
  if (kind == FileKind::Mesh) return;  // read with the arm that it is of
  if (kind == FileKind::Urdf) {
    (void)read_arm_facts(std::string(text), name);
    return;
  }
  if (kind == FileKind::Items) {
    (void)model::parse_orders_csv(text, name);
    return;
  }
  const std::string prefix = (path_ / "").string();
  try {
    (void)model::parse_scenario(text, prefix + name);  // with its folder: other files are looked for beside it
  } catch (const InputError& error) {
    const bool is_own = error.where.starts_with(prefix);
    throw InputError(is_own ? error.where.substr(prefix.size()) : error.where, error.key, error.got, error.expected);
  }
}

void Folder::write(const std::string& name, std::string_view text) const {
  check(name, text);
  struct stat before {};
  const bool is_there = ::fstatat(folder_.get(), name.c_str(), &before, AT_SYMLINK_NOFOLLOW) == 0;
  if (is_there && !S_ISREG(before.st_mode)) throw InputError(name, "", "something that is no file", "a free name");
  const std::string draft = name + ".snug-part";
  const Descriptor file = open_draft(folder_.get(), name, draft);
  const bool is_written = write_whole(file.get(), text) &&
                          (!is_there || ::fchmod(file.get(), before.st_mode & 0777U) == 0) &&
                          ::renameat(folder_.get(), draft.c_str(), folder_.get(), name.c_str()) == 0;
  if (is_written) {
    ::fsync(folder_.get());
    return;
  }
  const std::string why = std::strerror(errno);
  ::unlinkat(folder_.get(), draft.c_str(), 0);
  throw OutputError(name, why);
}

void Folder::remove(const std::string& name) const {
  (void)kind_of_name(name);
  struct stat status {};
  const bool is_file =
      ::fstatat(folder_.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(status.st_mode);
  if (!is_file) throw InputError(name, "", "no file", "a file of the folder");
  if (::unlinkat(folder_.get(), name.c_str(), 0) != 0) throw OutputError(name, std::strerror(errno));
}

void Folder::append(const std::string& name, const std::string& line) const {
  if (kind_of_name(name) != FileKind::Operator) throw InputError("name", "", name, "a file that ends in .operator");
  constexpr int kFlags = O_WRONLY | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const Descriptor file(::openat(folder_.get(), name.c_str(), kFlags));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    throw InputError(name, "", "no file that can be written", "a run that an operator can step into");
  std::string_view rest = line;
  while (!rest.empty()) {
    const ssize_t count = ::write(file.get(), rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw OutputError(name, std::strerror(errno));
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
}

Descriptor Folder::create(const std::string& name) const {
  (void)kind_of_name(name);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_APPEND | O_CLOEXEC;
  Descriptor file(::openat(folder_.get(), name.c_str(), kFlags, 0666));
  if (!file.is_open() && errno != EEXIST) throw OutputError(name, std::strerror(errno));
  if (!file.is_open()) throw InputError(name, "", std::strerror(errno), "a free name");
  return file;
}

}  // namespace snug::workspace
