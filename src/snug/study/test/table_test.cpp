// Tables: lines that are whole and lines that are not, folders, what is kept of a result.
#include "snug/study/table.hpp"

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::study {
namespace {

RowResult example() {
  RowResult result;
  result.row = 17;
  result.exit_code = 1;
  result.seconds = 0.25;
  result.error = "failed: \"so\"\n";
  result.values = {{"a", 0.1}, {"b", std::string("x,y")}, {"c", std::monostate{}}, {"big", 1e300}};
  return result;
}

std::string line_of(const RowResult& result) {
  std::string line = format_line(result);
  EXPECT_EQ(line.back(), '\n');
  line.pop_back();
  return line;
}

TEST(Table, ALineReadsBackTheSame) {
  const auto back = parse_line(line_of(example()));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(*back, example());
  EXPECT_EQ(back->seconds, 0.25);
}

TEST(Table, ALineCutShortOrChangedAnywhereIsNoLine) {
  const std::string line = line_of(example());
  for (std::size_t length = 0; length < line.size(); ++length) EXPECT_FALSE(parse_line(line.substr(0, length)));
  for (std::size_t at = 0; at < line.size(); ++at) {
    std::string changed = line;
    changed[at] = changed[at] == '1' ? '2' : '1';
    if (changed != line) {
      EXPECT_FALSE(parse_line(changed)) << at;
    }
  }
  EXPECT_FALSE(parse_line(line + line));
}

TEST(Table, KeepsNumbersAndWordsButNoClocksAndNoLists) {
  const Study study = test::grid(2, 1, 1);
  const auto values = values_of(
      study, R"({"a": 1.5, "wall": 3, "decision_seconds_median": 2, "real_time_factor": 9, "t": true, "n": null,
                 "in": {"b": "w", "list": [1]}, "list": [1, 2]})");
  const std::vector<std::pair<std::string, Cell>> expected = {{"a", 1.5}, {"t", 1.0}, {"in.b", std::string("w")}};
  EXPECT_EQ(values.values, expected);
  EXPECT_TRUE(values.clock.empty());
  EXPECT_EQ(values_of(study, "no json"), ResultValues{});
  EXPECT_EQ(values_of(study, "[1]"), ResultValues{});
}

TEST(Table, BelievesWhatAResultSaysOfItsClocks) {
  const std::string json =
      R"({"rate": 1, "seconds": 2, "in": {"rate": 3, "b": 4}, "wait": {"a": 5}, "of_clock": ["rate", "wait"]})";
  const ResultValues all = values_of(test::grid(2, 1, 1), json);
  const std::vector<std::pair<std::string, Cell>> expected = {{"seconds", 2.0}, {"in.b", 4.0}};
  EXPECT_EQ(all.values, expected) << "seconds are simulated ones: the list says so";
  const ResultValues named = values_of(test::grid(2, 1, 1, "outputs: [in.b, rate, in.rate, wait.a]\n"), json);
  const std::vector<std::pair<std::string, Cell>> clock = {{"rate", 1.0}, {"in.rate", 3.0}, {"wait.a", 5.0}};
  EXPECT_EQ(named.values.size(), 1U);
  EXPECT_EQ(named.clock, clock);
}

TEST(Table, KeepsTheOutputsThatAreNamedAlsoThoseInLists) {
  const Study study = test::grid(2, 1, 1, "outputs: [a, in.list.1.c, wall, none, list.9, in]\n");
  const auto values = values_of(study, R"({"wall": 3, "a": 1, "in": {"list": [0, {"c": 5}]}, "list": []})");
  const std::vector<std::pair<std::string, Cell>> expected = {{"a", 1.0},
                                                              {"in.list.1.c", 5.0},
                                                              {"none", std::monostate{}},
                                                              {"list.9", std::monostate{}},
                                                              {"in", R"({"list":[0,{"c":5}]})"}};
  EXPECT_EQ(values.values, expected);
  const std::vector<std::pair<std::string, Cell>> clock = {{"wall", 3.0}};
  EXPECT_EQ(values.clock, clock);
}

TEST(Folder, CountsRowsOnceWhoseClocksDiffer) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 2);
  const Folder folder(study, scratch / "f", true);
  RowResult one = example(), other = example(), late = example();
  one.row = other.row = late.row = 2;
  other.seconds = 9.0;
  one.clock = {{"rate", 1.0}};
  other.clock = {{"rate", 2.0}};
  late.exit_code = -1;
  late.error = kOverTime;
  late.values.clear();
  for (const auto& [first, second] : {std::pair(one, other), std::pair(one, late), std::pair(late, one)}) {
    std::ofstream(folder.table(1)) << format_line(first) << format_line(second);
    const auto rows = folder.read(1);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.at(2), one);
  }
}

TEST(Folder, FollowsNoLinks) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 2);
  const Folder folder(study, scratch / "f", true);
  std::ofstream(scratch / "precious") << "mine\n";
  std::filesystem::create_symlink(scratch / "precious", folder.table(0));
  std::filesystem::create_hard_link(scratch / "precious", folder.table(1));
  for (const std::uint64_t chunk : {0U, 1U}) {
    EXPECT_THROW((void)TableWriter::open(folder.table(chunk)), InputError);
    EXPECT_THROW((void)folder.read(chunk), InputError);
  }
  EXPECT_EQ(test::read_text(scratch / "precious"), "mine\n");
  std::filesystem::rename(scratch / "f" / "study.yaml", scratch / "study.yaml");
  std::filesystem::create_symlink(scratch / "study.yaml", scratch / "f" / "study.yaml");
  EXPECT_THROW(Folder(study, scratch / "f", true), InputError);
}

TEST(Folder, IsNoneThatEverybodyCanWrite) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 2);
  std::filesystem::create_directory(scratch / "f");
  std::filesystem::permissions(scratch / "f", std::filesystem::perms::all);
  EXPECT_THROW(Folder(study, scratch / "f", true), InputError);
  EXPECT_TRUE(std::filesystem::is_empty(scratch / "f"));
}

TEST(Folder, IsOfOneStudyAsItWasBegun) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 3), changed = test::grid(2, 1, 2);
  EXPECT_THROW(Folder(study, scratch / "f", false), InputError);
  EXPECT_NO_THROW(Folder(study, scratch / "f", true));
  EXPECT_NO_THROW(Folder(study, scratch / "f", false));
  EXPECT_THROW(Folder(changed, scratch / "f", true), InputError);
  std::ofstream(scratch / "something") << "else";
  EXPECT_THROW(Folder(study, scratch.path(), true), InputError);
}

TEST(Folder, ReadsWhatIsWholeAndRefusesARowThatWasDoneTwiceDifferently) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 1, 2);
  const Folder folder(study, scratch / "f", true);
  RowResult result = example();
  result.row = 2;
  std::ofstream(folder.table(1)) << "rubbish\n"
                                 << format_line(result) << format_line(result) << format_line(result).substr(0, 30);
  ASSERT_EQ(folder.read(1).size(), 1U);
  EXPECT_TRUE(folder.read(0).empty());
  {
    auto writer = TableWriter::open(folder.table(1));
    ASSERT_TRUE(writer.has_value());
    EXPECT_FALSE(TableWriter::open(folder.table(1)).has_value()) << "one writer at a time";
    result.row = 3;
    writer->append(result);
  }
  EXPECT_EQ(folder.read(1).size(), 2U);
  result.values.emplace_back("other", 1.0);
  TableWriter::open(folder.table(1))->append(result);
  EXPECT_THROW((void)folder.read(1), InputError);
}

TEST(Folder, SurvivesRandomBytesInItsTables) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(3, 1, 6);
  const Folder folder(study, scratch / "f", true);
  Rng rng = Rng(11).split("bytes");
  for (int round = 0; round < 200; ++round) {
    std::string bytes;
    for (std::uint64_t row = 0; row < 6; ++row) {
      RowResult result = example();
      result.row = row;
      bytes += format_line(result);
    }
    for (int i = 0; i < 3; ++i) {
      bytes[static_cast<std::size_t>(rng.index(static_cast<int>(bytes.size())))] = static_cast<char>(rng.index(256));
    }
    std::ofstream(folder.table(0), std::ios::binary | std::ios::trunc) << bytes;
    EXPECT_LE(folder.read(0).size(), 6U);
    EXPECT_GE(folder.read(0).size(), 2U);
  }
}

}  // namespace
}  // namespace snug::study
