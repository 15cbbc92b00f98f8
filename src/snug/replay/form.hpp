// Form: the compact replay form: rounded, difference-coded columns behind a JSON header, deflated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace snug::replay {

/// The highest version of the form that decode_form reads and the one that FormWriter writes (docs/formats.md).
inline constexpr int kReplayVersion = 1;

enum class Encoding : std::uint8_t {
  Delta,  ///< difference to the value before it in the column
  Raw,    ///< the value itself
};

/// What a channel holds, without its values.
struct ChannelSpec {
  std::string name;
  std::vector<std::string> columns;
  std::string unit;
  std::string frame;
  double quantum = 1.0;  ///< > 0; values are whole multiples of it
  Encoding encoding = Encoding::Delta;
  bool operator==(const ChannelSpec&) const = default;
};

/// One column as it is being coded. Values that are not finite, or 2^50 quanta or more, count as missing.
class ColumnWriter {
 public:
  ColumnWriter(double quantum, Encoding encoding) : quantum_(quantum), encoding_(encoding) {}
  void put(double value);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  double quantum_;
  Encoding encoding_;
  std::int64_t last_ = 0;
  std::string bytes_;
};

/// One channel as it is being coded.
class ChannelWriter {
 public:
  explicit ChannelWriter(ChannelSpec spec);
  /// One value a column.
  void put(std::span<const double> row);
  void put(std::initializer_list<double> row) { put(std::span<const double>(row.begin(), row.size())); }

  [[nodiscard]] const ChannelSpec& spec() const { return spec_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const std::vector<ColumnWriter>& columns() const { return columns_; }

 private:
  ChannelSpec spec_;
  std::vector<ColumnWriter> columns_;
  std::size_t rows_ = 0;
};

/// The bytes of a form. `header_json` is an object without the key "channels", which is added.
[[nodiscard]] std::string encode_form(const std::string& header_json, std::span<const ChannelWriter> channels);

struct Channel {
  ChannelSpec spec;
  std::size_t rows = 0;
  std::vector<double> values;  ///< row by row; NaN where missing

  [[nodiscard]] double at(std::size_t row, std::size_t column) const {
    return values[row * spec.columns.size() + column];
  }
};

struct Form {
  std::string header_json;  ///< whole, with the channels
  std::vector<Channel> channels;
};

/// The channel of that name, or nullptr.
[[nodiscard]] const Channel* find_channel(const Form& form, std::string_view name);

/// Throws InputError naming `where` for bytes that are not a form of a version up to kReplayVersion, are damaged, or
/// inflate to more than `max_bytes`.
[[nodiscard]] Form decode_form(std::string_view bytes, const std::string& where, std::size_t max_bytes = 1U << 30U);

}  // namespace snug::replay
