// Tests of MCAP files: their framing, checksums and indices, read by a small reader of its own; the meaning of the
// messages is compared with the recording by an independent reader in viewer/test/export.
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/mcap_export.hpp"
#include "snug/replay/mcap_writer.hpp"
#include "snug/replay/test/scratch.hpp"

namespace snug::replay {
namespace {

using test::ScratchFolder;

/// What this reader reads; protocol buffers are compared with it by tests/mcap_test.py.
const McapSettings kJson = {.encoding = McapEncoding::Json};

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Numbers and texts one after the other.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_.at(at_ + i))) << (8 * i);
    }
    at_ += size;
    return value;
  }
  std::string_view take(std::size_t size) {
    if (bytes_.size() - at_ < size) throw std::runtime_error("cut short");
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  std::string_view text() { return take(number(4)); }
  [[nodiscard]] bool is_at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

struct Record {
  int op;
  std::size_t at;  ///< place of its first byte
  std::size_t size;
  std::string_view content;
};

std::vector<Record> records_of(std::string_view bytes) {
  std::vector<Record> records;
  for (Cursor cursor(bytes); !cursor.is_at_end();) {
    const std::size_t at = cursor.at();
    const auto op = static_cast<int>(cursor.number(1));
    const std::string_view content = cursor.take(cursor.number(8));
    records.push_back({op, at, content.size() + 9, content});
  }
  return records;
}

std::uint64_t crc_of(std::string_view bytes) {
  return crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
}

/// Everything between the magic bytes; places count from the beginning of the file.
std::vector<Record> records_of_file(const std::string& file) {
  EXPECT_EQ(file.substr(0, 8), std::string("\x89MCAP0\r\n", 8));
  EXPECT_EQ(file.substr(file.size() - 8), std::string("\x89MCAP0\r\n", 8));
  std::vector<Record> records = records_of(std::string_view(file).substr(8, file.size() - 16));
  for (Record& record : records) record.at += 8;
  return records;
}

std::string chunk_records(std::string_view content) {
  Cursor cursor(content);
  (void)cursor.take(16);
  const std::size_t size = cursor.number(8);
  const std::uint64_t crc = cursor.number(4);
  const std::string compression(cursor.text());
  const std::string_view packed = cursor.take(cursor.number(8));
  std::string plain(packed);
  if (compression == "zstd") {
    plain.resize(size);
    EXPECT_EQ(ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size()), size);
  }
  EXPECT_EQ(plain.size(), size);
  EXPECT_EQ(crc_of(plain), crc);
  return plain;
}

std::string random_export(const std::filesystem::path& folder, const McapSettings& settings,
                          const Selection& selection = {}) {
  Rng rng = Rng(11).split("mcap");
  record::save_recording(folder / "run.h5", test::random_recording(rng, 80));
  record::RecordingReader reader(folder / "run.h5");
  (void)export_mcap(reader, "run.h5", selection, folder / "run.mcap", settings);
  return content_of(folder / "run.mcap");
}

/// Messages of each topic with their times.
std::map<std::string, std::vector<std::pair<std::uint64_t, nlohmann::json>>> messages_of(const std::string& file) {
  std::map<std::uint64_t, std::string> topics;
  std::map<std::string, std::vector<std::pair<std::uint64_t, nlohmann::json>>> messages;
  for (const Record& chunk : records_of_file(file)) {
    if (chunk.op != 0x06) continue;
    const std::string plain = chunk_records(chunk.content);
    for (const Record& record : records_of(plain)) {
      Cursor cursor(record.content);
      const std::uint64_t id = cursor.number(2);
      if (record.op == 0x04) (void)cursor.number(2), topics[id] = cursor.text();
      if (record.op != 0x05) continue;
      (void)cursor.number(4);
      const std::uint64_t time = cursor.number(8);
      (void)cursor.number(8);
      messages[topics.at(id)].emplace_back(time, nlohmann::json::parse(cursor.take(record.content.size() - 22)));
    }
  }
  return messages;
}

TEST(McapWriter, ChecksumsCoverDataAndSummary) {
  const ScratchFolder folder;
  for (const McapCompression compression : {McapCompression::None, McapCompression::Zstd}) {
    const std::string file = random_export(folder / "", {McapEncoding::Json, compression, 20'000});
    const std::vector<Record> records = records_of_file(file);
    const auto end = std::find_if(records.begin(), records.end(), [](const Record& r) { return r.op == 0x0F; });
    ASSERT_NE(end, records.end());
    EXPECT_EQ(Cursor(end->content).number(4), crc_of(std::string_view(file).substr(0, end->at)));
    Cursor footer(records.back().content);
    ASSERT_EQ(records.back().op, 0x02);
    const std::size_t summary = footer.number(8);
    (void)footer.number(8);
    EXPECT_EQ(summary, end->at + end->size);
    EXPECT_EQ(footer.number(4), crc_of(std::string_view(file).substr(summary, file.size() - 12 - summary)));
  }
}

TEST(McapWriter, IndicesLeadToTheirChunksAndMessages) {
  const ScratchFolder folder;
  const std::string file = random_export(folder / "", {McapEncoding::Json, McapCompression::Zstd, 20'000});
  std::map<std::size_t, Record> by_place;
  for (const Record& record : records_of_file(file)) by_place.emplace(record.at, record);
  std::size_t chunks = 0, indexed = 0;
  for (const auto& [at, record] : by_place) {
    if (record.op != 0x08) continue;
    ++chunks;
    Cursor cursor(record.content);
    const std::uint64_t first = cursor.number(8), last = cursor.number(8);
    const Record& chunk = by_place.at(cursor.number(8));
    ASSERT_EQ(chunk.op, 0x06);
    EXPECT_EQ(cursor.number(8), chunk.size);
    const std::string plain = chunk_records(chunk.content);
    for (Cursor places(cursor.text()); !places.is_at_end();) {
      const std::uint64_t id = places.number(2);
      const Record& index = by_place.at(places.number(8));
      ASSERT_EQ(index.op, 0x07);
      Cursor entries(index.content);
      EXPECT_EQ(entries.number(2), id);
      for (Cursor entry(entries.text()); !entry.is_at_end(); ++indexed) {
        const std::uint64_t time = entry.number(8);
        EXPECT_TRUE(first <= time && time <= last);
        Cursor message(std::string_view(plain).substr(entry.number(8)));
        EXPECT_EQ(message.number(1), 0x05u);
        (void)message.number(8);
        EXPECT_EQ(message.number(2), id);
        (void)message.number(4);
        EXPECT_EQ(message.number(8), time);
      }
    }
  }
  EXPECT_GT(chunks, 3u);
  std::size_t messages = 0;
  for (const auto& [topic, list] : messages_of(file)) messages += list.size();
  EXPECT_EQ(indexed, messages);
}

TEST(McapExport, TimesGrowStrictlyInEveryTopic) {
  const ScratchFolder folder;
  const auto messages = messages_of(random_export(folder / "", kJson));
  EXPECT_EQ(messages.at("/tf").size(), 80u);
  EXPECT_EQ(messages.at("/flange/wrench").size(), 80u);
  for (const auto& [topic, list] : messages) {
    for (std::size_t i = 1; i < list.size(); ++i) EXPECT_GT(list[i].first, list[i - 1].first) << topic;
  }
}

TEST(McapExport, DrawsABodyOnlyWhileItIsThere) {
  const ScratchFolder folder;
  Rng rng = Rng(11).split("mcap");
  const record::Recording recording = test::random_recording(rng, 80);
  const auto messages = messages_of(random_export(folder / "", kJson));
  const auto& scenes = messages.at("/scene");
  std::size_t at = 0;
  for (const record::Frame& frame : recording.frames) {
    const auto ns = static_cast<std::uint64_t>(std::llround(1e9 * frame.time));
    while (at + 1 < scenes.size() && scenes[at + 1].first <= ns) ++at;
    std::vector<std::string> drawn, there;
    for (const auto& entity : scenes[at].second["entities"]) {
      drawn.push_back(entity["id"]);
      if (entity["id"] != "table") continue;
      ASSERT_EQ(entity["cylinders"].size(), 1u);
      EXPECT_EQ(entity["cylinders"][0]["size"]["z"], 0.4);
      EXPECT_EQ(entity["cylinders"][0]["top_scale"], 1.0);
    }
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      if (frame.bodies[i].present) there.push_back(recording.header.bodies[i].name);
    }
    EXPECT_EQ(drawn, there) << frame.time;
  }
}

TEST(McapExport, TakesOnlyTheFramesAskedForAndTheEventsAmongThem) {
  const ScratchFolder folder;
  const auto messages = messages_of(random_export(folder / "", kJson, {0.1, 0.3, 3}));
  EXPECT_EQ(messages.at("/tf").size(), 9u);  // frames of 0.104 s .. 0.296 s, every third
  if (!messages.contains("/events")) return;
  for (const auto& [time, event] : messages.at("/events")) EXPECT_TRUE(time >= 100'000'000 && time <= 300'000'000);
}

TEST(McapExport, TellsTheJointsOfARobotToTheLastBit) {
  const ScratchFolder folder;
  Rng rng = Rng(12).split("mcap");
  const record::Recording recording = test::random_robot_recording(rng, 20);
  record::save_recording(folder / "run.h5", recording);
  record::RecordingReader reader(folder / "run.h5");
  (void)export_mcap(reader, "run.h5", {}, folder / "run.mcap", kJson);
  const auto messages = messages_of(content_of(folder / "run.mcap"));
  ASSERT_EQ(messages.at("/joint_states").size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    const nlohmann::json& message = messages.at("/joint_states")[i].second;
    EXPECT_EQ(message["name"], nlohmann::json({"shoulder", "elbow"}));
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(message["position"][k].get<double>(), recording.frames[i].joints[k].position);
      EXPECT_EQ(message["velocity"][k].get<double>(), recording.frames[i].joints[k].velocity);
      EXPECT_EQ(message["effort"][k].get<double>(), recording.frames[i].joints[k].torque);
    }
  }
  const ScratchFolder other;
  EXPECT_FALSE(messages_of(random_export(other / "", kJson)).contains("/joint_states"));
}

TEST(McapExport, WritesTheSameBytesAgain) {
  const ScratchFolder folder;
  EXPECT_EQ(random_export(folder / "", kJson), random_export(folder / "", kJson));
}

TEST(McapWriter, LeavesNothingWhenItCannotWriteOrIsNotClosed) {
  const ScratchFolder folder;
  EXPECT_THROW(McapWriter(folder / "no/such/a.mcap"), InputError);
  std::filesystem::create_directory(folder / "b.mcap");
  EXPECT_THROW(McapWriter(folder / "b.mcap"), InputError);
  {
    McapWriter writer(folder / "c.mcap");
    writer.write(writer.add_channel("/a", "a", "{}", McapEncoding::Json), 1, "{}");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / ""), {}), 1);  // the folder of that name
}

TEST(McapWriter, WritesAFileWithoutMessages) {
  const ScratchFolder folder;
  McapWriter writer(folder / "a.mcap");
  (void)writer.add_channel("/a", "a", "{}", McapEncoding::Json);
  writer.close();
  const std::vector<Record> records = records_of_file(content_of(folder / "a.mcap"));
  EXPECT_EQ(std::count_if(records.begin(), records.end(), [](const Record& r) { return r.op == 0x06; }), 0);
}

}  // namespace
}  // namespace snug::replay
