// ApiForms: what requests and answers of the interface of `snug ui` look like, once.
#include "snug/workspace/api_forms.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "snug/core/text.hpp"

namespace snug::workspace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kThree = "[number, number, number]";

/// The parts of a type between separators that stand outside brackets.
std::vector<std::string_view> split_type(std::string_view type, std::string_view separator) {
  std::vector<std::string_view> parts;
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < type.size(); ++i) {
    if (type[i] == '[' || type[i] == '<') ++depth;
    if (type[i] == ']' || type[i] == '>') --depth;
    if (depth != 0 || !type.substr(i).starts_with(separator)) continue;
    parts.push_back(type.substr(begin, i - begin));
    i += separator.size() - 1;
    begin = i + 1;
  }
  parts.push_back(type.substr(begin));
  return parts;
}

std::string deviation(const Json& json, std::string_view type, const std::string& path);

std::string deviation_of_list(const Json& json, std::string_view type, const std::string& path) {
  for (std::size_t i = 0; i < json.size(); ++i) {
    std::string found = deviation(json[i], type, path + std::to_string(i) + ".");
    if (!found.empty()) return found;
  }
  return {};
}

std::string deviation_of_form(const Json& json, const ApiForm& form, const std::string& path) {
  for (const ApiField& field : form.fields) {
    const bool is_optional = field.name.ends_with('?');
    const std::string key(field.name.substr(0, field.name.size() - (is_optional ? 1 : 0)));
    const auto found = json.find(key);
    if (found == json.end() && is_optional) continue;
    if (found == json.end()) return path + key + ": missing";
    std::string inner = deviation(*found, field.type, path + key + ".");
    if (!inner.empty()) return inner;
  }
  for (const auto& entry : json.items()) {
    const std::string& key = entry.key();
    const bool is_known = std::ranges::any_of(form.fields, [&](const ApiField& field) {
      return field.name == key || (field.name.ends_with('?') && field.name.substr(0, field.name.size() - 1) == key);
    });
    if (!is_known) return path + key + ": not in " + std::string(form.name);
  }
  return {};
}

/// Empty where it is of the type; else where the last of several types is not met.
std::string deviation(const Json& json, std::string_view type, const std::string& path) {
  const std::string no = path + " " + printable(json.dump(), 60) + " instead of " + std::string(type);
  if (const auto choices = split_type(type, " | "); choices.size() > 1) {
    std::string last;
    for (const std::string_view one : choices) {
      last = deviation(json, one, path);
      if (last.empty()) return {};
    }
    return last;
  }
  if (type.ends_with("[]"))
    return json.is_array() ? deviation_of_list(json, type.substr(0, type.size() - 2), path) : no;
  if (type.starts_with("[")) {
    const auto parts = split_type(type.substr(1, type.size() - 2), ", ");
    if (!json.is_array() || json.size() != parts.size()) return no;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      std::string found = deviation(json[i], parts[i], path + std::to_string(i) + ".");
      if (!found.empty()) return found;
    }
    return {};
  }
  constexpr std::string_view kRecord = "Record<string, ";
  if (type.starts_with(kRecord)) {
    if (!json.is_object()) return no;
    const std::string_view inner = type.substr(kRecord.size(), type.size() - kRecord.size() - 1);
    for (const auto& [key, value] : json.items()) {
      std::string found = deviation(value, inner, path + printable(key, 40) + ".");
      if (!found.empty()) return found;
    }
    return {};
  }
  if (type.starts_with('"')) return json.is_string() && json == type.substr(1, type.size() - 2) ? std::string() : no;
  const bool is_plain = (type == "string" && json.is_string()) || (type == "number" && json.is_number()) ||
                        (type == "boolean" && json.is_boolean()) || (type == "null" && json.is_null());
  if (is_plain) return {};
  const auto form = std::ranges::find(api_forms(), type, &ApiForm::name);
  return form == api_forms().end() || !json.is_object() ? no : deviation_of_form(json, *form, path);
}

}  // namespace

const std::vector<ApiForm>& api_forms() {
  static const std::vector<ApiForm> all = {
      {"Mistake",
       "What is wrong with a text.",
       {{"where", "string", ""},
        {"line", "number | null", ""},
        {"key", "string", ""},
        {"got", "string", ""},
        {"expected", "string", ""},
        {"text", "string", "all of it, for people"}}},
      {"Refusal", "What the program says no with.", {{"error", "string", ""}, {"mistake?", "Mistake", ""}}},
      {"ItemLine",
       "A line of items.",
       {{"line", "number", ""},
        {"order", "string", ""},
        {"article", "string", ""},
        {"size_mm", kThree, ""},
        {"mass_kg", "number", ""},
        {"count", "number", ""}}},
      {"ContainerFacts", "", {{"name", "string", ""}, {"inner_size_mm", kThree, ""}, {"walls", "boolean", ""}}},
      {"Facts",
       "Of a scenario (containers, target, cup), of items (lines) or of an arm (robot, links).",
       {{"sequences?", "string[]", ""},
        {"lines?", "ItemLine[]", ""},
        {"containers?", "ContainerFacts[]", ""},
        {"target?", "string", ""},
        {"cup_radius_mm?", "number", ""},
        {"robot?", "string", ""},
        {"links?", "string[]", "that can carry the tool"}}},
      {"Checked",
       "",
       {{"text", "string", ""},
        {"mistake", "Mistake | null", ""},
        {"mistakes?", "Mistake[]", "of items: one of each line that has any, the first ones"},
        {"facts", "Facts | null", ""}}},
      {"Written", "", {{"name", "string", ""}, {"facts", "Facts", ""}}},
      {"SheetAnswers",
       "Answers to what a sheet leaves open: mm, cm, m or in; kg, g or lb; point or comma.",
       {{"length?", "string", ""}, {"mass?", "string", ""}, {"decimal?", "string", ""}}},
      {"SheetChoice", "", {{"answer", "string", ""}, {"meaning", "string", "for the first box"}}},
      {"SheetQuestion", "", {{"about", "string", "a member of SheetAnswers"}, {"choices", "SheetChoice[]", ""}}},
      {"SheetColumn", "", {{"heading", "string", ""}, {"column", "string", "empty: passed over"}}},
      {"TypicalOrders",
       "",
       {{"orders", "number", ""}, {"boxes", "number", "of an order, on average"}, {"seed", "number", ""}}},
      {"TypicalDrawn", "", {{"orders", "string", "a CSV"}, {"command", "string", ""}}},
      {"SheetRead",
       "",
       {{"orders", "string", "empty with questions"},
        {"columns", "SheetColumn[]", ""},
        {"questions", "SheetQuestion[]", ""},
        {"command", "string", ""}}},
      {"TemplateArm", "", {{"name", "string", ""}, {"text", "string", ""}}},
      {"TemplateText", "A scenario to begin with.", {{"text", "string", ""}, {"arm", "TemplateArm | null", ""}}},
      {"CellPart",
       "A part of a cell that can be moved.",
       {{"key", "string", ""}, {"name", "string", ""}, {"position_mm", kThree, ""}, {"yaw_deg", "number", ""}}},
      {"CellScene",
       "",
       {{"parts", "CellPart[]", ""}, {"has_robot", "boolean", ""}, {"form", "string", "replay form, base64"}}},
      {"CellMove", "", {{"key", "string", ""}, {"position_mm", kThree, ""}, {"yaw_deg", "number", ""}}},
      {"EditedText",
       "",
       {{"text", "string", ""},
        {"links?", "string[]", "of an arm"},
        {"tool?", "string", ""},
        {"command?", "string", "of a cup"},
        {"pull_off_N?", kThree, "of a cup: low, expected, high"}}},
      {"CupSheet",
       "",
       {{"diameter_mm", "number", ""},
        {"bellows", "number", "folds: 0, 1.5 or 2.5"},
        {"material", "string", ""},
        {"lip", "string", ""},
        {"vacuum_kPa", "number", "gauge, negative"},
        {"stroke_mm?", "number | null", ""}}},
      {"ReachLayer",
       "",
       {{"name", "string", ""}, {"height", "number", ""}, {"verdicts", "number[]", ""}, {"whats", "number[]", ""}}},
      {"ReachPick",
       "",
       {{"item", "string", ""},
        {"count", "number", ""},
        {"position", kThree, ""},
        {"verdict", "number", ""},
        {"what", "number", ""}}},
      {"ReachMap",
       "Where over the container and at the picks the tool can stand; metres.",
       {{"robot", "string", ""},
        {"container", "string", ""},
        {"pose", "[number, number, number, number, number, number, number]", "x, y, z, qw, qx, qy, qz"},
        {"inner_size", kThree, ""},
        {"columns", "number", ""},
        {"rows", "number", ""},
        {"tool_yaw", "number", ""},
        {"verdicts", "string[]", ""},
        {"whats", "string[]", ""},
        {"counts", "Record<string, number>", ""},
        {"layers", "ReachLayer[]", ""},
        {"picks", "ReachPick[]", ""}}},
      {"BoxEnd",
       "",
       {{"id", "string", ""}, {"end", "string", ""}, {"reason", "string", ""}, {"packed", "boolean", ""}}},
      {"RunStatus",
       "",
       {{"name", "string", ""},
        {"state",
         "\"waiting\" | \"running\" | \"done\" | \"failed\" | \"ended early\" | \"not started\" | \"being read\"", ""},
        {"can_be_stopped", "boolean", ""},
        {"command", "string", ""},
        {"message", "string", ""},
        {"sequence", "string", ""},
        {"plant", "string", ""},
        {"items", "number", ""},
        {"done", "number", ""},
        {"packed", "number", ""},
        {"lost", "number", ""},
        {"percent", "number", "of the container's volume"},
        {"time", "number", "s, of the plant"},
        {"stopped", "string", ""},
        {"files", "string[]", ""},
        {"now", "string", "item under way"},
        {"held", "string", "item at which the run waits for the operator"},
        {"boxes?", "BoxEnd[]", "not in the list of the folder"}}},
      {"FolderFile", "", {{"name", "string", ""}, {"bytes", "number", ""}}},
      {"TemplateName", "", {{"name", "string", ""}, {"description", "string", ""}}},
      {"FolderList",
       "",
       {{"folder", "string", ""},
        {"version", "string", ""},
        {"can_be_written", "boolean", "if false, nothing can be saved or run"},
        {"scenarios", "FolderFile[]", ""},
        {"items", "FolderFile[]", ""},
        {"arms", "FolderFile[]", ""},
        {"runs", "RunStatus[]", ""},
        {"templates", "TemplateName[]", ""}}},
      {"RunRequest",
       "",
       {{"name", "string", ""},
        {"scenario", "string", ""},
        {"items", "string", ""},
        {"sequence", "string", ""},
        {"plants", "number", ""},
        {"plant_seed", "number", ""},
        {"tempo", "number | null", ""},
        {"resumes", "string", ""},
        {"plant?", "string", "of another program: click://HOST:PORT, ur://HOST"},
        {"observe?", "string", ""},
        {"perception?", "string", ""},
        {"moves_a_robot?", "boolean", ""},
        {"holds?", "boolean", "the run waits for the operator at the first box"}}},
      {"RunCommand", "", {{"name", "string", ""}, {"command", "string", ""}}},
      {"RunCommands", "", {{"runs", "RunCommand[]", ""}}},
      {"CatalogueContainer",
       "",
       {{"name", "string", ""}, {"pallet", "boolean", ""}, {"inner_size_mm", kThree, ""}, {"source", "string", ""}}},
      {"CatalogueCup",
       "",
       {{"key", "string", ""},
        {"diameter_mm", "number", ""},
        {"bellows", "number", ""},
        {"lip", "string", ""},
        {"pull_off_N", kThree, "low, expected, high"},
        {"command", "string", ""}}},
      {"Catalogue", "", {{"containers", "CatalogueContainer[]", ""}, {"cups", "CatalogueCup[]", ""}}},
      {"Candidate",
       "A place that was tried.",
       {{"position_mm", kThree, ""},
        {"verdict", "string", ""},
        {"insertion", "string", ""},
        {"expected_percent", "number", ""},
        {"cost", "number | null", ""},
        {"utility", "number | null", ""},
        {"samples", "number", ""},
        {"success_rate", "number", ""},
        {"failure", "string", ""},
        {"reason", "string", ""}}},
      {"PlannedPlace",
       "",
       {{"position_mm", kThree, ""},
        {"insertion", "string", ""},
        {"reorientation", "string", ""},
        {"predicted_success", "number", ""},
        {"samples", "number", ""}}},
      {"Forces",
       "",
       {{"force_N", "number", ""}, {"torque_Nm", "number", ""}, {"displacement_mm", "number | null", ""}}},
      {"Happened",
       "",
       {{"force_N", "number", ""},
        {"torque_Nm", "number", ""},
        {"position_mm", "[number, number, number] | null", ""},
        {"position_error_mm", "number | null", ""},
        {"angle_error_deg", "number | null", ""},
        {"displacement_mm", "number | null", ""}}},
      {"Trouble",
       "",
       {{"time", "number", ""}, {"trouble", "string", ""}, {"remedy", "string", ""}, {"detail", "string", ""}}},
      {"OperatorOrder",
       "",
       {{"time", "number", ""}, {"order", "string", ""}, {"was_followed", "boolean", ""}, {"text", "string", ""}}},
      {"Decision",
       "One decision on one item: what was tried, what was expected, what came of it. Positions are in the container's "
       "frame.",
       {{"item", "string", ""},
        {"time", "number", ""},
        {"outcome", "string", ""},
        {"reason", "string", ""},
        {"planning_seconds", "number", ""},
        {"waited_seconds", "number", ""},
        {"candidates", "Candidate[]", ""},
        {"candidates_in_all", "number", ""},
        {"extent_mm", "[number, number, number] | null", ""},
        {"planned?", "PlannedPlace", ""},
        {"predicted?", "Forces", ""},
        {"happened", "Happened | null", ""},
        {"end", "string", ""},
        {"end_reason", "string", ""},
        {"troubles", "Trouble[]", ""},
        {"operator", "OperatorOrder[]", ""}}},
      {"StandingBox", "", {{"item", "string", ""}, {"position_mm", kThree, ""}, {"extent_mm", kThree, ""}}},
      {"Decisions",
       "",
       {{"items", "string[]", ""},
        {"decisions", "Decision[]", ""},
        {"standing", "StandingBox[]", ""},
        {"held", "string", ""},
        {"now", "string", ""}}},
      {"Made", "", {{"made", "string", ""}, {"command", "string", ""}}},
      {"Said", "", {{"said", "string", ""}, {"command", "string", ""}}},
  };
  return all;
}

std::string format_api_types() {
  std::string text =
      "// Requests and answers of `snug ui` (docs/ui-interface.md) as types.\n"
      "// Written by the test ApiForms.AreWhatThePageReads; the forms stand in src/snug/workspace/api_forms.cpp.\n";
  for (const ApiForm& form : api_forms()) {
    text += '\n';
    if (!form.note.empty()) text += "/** " + std::string(form.note) + " */\n";
    text += "export interface " + std::string(form.name) + " {\n";
    for (const ApiField& field : form.fields) {
      text += "  " + std::string(field.name) + ": " + std::string(field.type) + ";";
      if (!field.note.empty()) text += " // " + std::string(field.note);
      text += '\n';
    }
    text += "}\n";
  }
  return text;
}

std::string find_deviation(const Json& json, std::string_view type) { return deviation(json, type, ""); }

}  // namespace snug::workspace
