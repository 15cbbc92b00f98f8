// Form: the compact replay form: rounded, difference-coded columns behind a JSON header, deflated.
#include "snug/replay/form.hpp"

#include <zlib.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"

namespace snug::replay {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kMagic = "SNUGRPL1";
constexpr double kLargest = 0x1.0p50;  ///< quanta; differences then fit into a double without rounding
constexpr int kLongestNumber = 8;      ///< bytes

void put_number(std::string& bytes, std::uint64_t u) {
  while (u >= 0x80U) {
    bytes.push_back(static_cast<char>(static_cast<unsigned char>(u | 0x80U)));
    u >>= 7U;
  }
  bytes.push_back(static_cast<char>(static_cast<unsigned char>(u)));
}

std::uint64_t zigzag(std::int64_t d) {
  return (static_cast<std::uint64_t>(d) << 1U) ^ static_cast<std::uint64_t>(d >> 63);
}
std::int64_t unzigzag(std::uint64_t z) {
  return static_cast<std::int64_t>(z >> 1U) ^ -static_cast<std::int64_t>(z & 1U);
}

std::string deflated(const std::string& plain) {
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  std::string bytes(size, '\0');
  // Level 6 on purpose: 9 takes three times as long for one percent less.
  const int status = compress2(reinterpret_cast<Bytef*>(bytes.data()), &size,
                               reinterpret_cast<const Bytef*>(plain.data()), static_cast<uLong>(plain.size()), 6);
  SNUG_CHECK(status == Z_OK, "deflate into a buffer of the bound it asked for");
  bytes.resize(size);
  return bytes;
}

[[noreturn]] void refuse(const std::string& where, const std::string& got) {
  throw InputError(where, "", got, "a replay form written by snug");
}

std::string inflated(std::string_view bytes, const std::string& where, std::size_t max_bytes) {
  z_stream stream{};
  SNUG_CHECK(inflateInit(&stream) == Z_OK, "inflate starts");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string plain;
  int status = Z_OK;
  while (status == Z_OK && plain.size() <= max_bytes) {
    const std::size_t before = plain.size();
    plain.resize(before + (std::size_t{1} << 20U));
    stream.next_out = reinterpret_cast<Bytef*>(plain.data() + before);
    stream.avail_out = 1U << 20U;
    status = inflate(&stream, Z_NO_FLUSH);
    plain.resize(plain.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (plain.size() > max_bytes) refuse(where, "more than " + std::to_string(max_bytes) + " bytes of data");
  if (status != Z_STREAM_END) refuse(where, "damaged or cut short");
  return plain;
}

/// Reads the numbers of one channel, column after column.
class NumberReader {
 public:
  NumberReader(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  std::uint64_t next() {
    std::uint64_t u = 0;
    for (int i = 0; i < kLongestNumber; ++i) {
      if (at_ == bytes_.size()) refuse(where_, "a channel that is cut short");
      const auto byte = static_cast<unsigned char>(bytes_[at_++]);
      u |= static_cast<std::uint64_t>(byte & 0x7FU) << (7U * static_cast<unsigned>(i));
      if (byte < 0x80U) return u;
    }
    refuse(where_, "a number that is too long");
  }
  [[nodiscard]] bool is_done() const { return at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  const std::string& where_;
  std::size_t at_ = 0;
};

ChannelSpec spec_from(const Json& entry, const std::string& where) {
  ChannelSpec spec;
  spec.name = entry.at("name").get<std::string>();
  spec.columns = entry.at("columns").get<std::vector<std::string>>();
  spec.unit = entry.at("unit").get<std::string>();
  spec.frame = entry.at("frame").get<std::string>();
  spec.quantum = entry.at("quantum").get<double>();
  const auto encoding = entry.at("encoding").get<std::string>();
  if (encoding != "delta" && encoding != "raw") refuse(where, "encoding '" + encoding + "'");
  spec.encoding = encoding == "raw" ? Encoding::Raw : Encoding::Delta;
  return spec;
}

Channel decode_channel(const Json& entry, std::string_view data, const std::string& where) {
  Channel channel;
  channel.spec = spec_from(entry, where);
  channel.rows = entry.at("rows").get<std::size_t>();
  const auto offset = entry.at("offset").get<std::size_t>();
  const auto size = entry.at("bytes").get<std::size_t>();
  if (offset > data.size() || size > data.size() - offset)
    refuse(where, "channel '" + channel.spec.name + "' outside the data");
  const std::size_t width = channel.spec.columns.size();
  if (width > 0 && channel.rows > size / width) refuse(where, "more rows than bytes in '" + channel.spec.name + "'");
  channel.values.resize(channel.rows * width);
  NumberReader numbers(data.substr(offset, size), where);
  for (std::size_t column = 0; column < width; ++column) {
    std::uint64_t last = 0;
    for (std::size_t row = 0; row < channel.rows; ++row) {
      const std::uint64_t u = numbers.next();
      double& value = channel.values[row * width + column];
      value = std::numeric_limits<double>::quiet_NaN();
      if (u == 0) continue;
      const auto d = static_cast<std::uint64_t>(unzigzag(u - 1));
      last = channel.spec.encoding == Encoding::Delta ? last + d : d;  // unsigned: damaged sums wrap
      value = static_cast<double>(static_cast<std::int64_t>(last)) * channel.spec.quantum;
    }
  }
  if (!numbers.is_done()) refuse(where, "bytes left over in '" + channel.spec.name + "'");
  return channel;
}

}  // namespace

void ColumnWriter::put(double value) {
  const double quanta = std::round(value / quantum_);
  if (!(std::abs(quanta) < kLargest)) {
    bytes_.push_back('\0');
    return;
  }
  const auto i = static_cast<std::int64_t>(quanta);
  put_number(bytes_, zigzag(encoding_ == Encoding::Delta ? i - last_ : i) + 1);
  last_ = i;
}

ChannelWriter::ChannelWriter(ChannelSpec spec) : spec_(std::move(spec)) {
  SNUG_CHECK(spec_.quantum > 0.0, "a channel needs a quantum");
  columns_.assign(spec_.columns.size(), ColumnWriter(spec_.quantum, spec_.encoding));
}

void ChannelWriter::put(std::span<const double> row) {
  SNUG_CHECK(row.size() == columns_.size(), "one value a column");
  for (std::size_t i = 0; i < row.size(); ++i) columns_[i].put(row[i]);
  ++rows_;
}

std::string encode_form(const std::string& header_json, std::span<const ChannelWriter> channels) {
  Json header = Json::parse(header_json);
  Json list = Json::array();
  std::string data;
  for (const ChannelWriter& channel : channels) {
    const std::size_t offset = data.size();
    for (const ColumnWriter& column : channel.columns()) data += column.bytes();
    const ChannelSpec& spec = channel.spec();
    list.push_back({{"name", spec.name},
                    {"columns", spec.columns},
                    {"unit", spec.unit},
                    {"frame", spec.frame},
                    {"quantum", spec.quantum},
                    {"rows", channel.rows()},
                    {"offset", offset},
                    {"bytes", data.size() - offset},
                    {"encoding", spec.encoding == Encoding::Delta ? "delta" : "raw"}});
  }
  header["channels"] = std::move(list);
  const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  SNUG_CHECK(text.size() < std::numeric_limits<std::uint32_t>::max(), "a header of less than 4 GiB");
  std::string plain;
  plain.reserve(4 + text.size() + data.size());
  for (unsigned shift = 0; shift < 32; shift += 8) plain.push_back(static_cast<char>((text.size() >> shift) & 0xFFU));
  plain += text;
  plain += data;
  return std::string(kMagic) + deflated(plain);
}

const Channel* find_channel(const Form& form, std::string_view name) {
  for (const Channel& channel : form.channels) {
    if (channel.spec.name == name) return &channel;
  }
  return nullptr;
}

Form decode_form(std::string_view bytes, const std::string& where, std::size_t max_bytes) {
  if (!bytes.starts_with(kMagic)) refuse(where, "something else");
  const std::string plain = inflated(bytes.substr(kMagic.size()), where, max_bytes);
  if (plain.size() < 4) refuse(where, "no header");
  std::size_t length = 0;
  for (unsigned i = 0; i < 4; ++i) length |= std::size_t{static_cast<unsigned char>(plain[i])} << (8U * i);
  if (length > plain.size() - 4) refuse(where, "a header that is cut short");
  Form form;
  form.header_json = plain.substr(4, length);
  const std::string_view data = std::string_view(plain).substr(4 + length);
  try {
    const Json header = Json::parse(form.header_json);
    if (header.at("format") != "snug replay") refuse(where, "another format");
    if (const int version = header.at("version").get<int>(); version < 1 || version > kReplayVersion) {
      throw InputError(where, "version", std::to_string(version), "1 to " + std::to_string(kReplayVersion));
    }
    for (const Json& entry : header.at("channels")) form.channels.push_back(decode_channel(entry, data, where));
  } catch (const Json::exception& error) {
    refuse(where, std::string("a header that cannot be read: ") + error.what());
  }
  return form;
}

}  // namespace snug::replay
