// load_study: the file of a study, strictly read.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/yaml_limits.hpp"
#include "snug/study/design.hpp"
#include "snug/study/sobol.hpp"

namespace snug::study {
namespace {

/// Complaints with the line of a node.
class Reader {
 public:
  explicit Reader(std::string name) : name_(std::move(name)) {}

  [[noreturn]] void refuse(const YAML::Node& node, const std::string& key, const std::string& got,
                           const std::string& expected) const {
    const YAML::Mark mark = node.Mark();
    throw InputError(mark.is_null() ? name_ : name_ + ":" + std::to_string(mark.line + 1), key, got, expected);
  }

  /// A mapping with these keys and no others.
  void expect_keys(const YAML::Node& map, const std::string& what, const std::vector<std::string>& keys) const {
    if (!map.IsMap()) refuse(map, what, "something else", "a mapping");
    for (const auto& entry : map) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (std::ranges::find(keys, key) != keys.end()) continue;
      const std::string_view nearest = find_nearest(key, keys);
      std::string expected = "one of";
      for (const std::string& known : keys) expected += (known == keys.front() ? " " : ", ") + known;
      if (!nearest.empty()) expected += "; nearest is '" + std::string(nearest) + "'";
      refuse(entry.first, key, "an unknown key", expected);
    }
  }

  [[nodiscard]] std::string word(const YAML::Node& map, const char* key, const std::string& otherwise = "") const {
    const YAML::Node node = map[key];
    if (!node) return otherwise;
    if (!node.IsScalar() || node.Scalar().empty()) refuse(node, key, "no word", "a word");
    return node.Scalar();
  }
  [[nodiscard]] double number(const YAML::Node& map, const char* key, double low, double high) const {
    const YAML::Node node = map[key];
    double value = 0.0;
    const std::string text = node && node.IsScalar() ? node.Scalar() : "";
    const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    const bool is_number = error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
    if (!is_number || value < low || value > high) {
      refuse(node ? node : map, key, node ? "'" + text + "'" : "nothing",
             "a number from " + std::to_string(low) + " to " + std::to_string(high));
    }
    return value;
  }
  [[nodiscard]] std::uint64_t whole(const YAML::Node& map, const char* key, std::uint64_t low,
                                    std::uint64_t high) const {
    const YAML::Node node = map[key];
    const std::string text = node && node.IsScalar() ? node.Scalar() : "";
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < low || value > high) {
      refuse(node ? node : map, key, node ? "'" + text + "'" : "nothing",
             "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    }
    return value;
  }
  /// A scalar, or anything else as one line of YAML.
  [[nodiscard]] std::string value(const YAML::Node& node, const std::string& key) const {
    if (node.IsScalar()) return node.Scalar();
    if (!node.IsSequence() && !node.IsMap()) refuse(node, key, "nothing", "a value");
    YAML::Emitter out;
    out << YAML::Flow << node;
    return out.c_str();
  }
  [[nodiscard]] std::vector<std::string> list(const YAML::Node& node, const std::string& key) const {
    if (!node.IsSequence() || node.size() == 0) refuse(node, key, "no list", "a list with at least one entry");
    std::vector<std::string> values;
    for (const YAML::Node& entry : node) values.push_back(value(entry, key));
    return values;
  }

 private:
  std::string name_;
};

void expect_option(const Reader& reader, const YAML::Node& node, const std::string& option) {
  if (option.size() > 2 && option.starts_with("--") && option.find('=') == std::string::npos) return;
  if (option.size() == 2 && option[0] == '-' && option[1] != '-') return;
  reader.refuse(node, "option", "'" + option + "'", "an option of the verb, such as --agent");
}

Factor read_factor(const Reader& reader, const YAML::Node& node, Design design) {
  reader.expect_keys(node, "factors", {"name", "option", "set", "values", "from", "to", "scale", "whole"});
  Factor factor;
  factor.option = reader.word(node, "option");
  factor.key = reader.word(node, "set");
  if (factor.option.empty() == factor.key.empty())
    reader.refuse(node, "factors", "both or none", "either `option` or `set`");
  if (!factor.option.empty()) {
    expect_option(reader, node, factor.option);
    for (const char* own : {"--set", "--json", "-o", "--record"}) {
      const bool is_named_by_points = design == Design::List && factor.option == "--record";
      if (factor.option == own && !is_named_by_points)
        reader.refuse(node, "option", factor.option, "another option; `set` for scenario keys");
    }
  }
  std::string plain = factor.option;
  plain.erase(0, plain.find_first_not_of('-') == std::string::npos ? 0 : plain.find_first_not_of('-'));
  factor.name = reader.word(node, "name", factor.key.empty() ? plain : factor.key);
  if (node["values"]) factor.values = reader.list(node["values"], "values");
  const bool has_range = node["from"] || node["to"];
  if (design == Design::List) {
    if (has_range || node["values"]) reader.refuse(node, "factors", "values of a list", "them in `points`");
    return factor;
  }
  if (has_range == !factor.values.empty())
    reader.refuse(node, "factors", "both or none", "`values`, or `from` and `to`");
  if (!has_range) return factor;
  if (design == Design::Grid) reader.refuse(node, "from", "in a grid", "`values`");
  factor.from = reader.number(node, "from", -1e12, 1e12);
  factor.to = reader.number(node, "to", factor.from, 1e12);
  const std::string scale = reader.word(node, "scale", "linear");
  if (scale != "linear" && scale != "log") reader.refuse(node["scale"], "scale", "'" + scale + "'", "linear or log");
  factor.is_log = scale == "log";
  if (factor.is_log && factor.from <= 0.0) reader.refuse(node["from"], "from", "not above 0", "a positive number");
  const std::string whole = reader.word(node, "whole", "false");
  if (whole != "true" && whole != "false") reader.refuse(node["whole"], "whole", "'" + whole + "'", "true or false");
  factor.is_whole = whole == "true";
  if (factor.is_whole && (std::floor(factor.from) != factor.from || factor.is_log))
    reader.refuse(node["from"], "from", "no whole number, or a log scale", "a whole number on a linear scale");
  return factor;
}

void read_points(const Reader& reader, const YAML::Node& root, Study& study) {
  const YAML::Node node = root["points"];
  if (!node || !node.IsSequence() || node.size() == 0)
    reader.refuse(node ? node : root, "points", "no list", "a list of mappings, a value for each factor");
  std::vector<std::string> names;
  for (const Factor& factor : study.factors) names.push_back(factor.name);
  for (const YAML::Node& point : node) {
    reader.expect_keys(point, "points", names);
    std::vector<std::string> values;
    for (const std::string& name : names) {
      if (!point[name]) reader.refuse(point, name, "nothing", "a value for each factor");
      values.push_back(reader.value(point[name], name));
    }
    study.points.push_back(std::move(values));
  }
  study.point_count = study.points.size();
}

/// Rows leave no files but recordings, each one of its own: two rows never write the same.
void check_recordings(const Reader& reader, const YAML::Node& root, const Study& study) {
  const auto found = std::ranges::find(study.factors, "--record", &Factor::option);
  if (found == study.factors.end()) return;
  const std::size_t column = static_cast<std::size_t>(found - study.factors.begin());
  std::set<std::string> files;
  for (const std::vector<std::string>& point : study.points) {
    if (point[column] == "false") continue;
    if (study.repeat > 1 || !files.insert(point[column]).second)
      reader.refuse(root["points"], found->name, "'" + point[column] + "' for more than one row", "a file of its own");
  }
}

void read_design(const Reader& reader, const YAML::Node& root, Study& study) {
  const std::vector<std::string> words = {"grid", "list", "random", "sobol"};
  const std::string design = reader.word(root, "design", "grid");
  const auto found = std::ranges::find(words, design);
  if (found == words.end()) reader.refuse(root["design"], "design", "'" + design + "'", "grid, list, random or sobol");
  study.design = static_cast<Design>(found - words.begin());
  if (root["factors"]) {
    if (!root["factors"].IsSequence()) reader.refuse(root["factors"], "factors", "no list", "a list");
    for (const YAML::Node& node : root["factors"]) {
      study.factors.push_back(read_factor(reader, node, study.design));
      const std::string& name = study.factors.back().name;
      static const std::vector<std::string> kTaken = {"row", "point", "repeat", "row_seed", "exit", "error", "inputs"};
      if (std::ranges::find(kTaken, name) != kTaken.end())
        reader.refuse(node, "name", "'" + name + "'", "another name: each table has a column of this one");
      if (std::ranges::count(study.factors, name, &Factor::name) > 1)
        reader.refuse(node, "name", "'" + name + "' again", "a name of its own");
    }
  }
  const bool is_drawn = study.design == Design::Random || study.design == Design::Sobol;
  if (!is_drawn && root["rows"]) reader.refuse(root["rows"], "rows", "with a " + design, "none: the factors tell");
  if (study.design != Design::List && root["points"])
    reader.refuse(root["points"], "points", "with a " + design, "none");
  if (study.design == Design::List) return read_points(reader, root, study);
  if (study.design == Design::Sobol && study.factors.size() > kMostSobolDimensions)
    reader.refuse(root["factors"], "factors", std::to_string(study.factors.size()), "at most 21 in a sobol design");
  study.point_count = 1;
  if (is_drawn) {
    study.point_count = reader.whole(root, "rows", 1, kMostRows);
    return;
  }
  for (const Factor& factor : study.factors) {
    study.point_count *= factor.values.size();
    if (study.point_count > kMostRows) reader.refuse(root["factors"], "factors", "too many combinations", "1e7 rows");
  }
}

void read_options(const Reader& reader, const YAML::Node& root, Study& study) {
  const YAML::Node options = root["options"];
  if (!options) return;
  if (!options.IsMap()) reader.refuse(options, "options", "no mapping", "options of the verb with their values");
  for (const auto& entry : options) {
    const std::string option = entry.first.IsScalar() ? entry.first.Scalar() : "";
    expect_option(reader, entry.first, option);
    if (option == "--json" || option == "-o" || option == "--record")
      reader.refuse(entry.first, "options", option, "another option: rows print JSON and leave no files");
    const std::vector<std::string> values = entry.second.IsSequence()
                                                ? reader.list(entry.second, option)
                                                : std::vector<std::string>{reader.value(entry.second, option)};
    for (const std::string& value : values) {
      if (value == "false") continue;
      study.options.push_back(option);
      if (value != "true") study.options.push_back(value);
    }
  }
}

void read_outputs(const Reader& reader, const YAML::Node& root, Study& study) {
  const YAML::Node outputs = root["outputs"];
  if (!outputs) return;
  if (!outputs.IsSequence()) reader.refuse(outputs, "outputs", "no list", "names of numbers of the result");
  for (const YAML::Node& node : outputs) {
    Output output;
    if (node.IsScalar()) {
      output.name = node.Scalar();
    } else {
      reader.expect_keys(node, "outputs", {"name", "worst"});
      output.name = reader.word(node, "name");
      const std::string worst = reader.word(node, "worst", "low");
      if (worst != "low" && worst != "high") reader.refuse(node["worst"], "worst", "'" + worst + "'", "low or high");
      output.is_worst_low = worst == "low";
    }
    if (output.name.empty()) reader.refuse(node, "outputs", "nothing", "a name");
    study.outputs.push_back(std::move(output));
  }
}

Study read(const Reader& reader, const YAML::Node& root) {
  reader.expect_keys(root, "study",
                     {"name", "verb", "scenario", "options", "design", "rows", "seed", "repeat", "seed_option",
                      "seed_by", "factors", "points", "outputs", "chunk", "time_limit", "slurm"});
  Study study;
  study.verb = reader.word(root, "verb");
  if (study.verb.empty() || study.verb[0] == '-' || study.verb == "study")
    reader.refuse(root, "verb", "'" + study.verb + "'", "a verb that prints JSON, such as pack or simulate");
  study.name = reader.word(root, "name");
  study.scenario = reader.word(root, "scenario");
  if (study.scenario.starts_with('-')) reader.refuse(root["scenario"], "scenario", study.scenario, "a file");
  if (root["seed"]) study.seed = reader.whole(root, "seed", 0, UINT64_MAX);
  if (root["repeat"]) study.repeat = static_cast<int>(reader.whole(root, "repeat", 1, 1'000'000));
  study.seed_option = reader.word(root, "seed_option", "--seed");
  if (study.seed_option == "none") study.seed_option.clear();
  if (!study.seed_option.empty())
    expect_option(reader, root["seed_option"] ? root["seed_option"] : root, study.seed_option);
  const std::string seed_by = reader.word(root, "seed_by", "row");
  if (seed_by != "row" && seed_by != "repeat")
    reader.refuse(root["seed_by"], "seed_by", "'" + seed_by + "'", "row or repeat");
  study.seed_by = seed_by == "row" ? SeedBy::Row : SeedBy::Repeat;
  read_design(reader, root, study);
  check_recordings(reader, root, study);
  if (study.point_count * static_cast<std::uint64_t>(study.repeat) > kMostRows)
    reader.refuse(root, "repeat", std::to_string(study.repeat), "at most 1e7 rows in all");
  read_options(reader, root, study);
  for (const Factor& factor : study.factors) {
    if (!factor.option.empty() && factor.option == study.seed_option) study.seed_option.clear();  // a factor gives it
  }
  if (std::ranges::find(study.options, study.seed_option) != study.options.end()) study.seed_option.clear();
  read_outputs(reader, root, study);
  study.chunk =
      root["chunk"] ? static_cast<int>(reader.whole(root, "chunk", 1, 1'000'000)) : default_chunk(study.rows());
  if (root["time_limit"]) study.time_limit = reader.number(root, "time_limit", 0.001, 1e7);
  if (root["slurm"]) {
    if (!root["slurm"].IsMap())
      reader.refuse(root["slurm"], "slurm", "no mapping", "options of sbatch with their values");
    for (const auto& entry : root["slurm"])
      study.slurm.emplace_back(entry.first.Scalar(), reader.value(entry.second, entry.first.Scalar()));
  }
  return study;
}

}  // namespace

Study load_study(const std::filesystem::path& path) {
  Study study = parse_study(read_file(path, "a study (YAML)"), path.string());
  if (study.name.empty()) study.name = path.stem().string();
  return study;
}

Study parse_study(std::string_view text, const std::string& name) {
  model::check_yaml(text, name);
  try {
    Study study = read(Reader(name), YAML::Load(std::string(text)));
    study.source = name;
    study.text = std::string(text);
    return study;
  } catch (const YAML::Exception& error) {
    throw InputError(name + ":" + std::to_string(error.mark.line + 1), "", error.msg, "YAML that can be read");
  }
}

}  // namespace snug::study
