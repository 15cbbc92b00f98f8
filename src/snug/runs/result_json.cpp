// Results as JSON: the keys of a result, written, read and as types.
#include "snug/runs/result_json.hpp"

#include <fmt/format.h>

#include <charconv>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>

#include "snug/runs/internal/result_fields.hpp"

namespace snug::runs {
namespace {

using Json = nlohmann::ordered_json;
using internal::Derived;
using internal::fields;
using internal::FromOne;
using internal::Hash;
using internal::IfAny;
using internal::Letter;
using internal::Pair;
using internal::Scaled;

template <class T>
concept Word = std::is_enum_v<T>;
template <class T>
concept Group = requires(T& value) {
  internal::type_name(value);
};
template <class T>
concept Number = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;

Json as_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const Pose& X) {
  const Quaternion q(X.R);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return {{"p", as_json(X.p)}, {"quat_wxyz", {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()}}};
}

class Writer {
 public:
  template <Group T>
  static Json of(const T& group) {
    Writer writer;
    T copy = group;
    fields(writer, copy);
    return std::move(writer.json_);
  }

  template <Number T>
  void operator()(const char* key, T& value) {
    json_[key] = value;
  }
  void operator()(const char* key, bool& value) { json_[key] = value; }
  void operator()(const char* key, std::string& value) { json_[key] = value; }
  void operator()(const char* key, std::vector<std::string>& value) { json_[key] = value; }
  void operator()(const char* key, Vector3& value) { json_[key] = as_json(value); }
  void operator()(const char* key, Pose& value) { json_[key] = as_json(value); }
  void operator()(const char* key, Scaled value) { json_[key] = value.value * value.per; }
  void operator()(const char* key, FromOne value) { json_[key] = value.value + 1; }
  void operator()(const char* key, Letter value) { json_[key] = std::string(1, value.value); }
  void operator()(const char* key, Hash value) { json_[key] = fmt::format("{:016x}", value.value); }
  void operator()(const char* key, Pair value) { json_[key] = {value.first, value.second}; }
  void operator()(const char* key, Derived value) { json_[key] = value.value; }
  void operator()(const char* key, IfAny value) {
    if (!value.text.empty()) json_[key] = value.text;
  }
  template <Word T>
  void operator()(const char* key, T& value) {
    json_[key] = name_of(value);
  }
  template <Group T>
  void operator()(const char* key, T& value) {
    json_[key] = of(value);
  }
  template <Group T>
  void operator()(const char* key, std::optional<T>& value) {
    json_[key] = value ? of(*value) : Json(nullptr);
  }
  template <Group T>
  void operator()(const char* key, std::vector<T>& values) {
    Json list = Json::array();
    for (const T& value : values) list.push_back(of(value));
    json_[key] = std::move(list);
  }
  void others(std::vector<record::EventNumber>& numbers) {
    for (const record::EventNumber& number : numbers) json_[number.name] = number.value;
  }

 private:
  Json json_ = Json::object();
};

/// A key that is there with something else than it should be ends it.
struct Unreadable {};

class Reader {
 public:
  template <Group T>
  static T of(const Json& json) {
    if (!json.is_object()) throw Unreadable{};
    Reader reader(json);
    T group{};
    fields(reader, group);
    return group;
  }

  template <Number T>
  void operator()(const char* key, T& value) {
    if (const Json* json = find(key)) value = number<T>(*json);
  }
  void operator()(const char* key, bool& value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    if (!json->is_boolean()) throw Unreadable{};
    value = json->get<bool>();
  }
  void operator()(const char* key, std::string& value) {
    if (const Json* json = find(key)) value = text(*json);
  }
  void operator()(const char* key, std::vector<std::string>& value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    value.clear();
    for (const Json& one : list(*json)) value.push_back(text(one));
  }
  void operator()(const char* key, Vector3& value) {
    if (const Json* json = find(key)) value = vector(*json);
  }
  void operator()(const char* key, Pose& value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    if (!json->is_object()) throw Unreadable{};
    Reader parts(*json);
    parts("p", value.p);
    const Json* quat = parts.find("quat_wxyz");
    if (quat == nullptr) return;
    if (list(*quat).size() != 4) throw Unreadable{};
    const Quaternion q(number<double>((*quat)[0]), number<double>((*quat)[1]), number<double>((*quat)[2]),
                       number<double>((*quat)[3]));
    if (!(std::abs(q.norm() - 1.0) < 1e-3)) throw Unreadable{};
    value.R = q.normalized().toRotationMatrix();
  }
  void operator()(const char* key, Scaled value) {
    if (const Json* json = find(key)) value.value = number<double>(*json) / value.per;
  }
  void operator()(const char* key, FromOne value) {
    if (const Json* json = find(key)) value.value = number<int>(*json) - 1;
  }
  void operator()(const char* key, Letter value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    if (text(*json).size() != 1) throw Unreadable{};
    value.value = text(*json)[0];
  }
  void operator()(const char* key, Hash value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    const std::string digits = text(*json);
    const char* const end = digits.data() + digits.size();
    const auto read = std::from_chars(digits.data(), end, value.value, 16);
    if (read.ec != std::errc() || read.ptr != end) throw Unreadable{};
  }
  void operator()(const char* key, Pair value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    if (list(*json).size() != 2) throw Unreadable{};
    value.first = text((*json)[0]);
    value.second = text((*json)[1]);
  }
  void operator()(const char* key, Derived /*value*/) { (void)find(key); }
  void operator()(const char* key, IfAny value) {
    if (const Json* json = find(key)) value.text = text(*json);
  }
  template <Word T>
  void operator()(const char* key, T& value) {
    const Json* json = find(key);
    if (json == nullptr) return;
    const std::string word = text(*json);
    for (const T one : internal::all_of(T{})) {
      if (word != name_of(one)) continue;
      value = one;
      return;
    }
    throw Unreadable{};
  }
  template <Group T>
  void operator()(const char* key, T& value) {
    if (const Json* json = find(key)) value = of<T>(*json);
  }
  template <Group T>
  void operator()(const char* key, std::optional<T>& value) {
    const Json* json = find(key);
    if (json != nullptr && !json->is_null()) value = of<T>(*json);
  }
  template <Group T>
  void operator()(const char* key, std::vector<T>& values) {
    const Json* json = find(key);
    if (json == nullptr) return;
    values.clear();
    for (const Json& one : list(*json)) values.push_back(of<T>(one));
  }
  /// All keys that nobody asked for.
  void others(std::vector<record::EventNumber>& numbers) {
    for (const auto& [key, value] : json_.items()) {
      if (!asked_.contains(key)) numbers.push_back({key, number<double>(value)});
    }
  }

 private:
  explicit Reader(const Json& json) : json_(json) {}

  const Json* find(const char* key) {
    asked_.insert(key);
    const auto found = json_.find(key);
    return found != json_.end() ? &*found : nullptr;
  }
  static std::string text(const Json& json) {
    if (!json.is_string()) throw Unreadable{};
    return json.get<std::string>();
  }
  static const Json& list(const Json& json) {
    if (!json.is_array()) throw Unreadable{};
    return json;
  }
  /// JSON has no numbers that are not finite: they are written as null.
  template <Number T>
  static T number(const Json& json) {
    if (json.is_null() && std::is_floating_point_v<T>) return std::numeric_limits<T>::quiet_NaN();
    if (!json.is_number()) throw Unreadable{};
    return json.get<T>();
  }
  static Vector3 vector(const Json& json) {
    if (list(json).size() != 3) throw Unreadable{};
    return {number<double>(json[0]), number<double>(json[1]), number<double>(json[2])};
  }

  const Json& json_;
  std::set<std::string> asked_;
};

class Types {
 public:
  /// The interfaces of a group and of what is in it, each once, the inner ones first.
  template <Group T>
  void add(const T& group) {
    if (!known_.insert(internal::type_name(group)).second) return;
    std::string outer = std::exchange(body_, "");
    T copy = group;
    fields(*this, copy);
    text_ += fmt::format("\nexport interface {} {{\n{}}}\n", internal::type_name(group), body_);
    body_ = std::move(outer);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

  template <Number T>
  void operator()(const char* key, T&) {
    line(key, "number");
  }
  void operator()(const char* key, bool&) { line(key, "boolean"); }
  void operator()(const char* key, std::string&) { line(key, "string"); }
  void operator()(const char* key, std::vector<std::string>&) { line(key, "string[]"); }
  void operator()(const char* key, Vector3&) { line(key, "[number, number, number]"); }
  void operator()(const char* key, Pose&) {
    line(key, "{ p: [number, number, number]; quat_wxyz: [number, number, number, number] }");
  }
  void operator()(const char* key, Scaled) { line(key, "number"); }
  void operator()(const char* key, FromOne) { line(key, "number"); }
  void operator()(const char* key, Letter) { line(key, "string"); }
  void operator()(const char* key, Hash) { line(key, "string"); }
  void operator()(const char* key, Pair) { line(key, "[string, string]"); }
  void operator()(const char* key, Derived) { line(key, "number"); }
  void operator()(const char* key, IfAny) { line(std::string(key) + "?", "string"); }
  template <Word T>
  void operator()(const char* key, T&) {
    std::string words;
    for (const T one : internal::all_of(T{}))
      words += fmt::format("{}\"{}\"", words.empty() ? "" : " | ", name_of(one));
    line(key, words);
  }
  template <Group T>
  void operator()(const char* key, T& value) {
    line(key, internal::type_name(value));
    add(value);
  }
  template <Group T>
  void operator()(const char* key, std::optional<T>&) {
    line(key, std::string(internal::type_name(T{})) + " | null");
    add(T{});
  }
  template <Group T>
  void operator()(const char* key, std::vector<T>&) {
    line(key, std::string(internal::type_name(T{})) + "[]");
    add(T{});
  }
  void others(std::vector<record::EventNumber>&) { line("[number: string]", "number | string"); }

 private:
  void line(std::string_view key, std::string_view type) { body_ += fmt::format("  {}: {};\n", key, type); }

  std::set<std::string> known_;
  std::string body_, text_;
};

}  // namespace

std::string format_result(const RunResult& result) { return Writer::of(result).dump(2) + "\n"; }

std::optional<RunResult> read_result(std::string_view text) {
  constexpr std::size_t kLongestText = std::size_t{4} << 20U;
  constexpr int kDeepest = 32;
  if (text.size() > kLongestText) return std::nullopt;
  bool is_too_deep = false;
  const auto look = [&](int depth, Json::parse_event_t, Json&) {
    is_too_deep = is_too_deep || depth > kDeepest;
    return !is_too_deep;
  };
  const Json json = Json::parse(text, look, false);
  if (json.is_discarded() || is_too_deep) return std::nullopt;
  try {
    return Reader::of<RunResult>(json);
  } catch (const Unreadable&) {
    return std::nullopt;
  }
}

std::string format_result_types() {
  Types types;
  types.add(RunResult{});
  return "// What becomes of a run, as `snug simulate --json` prints it and recordings keep it (docs/formats.md, "
         "Result).\n"
         "// Written by the test ResultJson.IsWhatTheViewerReads; the keys stand in "
         "runs/internal/result_fields.hpp.\n" +
         types.text();
}

}  // namespace snug::runs
