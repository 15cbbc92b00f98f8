// check_yaml: is this text one YAML document that does not grow beyond measure when it is read.
#include "snug/model/yaml_limits.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::model {
namespace {

std::size_t most_values(std::size_t bytes) {
  return kMostYamlValues + (bytes > kFewYamlBytes ? (bytes - kFewYamlBytes) / kBytesPerYamlValue : 0);
}

[[noreturn]] void refuse_count(const std::string& where, std::size_t most) {
  throw InputError(where, "", "more than " + std::to_string(most) + " values (an alias is all that it stands for)",
                   "at most so many");
}

/// The parser keeps all of a list in brackets before it tells of its first value.
void check_brackets(std::string_view text, std::string_view name) {
  const auto marks = std::count_if(text.begin(), text.end(), [](char c) { return c == ',' || c == '[' || c == '{'; });
  if (static_cast<std::size_t>(marks) > 2 * kMostYamlValues) refuse_count(std::string(name), kMostYamlValues);
}

std::string where_of(std::string_view name, const YAML::Mark& mark) {
  return std::string(name) + ":" + std::to_string(mark.is_null() ? 1 : mark.line + 1);
}

/// Counts the values of a document while it is parsed, before anything is made of it.
class Counter final : public YAML::EventHandler {
 public:
  Counter(std::string_view name, std::size_t most) : name_(name), most_(most) {}
  /// Where the newest document starts.
  [[nodiscard]] const YAML::Mark& start() const { return start_; }

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add_leaf(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string&) override {
    add_leaf(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = count_of_.find(anchor);
    if (known == count_of_.end()) {
      throw InputError(where_of(name_, mark), "", "a value that contains itself", "values without circles");
    }
    add(mark, known->second);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnMapEnd() override { end(); }

 private:
  /// A list or mapping whose end is still to come.
  struct Open {
    YAML::Mark mark;
    YAML::anchor_t anchor = 0;
    std::size_t count = 1;
  };

  void add(const YAML::Mark& mark, std::size_t count) {
    // The root's is the sum of all: nothing that it holds has more.
    if (open_.empty()) return;
    open_.back().count += count;
    total_ += count;
    if (total_ > most_ || open_.back().count > most_) refuse_count(where_of(name_, mark), most_);
  }
  void add_leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) count_of_[anchor] = 1;
    add(mark, 1);
  }
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor) { open_.push_back({mark, anchor}); }
  void end() {
    const Open done = open_.back();
    open_.pop_back();
    if (done.anchor != 0) count_of_[done.anchor] = done.count;
    total_ += 1;
    if (!open_.empty()) open_.back().count += done.count;
  }

  std::string_view name_;
  std::size_t most_;
  YAML::Mark start_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::size_t> count_of_;  ///< of values that are complete
  std::size_t total_ = 0;
};

}  // namespace

void check_yaml(std::string_view text, std::string_view name) {
  if (text.size() > kLargestYaml) {
    throw InputError(std::string(name), "", std::to_string(text.size()) + " bytes",
                     "YAML of at most " + std::to_string(kLargestYaml) + " bytes");
  }
  check_utf8(text, name);
  check_brackets(text, name);
  // YAML::Load takes the first document and silently drops what follows, be it a second one or the rest after a stray
  // bracket; YAML::LoadAll never returns when it meets a stray comma.
  std::istringstream stream{std::string(text)};
  Counter counter(name, most_values(text.size()));
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(counter))
      throw InputError(std::string(name) + ":1", "", "nothing", "a YAML document");
    if (parser.HandleNextDocument(counter)) {
      throw InputError(where_of(name, counter.start()), "", "something after the end of the YAML document",
                       "one document and nothing else (look for a stray bracket, comma or ---)");
    }
  } catch (const YAML::Exception& error) {
    throw InputError(where_of(name, error.mark), "", error.msg, "YAML that can be parsed");
  }
}

}  // namespace snug::model
