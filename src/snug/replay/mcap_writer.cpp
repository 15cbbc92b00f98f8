// McapWriter: records of the format (mcap.dev/spec), gathered in chunks, indexed at the end.
#include "snug/replay/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "snug/core/check.hpp"

namespace snug::replay {
namespace {

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr int kZstdLevel = 3;  // 9 takes four times as long for a tenth less

enum class Op : std::uint8_t {
  Header = 0x01,
  Footer = 0x02,
  Schema = 0x03,
  Channel = 0x04,
  Message = 0x05,
  Chunk = 0x06,
  MessageIndex = 0x07,
  ChunkIndex = 0x08,
  Attachment = 0x09,
  AttachmentIndex = 0x0A,
  Statistics = 0x0B,
  Metadata = 0x0C,
  MetadataIndex = 0x0D,
  SummaryOffset = 0x0E,
  DataEnd = 0x0F,
};

std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

/// Numbers little-endian, texts behind their length.
class Bytes {
 public:
  Bytes& u8(std::uint8_t value) { return number(value, 1); }
  Bytes& u16(std::uint16_t value) { return number(value, 2); }
  Bytes& u32(std::uint64_t value) {
    SNUG_CHECK(value <= std::numeric_limits<std::uint32_t>::max(), "fits into 32 bits");
    return number(value, 4);
  }
  Bytes& u64(std::uint64_t value) { return number(value, 8); }
  Bytes& text(std::string_view value) {
    u32(value.size());
    return raw(value);
  }
  Bytes& raw(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  [[nodiscard]] const std::string& str() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  Bytes& number(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_ += static_cast<char>(static_cast<unsigned char>((value >> (8 * i)) & 0xFFU));
    return *this;
  }
  std::string bytes_;
};

std::string record_of(Op op, std::string_view content) {
  Bytes bytes;
  bytes.u8(static_cast<std::uint8_t>(op)).u64(content.size()).raw(content);
  return bytes.str();
}

std::string pairs_of(const std::map<std::string, std::string>& entries) {
  Bytes pairs, bytes;
  for (const auto& [key, value] : entries) pairs.text(key).text(value);
  bytes.text(pairs.str());
  return bytes.str();
}

/// First and last time of messages.
struct Span {
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max(), last = 0;
  void add(std::uint64_t time) {
    first = std::min(first, time);
    last = std::max(last, time);
  }
  [[nodiscard]] std::uint64_t begin() const { return first <= last ? first : 0; }
};

struct ChannelState {
  std::string record;
  std::uint64_t count = 0;
  std::uint64_t last_time = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  ///< time and place in the open chunk
};

}  // namespace

struct McapWriter::Impl {
  Impl(OutputFile output_file, const McapSettings& writer_settings)
      : file(std::move(output_file)), settings(writer_settings) {}
  void put(std::string_view bytes);
  void flush_chunk();
  [[nodiscard]] std::string packed(const std::string& records) const;
  [[nodiscard]] std::string statistics() const;
  void write_summary();

  OutputFile file;
  McapSettings settings;
  std::uint64_t offset = 0;
  std::uint32_t crc = 0;  ///< of all that was put so far
  std::map<std::string, std::uint16_t> schemas;
  std::string schema_records;
  std::vector<ChannelState> channels;
  std::string definitions;  ///< schemas and channels that are not in a chunk yet
  std::string chunk;
  Span chunk_span, span;
  std::uint64_t messages = 0;
  std::uint32_t chunks = 0, attachments = 0, metadata = 0;
  std::string chunk_index, attachment_index, metadata_index;
};

void McapWriter::Impl::put(std::string_view bytes) {
  file.write(bytes);
  offset += bytes.size();
  crc = crc_of(bytes, crc);
}

std::string McapWriter::Impl::packed(const std::string& records) const {
  if (settings.compression == McapCompression::None) return records;
  std::string bytes(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size = ZSTD_compress(bytes.data(), bytes.size(), records.data(), records.size(), kZstdLevel);
  SNUG_CHECK(ZSTD_isError(size) == 0, "compress into a buffer of the bound it asked for");
  bytes.resize(size);
  return bytes;
}

void McapWriter::Impl::flush_chunk() {
  if (chunk.empty()) return;
  const char* name = settings.compression == McapCompression::Zstd ? "zstd" : "";
  const std::string bytes = packed(chunk);
  Bytes head;
  head.u64(chunk_span.begin()).u64(chunk_span.last).u64(chunk.size()).u32(crc_of(chunk)).text(name).u64(bytes.size());
  const std::uint64_t start = offset;
  Bytes length;
  length.u8(static_cast<std::uint8_t>(Op::Chunk)).u64(head.str().size() + bytes.size());
  put(length.str());
  put(head.str());
  put(bytes);
  const std::uint64_t chunk_end = offset;
  Bytes places;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    ChannelState& channel = channels[i];
    if (channel.index.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i);
    places.u16(id).u64(offset);
    Bytes entries, index;
    for (const auto& [time, place] : channel.index) entries.u64(time).u64(place);
    index.u16(id).text(entries.str());
    put(record_of(Op::MessageIndex, index.str()));
    channel.index.clear();
  }
  Bytes entry;
  entry.u64(chunk_span.begin()).u64(chunk_span.last).u64(start).u64(chunk_end - start);
  entry.text(places.str()).u64(offset - chunk_end).text(name).u64(bytes.size()).u64(chunk.size());
  chunk_index += record_of(Op::ChunkIndex, entry.str());
  ++chunks;
  chunk.clear();
  chunk_span = {};
}

std::string McapWriter::Impl::statistics() const {
  Bytes counts, bytes;
  for (std::size_t i = 0; i < channels.size(); ++i) counts.u16(static_cast<std::uint16_t>(i)).u64(channels[i].count);
  bytes.u64(messages).u16(static_cast<std::uint16_t>(schemas.size())).u32(channels.size());
  bytes.u32(attachments).u32(metadata).u32(chunks).u64(span.begin()).u64(span.last).text(counts.str());
  return record_of(Op::Statistics, bytes.str());
}

void McapWriter::Impl::write_summary() {
  std::string channel_records;
  for (const ChannelState& channel : channels) channel_records += channel.record;
  const std::pair<Op, std::string> groups[] = {
      {Op::Schema, schema_records},  {Op::Channel, channel_records},          {Op::Statistics, statistics()},
      {Op::ChunkIndex, chunk_index}, {Op::AttachmentIndex, attachment_index}, {Op::MetadataIndex, metadata_index},
  };
  crc = 0;  // of the summary and the footer from here on
  const std::uint64_t start = offset;
  std::string offsets;
  for (const auto& [op, records] : groups) {
    if (records.empty()) continue;
    Bytes entry;
    entry.u8(static_cast<std::uint8_t>(op)).u64(offset).u64(records.size());
    offsets += record_of(Op::SummaryOffset, entry.str());
    put(records);
  }
  const std::uint64_t offsets_start = offset;
  put(offsets);
  Bytes footer;
  footer.u8(static_cast<std::uint8_t>(Op::Footer)).u64(20).u64(start).u64(offsets_start);
  put(footer.str());
  Bytes checksum;
  checksum.u32(crc);
  put(checksum.str());
}

McapWriter::McapWriter(OutputFile file, const McapSettings& settings)
    : impl_(std::make_unique<Impl>(std::move(file), settings)) {
  Bytes header;
  header.text("").text("snug");
  impl_->put(kMcapMagic);
  impl_->put(record_of(Op::Header, header.str()));
}

McapWriter::~McapWriter() = default;

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                      const std::string& schema, McapEncoding encoding) {
  const bool is_json = encoding == McapEncoding::Json;
  const auto [at, is_new] = impl_->schemas.try_emplace(schema_name, 0);
  if (is_new) {
    at->second = static_cast<std::uint16_t>(impl_->schemas.size());  // 0 means none
    Bytes bytes;
    bytes.u16(at->second).text(schema_name).text(is_json ? "jsonschema" : "protobuf").text(schema);
    const std::string record = record_of(Op::Schema, bytes.str());
    impl_->schema_records += record;
    impl_->definitions += record;
  }
  const auto id = static_cast<std::uint16_t>(impl_->channels.size());
  Bytes bytes;
  bytes.u16(id).u16(at->second).text(topic).text(is_json ? "json" : "protobuf").raw(pairs_of({}));
  impl_->channels.push_back({record_of(Op::Channel, bytes.str()), 0, 0, {}});
  impl_->definitions += impl_->channels.back().record;
  return id;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  SNUG_CHECK(channel < impl_->channels.size(), "a channel that was added");
  ChannelState& state = impl_->channels[channel];
  SNUG_CHECK(state.count == 0 || time_ns > state.last_time, "time grows within a channel");
  impl_->chunk += impl_->definitions;
  impl_->definitions.clear();
  state.index.emplace_back(time_ns, impl_->chunk.size());
  Bytes head;
  head.u8(static_cast<std::uint8_t>(Op::Message)).u64(22 + message.size());
  head.u16(channel).u32(state.count & 0xFFFFFFFFU).u64(time_ns).u64(time_ns);
  impl_->chunk += head.str();
  impl_->chunk += message;
  ++state.count;
  state.last_time = time_ns;
  ++impl_->messages;
  impl_->chunk_span.add(time_ns);
  impl_->span.add(time_ns);
  if (impl_->chunk.size() >= impl_->settings.chunk_bytes) impl_->flush_chunk();
}

void McapWriter::attach(const std::string& name, const std::string& media_type, std::string_view data) {
  impl_->flush_chunk();
  Bytes content;
  content.u64(0).u64(0).text(name).text(media_type).u64(data.size()).raw(data);
  content.u32(crc_of(content.str()));
  const std::string record = record_of(Op::Attachment, content.str());
  Bytes entry;
  entry.u64(impl_->offset).u64(record.size()).u64(0).u64(0).u64(data.size()).text(name).text(media_type);
  impl_->attachment_index += record_of(Op::AttachmentIndex, entry.str());
  ++impl_->attachments;
  impl_->put(record);
}

void McapWriter::add_metadata(const std::string& name, const std::map<std::string, std::string>& entries) {
  impl_->flush_chunk();
  Bytes content;
  content.text(name).raw(pairs_of(entries));
  const std::string record = record_of(Op::Metadata, content.str());
  Bytes entry;
  entry.u64(impl_->offset).u64(record.size()).text(name);
  impl_->metadata_index += record_of(Op::MetadataIndex, entry.str());
  ++impl_->metadata;
  impl_->put(record);
}

void McapWriter::close() {
  impl_->flush_chunk();
  Bytes end;
  end.u32(impl_->crc);
  impl_->put(record_of(Op::DataEnd, end.str()));
  impl_->write_summary();
  impl_->put(kMcapMagic);
  impl_->file.publish();
}

std::uint64_t McapWriter::size() const { return impl_->offset; }
std::uint64_t McapWriter::message_count() const { return impl_->messages; }

}  // namespace snug::replay
