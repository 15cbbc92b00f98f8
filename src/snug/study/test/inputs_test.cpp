// Inputs: rows of one study are of one world; what differs is named, and nothing is done or merged.
#include "snug/study/inputs.hpp"

#include <sys/stat.h>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/study/merge.hpp"

namespace snug::study {
namespace {

using test::ScratchFolder;

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Inputs inputs_with(std::uint64_t hash, const std::string& version = "1") { return {version, {{"in/a.yaml", hash}}}; }

TEST(Inputs, ALineReadsBackTheSame) {
  std::string line = format_inputs(inputs_with(7), 3);
  line.pop_back();
  const auto back = parse_inputs(line);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->inputs, inputs_with(7));
  EXPECT_EQ(back->first_row, 3U);
  for (std::size_t length = 0; length < line.size(); ++length) EXPECT_FALSE(parse_inputs(line.substr(0, length)));
}

TEST(Inputs, HashIsOfBytesNamesAndVersionAndNotOfTheFolder) {
  const std::string hash = inputs_with(7).hash();
  EXPECT_EQ(hash.size(), 16U);
  EXPECT_EQ(hash, (Inputs{"1", {{"elsewhere/a.yaml", 7}}}.hash()));
  EXPECT_NE(hash, inputs_with(8).hash());
  EXPECT_NE(hash, inputs_with(7, "2").hash());
  EXPECT_NE(hash, (Inputs{"1", {{"in/b.yaml", 7}}}.hash()));
}

TEST(OneWorld, NamesWhatDiffers) {
  OneWorld world("study");
  world.add(inputs_with(7), 0);
  world.add({"1", {{"other.csv", 1}}}, 1);  // another point may read another file
  EXPECT_NE(message_of([&] { world.add(inputs_with(8), 5); }).find("another 'in/a.yaml' than row 0"),
            std::string::npos);
  EXPECT_NE(message_of([&] { world.add(inputs_with(7, "2"), 5); }).find("snug 2, and row 0 by snug 1"),
            std::string::npos);
  EXPECT_NE(message_of([&] { world.add_unknown(5); }).find("older snug"), std::string::npos);
}

/// A study of a verb that reads a file, as verbs do.
class Mixture : public ::testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(scratch_ / "cell.yaml") << text; }
  int read_and_print(bool fails_at_odd = false) const {
    const std::string text = read_file(scratch_ / "cell.yaml", "a scenario");
    std::printf("{\"y\": %zu}\n", text.size());
    return fails_at_odd ? 1 : 0;
  }
  RunSummary run(std::uint64_t first, std::uint64_t last, const std::string& version = "1") {
    const Folder folder(study_, scratch_ / "f", true);
    RunSettings settings;
    settings.first_chunk = first;
    settings.last_chunk = last;
    settings.version = version;
    return run_study(
        study_, folder, [this](const auto&) { return read_and_print(); }, settings);
  }
  std::string merged() {
    const Folder folder(study_, scratch_ / "f", false);
    write_csv(study_, folder, OutputFile(scratch_ / "merged.csv"));
    return test::read_text(scratch_ / "merged.csv");
  }
  ScratchFolder scratch_;
  Study study_ = test::grid(4, 1, 2);
};

TEST_F(Mixture, IsRefusedWhenAStudyGoesOn) {
  write("one");
  EXPECT_EQ(run(0, 1).done, 4U);
  write("another");
  EXPECT_NE(message_of([&] { (void)run(0, 3); }).find("not the file that row 0 was done with"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)run(2, 3); }).find("cell.yaml"), std::string::npos) << "also for other tables";
  write("one");
  EXPECT_EQ(run(0, 3).done, 4U) << "the file is what it was";
  EXPECT_NE(message_of([&] { (void)run(0, 3, "2"); }).find("snug 1, and this is snug 2"), std::string::npos);
}

TEST_F(Mixture, IsRefusedWhenTheScenarioChangesWhileRowsRun) {
  write("one");
  const Folder folder(study_, scratch_ / "f", true);
  RunSettings settings;
  settings.progress = [&](std::uint64_t done, std::uint64_t) {
    if (done == 3) write("another");
  };
  const std::string message = message_of([&] {
    (void)run_study(
        study_, folder, [this](const auto&) { return read_and_print(); }, settings);
  });
  EXPECT_NE(message.find("cell.yaml"), std::string::npos) << message;
  EXPECT_EQ(status_of(study_, folder).done, 3U) << "rows of the first world are kept";
}

TEST_F(Mixture, IsRefusedWhenTablesOfTwoMachinesAreMerged) {
  write("one");
  (void)run(0, 1);
  std::filesystem::rename(scratch_ / "f", scratch_ / "first");
  write("another");
  (void)run(2, 3);
  for (const char* name : {"chunk-000000.jsonl", "chunk-000001.jsonl"})
    std::filesystem::copy_file(scratch_ / "first" / name, scratch_ / "f" / name);
  EXPECT_NE(message_of([&] { (void)merged(); }).find("cell.yaml' than row 0"), std::string::npos);
}

TEST_F(Mixture, EveryMergedRowSaysWhatItIsOf) {
  write("one");
  (void)run(0, 3);
  std::istringstream lines(merged());
  std::string header, line, hash;
  std::getline(lines, header);
  EXPECT_TRUE(header.ends_with(",error,inputs"));
  for (int i = 0; std::getline(lines, line); ++i) {
    const std::string one = line.substr(line.rfind(',') + 1);
    EXPECT_EQ(one.size(), 16U);
    EXPECT_TRUE(i == 0 || one == hash) << one;
    hash = one;
  }
}

TEST_F(Mixture, OfRowsOfAnOlderProgramIsRefused) {
  write("one");
  (void)run(0, 0);
  RowResult old;
  old.row = 7;
  old.values = {{"y", 3.0}};
  std::ofstream(scratch_ / "f" / "chunk-000003.jsonl") << format_line(old);
  EXPECT_NE(message_of([&] { (void)merged(); }).find("older snug"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)run(0, 3); }).find("older snug"), std::string::npos);
}

TEST(Merge, OfTheSameRowsHasTheSameBytesAtAnyTime) {
  const ScratchFolder scratch;
  const Study study = test::grid(3, 2, 4);
  const Folder folder(study, scratch / "f", true);
  (void)run_study(study, folder, test::fake, {});
  write_hdf5(study, folder, OutputFile(scratch / "one.h5"));
  ::usleep(1'100'000);  // time stamps of HDF5 are of whole seconds
  write_hdf5(study, folder, OutputFile(scratch / "two.h5"));
  EXPECT_EQ(test::read_text(scratch / "one.h5"), test::read_text(scratch / "two.h5"));
}

}  // namespace
}  // namespace snug::study
