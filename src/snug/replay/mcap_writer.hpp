// McapWriter: MCAP files (mcap.dev, version 0): any messages, indexed, in compressed chunks. It knows nothing of
// robots.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "snug/core/output_file.hpp"

namespace snug::replay {

enum class McapCompression : std::uint8_t { None, Zstd };
/// Of messages and their schemas.
enum class McapEncoding : std::uint8_t { Protobuf, Json };

struct McapSettings {
  McapEncoding encoding = McapEncoding::Protobuf;  ///< of export_mcap; a McapWriter takes any
  McapCompression compression = McapCompression::Zstd;
  std::size_t chunk_bytes = std::size_t{1} << 20U;  ///< a chunk is closed when it holds as many, before compression
};

/// The file is at its path when it is closed. Every checksum that the format has is there, and the summary with all
/// indices. Throws OutputError when writing fails.
///
/// Called out of order (a channel that does not exist, a time before the channel's last) it stops the program.
class McapWriter {
 public:
  explicit McapWriter(OutputFile file, const McapSettings& settings = {});
  ~McapWriter();  ///< without close() nothing is left
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// A channel of messages that follow `schema` of that name; equal names share one schema. `schema` is a serialised
  /// FileDescriptorSet, or JSON Schema.
  std::uint16_t add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema,
                            McapEncoding encoding);
  /// Times in ns, strictly increasing within a channel.
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message);
  /// A file within the file.
  void attach(const std::string& name, const std::string& media_type, std::string_view data);
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& entries);
  void close();

  /// Bytes of the file so far.
  [[nodiscard]] std::uint64_t size() const;
  [[nodiscard]] std::uint64_t message_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::replay
