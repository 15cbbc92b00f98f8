// Merge: chunk by chunk, so that memory does not grow with the study.
#include "snug/study/merge.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>
#include <map>
#include <unordered_set>
#include <utility>

#include "snug/core/csv_cell.hpp"
#include "snug/core/input_error.hpp"

namespace snug::study {
namespace {

constexpr std::size_t kMostBuffered = 1 << 20U;

bool is_number(const std::string& text, double& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty();
}

/// A text as CSV: numbers as they are, of others none that a spreadsheet would run; lists keep their commas.
std::string as_text(const std::string& text) {
  double number = 0.0;
  if (is_number(text, number)) return text;
  const std::size_t end = std::min(text.size(), text.find_first_of(",\""));
  std::string safe = csv_cell(text.substr(0, end));
  if (end == text.size()) return safe;
  for (const char c : text.substr(end)) {
    if (c == '"') safe += '"';  // twice is once
    safe += c == ',' || c == '"' ? std::string(1, c) : csv_cell("x" + std::string(1, c)).substr(1);
  }
  return '"' + safe + '"';
}

/// A cell as CSV.
std::string as_text(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return fmt::format("{}", *number);
  if (const auto* word = std::get_if<std::string>(&cell)) return as_text(*word);
  return "";
}

const Cell* find(const std::vector<std::pair<std::string, Cell>>& cells, const std::string& name) {
  const auto found = std::ranges::find(cells, name, [](const auto& value) { return value.first; });
  return found != cells.end() ? &found->second : nullptr;
}

const Cell* find(const RowResult& result, const ResultColumn& column) {
  return find(column.is_of_clock ? result.clock : result.values, column.name);
}

/// What a column is, as an attribute of its data set.
void describe(hid_t set, const char* kind) {
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, std::strlen(kind));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const hid_t attribute = H5Acreate2(set, "kind", type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, type, kind);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
}

/// One column of an HDF5 file while it is written: rows are appended in blocks.
class Column {
 public:
  /// `kind`: design, outcome, result or clock.
  Column(hid_t file, const std::string& name, bool is_text, hsize_t rows, const char* kind)
      : is_text_(is_text), rows_(rows) {
    type_ = is_text ? H5Tcopy(H5T_C_S1) : H5Tcopy(H5T_IEEE_F64LE);
    if (is_text) {
      H5Tset_size(type_, H5T_VARIABLE);
      H5Tset_cset(type_, H5T_CSET_UTF8);
    }
    const hid_t space = H5Screate_simple(1, &rows_, nullptr);
    std::string link = name;
    std::ranges::replace(link, '/', '|');  // a slash would be a group
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(how, false);  // the same rows, the same bytes, whenever they are merged
    set_ = H5Dcreate2(file, link.c_str(), type_, space, H5P_DEFAULT, how, H5P_DEFAULT);
    H5Pclose(how);
    H5Sclose(space);
    if (set_ < 0) throw OutputError(name, "HDF5 makes no such data set");
    describe(set_, kind);
  }
  Column(const Column&) = delete;
  Column& operator=(const Column&) = delete;
  Column(Column&& other) noexcept
      : is_text_(other.is_text_),
        rows_(other.rows_),
        written_(other.written_),
        set_(std::exchange(other.set_, -1)),
        type_(std::exchange(other.type_, -1)) {}
  ~Column() {
    if (set_ >= 0) H5Dclose(set_);
    if (type_ >= 0) H5Tclose(type_);
  }

  void add(const Cell* cell) {
    if (is_text_) {
      words_.push_back(cell != nullptr ? as_plain(*cell) : "");
    } else {
      const auto* number = cell != nullptr ? std::get_if<double>(cell) : nullptr;
      numbers_.push_back(number != nullptr ? *number : std::numeric_limits<double>::quiet_NaN());
    }
    if (words_.size() + numbers_.size() >= 4096) flush();
  }
  void flush() {
    const hsize_t count = is_text_ ? words_.size() : numbers_.size();
    if (count == 0) return;
    const hid_t memory = H5Screate_simple(1, &count, nullptr), space = H5Dget_space(set_);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, &written_, nullptr, &count, nullptr);
    std::vector<const char*> texts;
    for (const std::string& word : words_) texts.push_back(word.c_str());
    const herr_t status = H5Dwrite(set_, type_, memory, space, H5P_DEFAULT,
                                   is_text_ ? static_cast<const void*>(texts.data()) : numbers_.data());
    H5Sclose(space);
    H5Sclose(memory);
    if (status < 0) throw OutputError("HDF5", "a column cannot be written");
    written_ += count;
    words_.clear();
    numbers_.clear();
  }

 private:
  static std::string as_plain(const Cell& cell) {
    if (const auto* word = std::get_if<std::string>(&cell)) return *word;
    return as_text(cell);
  }

  bool is_text_;
  hsize_t rows_, written_ = 0;
  hid_t set_ = -1, type_ = -1;
  std::vector<std::string> words_;
  std::vector<double> numbers_;
};

/// Everything of a row in the order of the columns.
std::vector<std::pair<std::string, Cell>> fixed_cells(const Study& study, const RowResult& result) {
  const Row row = row_of(study, result.row);
  std::vector<std::pair<std::string, Cell>> cells = {{"row", static_cast<double>(row.index)},
                                                     {"point", static_cast<double>(row.point)},
                                                     {"repeat", static_cast<double>(row.repeat)},
                                                     {"row_seed", static_cast<double>(row.seed)}};
  for (std::size_t i = 0; i < study.factors.size(); ++i) {
    double number = 0.0;
    const std::string& text = row.values[i];
    cells.emplace_back(study.factors[i].name, is_number(text, number) ? Cell(number) : Cell(text));
  }
  cells.emplace_back("exit", static_cast<double>(result.exit_code));
  return cells;
}

/// Which columns hold words in any row.
std::map<std::string, bool> find_texts(const Study& study, const Folder& folder) {
  std::map<std::string, bool> texts;
  const auto look = [&](const std::string& name, const Cell& cell) {
    texts[name] = texts[name] || std::holds_alternative<std::string>(cell);
  };
  for_each_row(study, folder, [&](const RowResult& result) {
    for (const auto& [name, cell] : fixed_cells(study, result)) look(name, cell);
    for (const auto& [name, cell] : result.values) look("result." + name, cell);
    for (const auto& [name, cell] : result.clock) look("clock." + name, cell);
  });
  return texts;
}

}  // namespace

void for_each_row(const Study& study, const Folder& folder, const std::function<void(const RowResult&)>& take) {
  OneWorld world(folder.path().string());
  for (std::uint64_t chunk = 0; chunk < study.chunks(); ++chunk) {
    for (const auto& [row, result] : folder.read(chunk, &world)) take(result);
  }
}

Status status_of(const Study& study, const Folder& folder) {
  Status status;
  status.rows = study.rows();
  status.chunks = study.chunks();
  const auto size = static_cast<std::uint64_t>(study.chunk);
  for (std::uint64_t chunk = 0; chunk < status.chunks; ++chunk) {
    const auto rows = folder.read(chunk);
    status.done += rows.size();
    status.chunks_done += rows.size() == std::min(size, status.rows - chunk * size) ? 1 : 0;
    for (const auto& [row, result] : rows) {
      status.failed += result.exit_code != 0 ? 1 : 0;
      status.mean_seconds += result.seconds;
    }
  }
  if (status.done > 0) status.mean_seconds /= static_cast<double>(status.done);
  return status;
}

std::vector<ResultColumn> columns_of(const Study& study, const Folder& folder) {
  std::vector<ResultColumn> columns, of_clock;
  std::unordered_set<std::string> known, known_of_clock;
  for_each_row(study, folder, [&](const RowResult& result) {
    for (const auto& [name, cell] : result.values) {
      if (known.insert(name).second) columns.push_back({name, false});
    }
    for (const auto& [name, cell] : result.clock) {
      if (known_of_clock.insert(name).second) of_clock.push_back({name, true});
    }
  });
  columns.insert(columns.end(), of_clock.begin(), of_clock.end());
  return columns;
}

void write_csv(const Study& study, const Folder& folder, OutputFile file) {
  const std::vector<ResultColumn> columns = columns_of(study, folder);
  std::string text = "row,point,repeat,row_seed";
  for (const Factor& factor : study.factors) text += "," + csv_cell(factor.name);
  text += ",exit";
  for (const ResultColumn& column : columns) text += "," + csv_cell((column.is_of_clock ? "clock." : "") + column.name);
  text += ",error,inputs\n";
  for_each_row(study, folder, [&](const RowResult& result) {
    const Row row = row_of(study, result.row);
    text += fmt::format("{},{},{},{}", row.index, row.point, row.repeat, row.seed);
    for (const std::string& value : row.values) text += "," + as_text(value);
    text += fmt::format(",{}", result.exit_code);
    for (const ResultColumn& column : columns) {
      const Cell* const cell = find(result, column);
      text += "," + (cell != nullptr ? as_text(*cell) : std::string());
    }
    text += "," + as_text(result.error) + "," + result.inputs + "\n";
    if (text.size() < kMostBuffered) return;
    file.write(text);
    text.clear();
  });
  file.write(text);
  file.publish();
}

void write_hdf5(const Study& study, const Folder& folder, OutputFile file) {
  const std::vector<ResultColumn> names = columns_of(study, folder);
  const std::map<std::string, bool> texts = find_texts(study, folder);
  const hsize_t rows = status_of(study, folder).done;
  const auto is_text = [&](const std::string& name) { return texts.contains(name) && texts.at(name); };
  const hid_t h5 = H5Fcreate(file.location().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (h5 < 0) throw OutputError(file.path().string(), "HDF5 makes no such file");
  {
    std::vector<Column> columns;
    std::vector<std::string> fixed = {"row", "point", "repeat", "row_seed"};
    for (const Factor& factor : study.factors) fixed.push_back(factor.name);
    fixed.emplace_back("exit");
    for (const std::string& name : fixed)
      columns.emplace_back(h5, name, is_text(name), rows, name == "exit" ? "outcome" : "design");
    for (const ResultColumn& column : names) {
      const std::string name = (column.is_of_clock ? "clock." : "result.") + column.name;
      columns.emplace_back(h5, name, is_text(name), rows, column.is_of_clock ? "clock" : "result");
    }
    for (const char* name : {"error", "inputs"}) columns.emplace_back(h5, name, true, rows, "outcome");
    for_each_row(study, folder, [&](const RowResult& result) {
      std::size_t at = 0;
      for (const auto& [name, cell] : fixed_cells(study, result)) columns[at++].add(&cell);
      for (const ResultColumn& column : names) columns[at++].add(find(result, column));
      for (const std::string& text : {result.error, result.inputs}) {
        const Cell cell = text;
        columns[at++].add(&cell);
      }
    });
    for (Column& column : columns) column.flush();
  }
  if (H5Fclose(h5) < 0) throw OutputError(file.path().string(), "HDF5 cannot write it");
  file.publish();
}

void write_table(const Study& study, const Folder& folder, const std::string& path, OutputFile file) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".csv") return write_csv(study, folder, std::move(file));
  if (ending == ".h5" || ending == ".hdf5") return write_hdf5(study, folder, std::move(file));
  throw InputError("command line", "-o", "'" + path + "'", "a name that ends in .csv or .h5");
}

}  // namespace snug::study
