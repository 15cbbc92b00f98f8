// Elements of the files of a scene.
#include "snug/scene_import/internal/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr std::size_t kMostFiles = 200;
constexpr double kLargestNumber = 1e12;  // as in scenarios

}  // namespace

std::string Node::title() const {
  const char* name = element_->Attribute("name");
  return name == nullptr ? tag() : tag() + " '" + printable(name, 60) + "'";
}

void Node::fail(const std::string& got, const std::string& expected) const {
  throw InputError(file_->name + ":" + std::to_string(line()), printable(title(), 80), printable(got, 200), expected);
}

std::string Node::attribute(const char* key, const std::string& fallback) const {
  const char* value = element_->Attribute(key);
  if (value == nullptr) return fallback;
  if (!is_utf8(value)) fail(std::string(key) + " that is not UTF-8", "UTF-8");  // &#xd800; and the like
  return value;
}

std::string Node::text() const {
  const char* text = element_->GetText();
  if (text == nullptr) return "";
  std::string_view all = text;
  while (!all.empty() && std::string_view(" \t\r\n").find(all.front()) != std::string_view::npos) all.remove_prefix(1);
  while (!all.empty() && std::string_view(" \t\r\n").find(all.back()) != std::string_view::npos) all.remove_suffix(1);
  if (!is_utf8(all)) fail("a text that is not UTF-8", "UTF-8");
  return std::string(all);
}

std::vector<Node> Node::children() const {
  std::vector<Node> all;
  for (const auto* e = element_->FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
    all.emplace_back(e, file_);
  return all;
}

std::optional<Node> Node::child(const char* tag) const {
  const tinyxml2::XMLElement* found = element_->FirstChildElement(tag);
  if (found == nullptr) return std::nullopt;
  return Node(found, file_);
}

std::string Node::child_text(const char* tag, const std::string& fallback) const {
  const std::optional<Node> found = child(tag);
  return found ? found->text() : fallback;
}

std::vector<double> Node::numbers(const std::string& text, const std::string& key, std::size_t least,
                                  std::size_t most) const {
  std::vector<double> values;
  std::string_view rest = text;
  const std::string count = least == most ? std::to_string(least) : fmt::format("{} to {}", least, most);
  const auto refuse = [&] {
    fail(key + " \"" + text + "\"", count + (most == 1 ? " finite number" : " finite numbers"));
  };
  constexpr std::string_view kBlank = " \t\r\n";
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
    if (rest.empty()) break;
    const std::string_view word = rest.substr(0, rest.find_first_of(kBlank));
    double value = 0.0;
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= kLargestNumber) ||
        values.size() == most)
      refuse();
    values.push_back(value);
    rest.remove_prefix(word.size());
  }
  if (values.size() < least) refuse();
  return values;
}

double Node::number(const std::string& text, const std::string& key) const { return numbers(text, key, 1, 1)[0]; }

Vector3 Node::vector(const std::string& text, const std::string& key) const {
  const std::vector<double> v = numbers(text, key, 3, 3);
  return {v[0], v[1], v[2]};
}

int Node::whole(const std::string& text, const std::string& key) const {
  const double value = number(text, key);
  if (!(std::abs(value) <= 1e6) || value != std::round(value)) fail(key + " \"" + text + "\"", "a whole number");
  return static_cast<int>(value);
}

bool Node::yes_or_no(const std::string& text, const std::string& key) const {
  if (text == "true" || text == "1" || text == "enable") return true;
  if (text == "false" || text == "0" || text == "disable" || text == "auto") return false;
  fail(key + " \"" + text + "\"", "true or false");
}

const XmlFile& XmlFiles::parse(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  bytes_ += text.size();
  if (files_.size() == kMostFiles || bytes_ > 4 * kLargestScene)
    throw InputError(name, "", fmt::format("more than {} files, or {} MB in all", kMostFiles, 4 * kLargestScene >> 20U),
                     "a scene of fewer");
  check_utf8(text, name);
  files_.push_back(std::make_unique<XmlFile>());
  XmlFile& file = *files_.back();
  file.name = name;
  file.folder = folder;
  if (file.document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(name + ":" + std::to_string(std::max(1, file.document.ErrorLineNum())), "",
                     file.document.ErrorName(), "XML that can be parsed");
  return file;
}

const XmlFile& XmlFiles::load(const std::filesystem::path& path) {
  return parse(read_file(path, "a scene, MJCF (.xml) or SDF (.sdf)", kLargestScene), path.string(), path.parent_path());
}

Node XmlFiles::root_of(const XmlFile& file) {
  if (file.document.RootElement() == nullptr) throw InputError(file.name + ":1", "", "no element", "<mujoco> or <sdf>");
  return {file.document.RootElement(), &file};
}

}  // namespace snug::scene_import::internal
