// Service: the interface of `snug ui`, version 1: requests of a page answered by a folder and its runs.
#include "snug/workspace/service.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <thread>

#include "snug/core/base64.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/json_value.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/model/items_file.hpp"
#include "snug/model/items_sheet.hpp"
#include "snug/model/pose_edit.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/typical_orders.hpp"
#include "snug/replay/cell_form.hpp"
#include "snug/runs/reach_map.hpp"
#include "snug/workspace/arm_edit.hpp"
#include "snug/workspace/catalogue.hpp"
#include "snug/workspace/decision_list.hpp"

namespace snug::workspace {
namespace {

using Json = nlohmann::ordered_json;
using serve::ApiAnswer;
using serve::ApiRequest;

constexpr std::string_view kRoot = "/api/1/";
constexpr std::size_t kLargestJson = std::size_t{64} << 10U;
constexpr std::chrono::milliseconds kBetweenLooks(250);     // at a log that grows
constexpr std::chrono::milliseconds kBetweenFrames(30);     // at frames that are watched
constexpr std::chrono::milliseconds kListPatience(40);      // for reading logs that nobody has read
constexpr std::size_t kMostFrames = std::size_t{2} << 20U;  // bytes of frames in one piece
constexpr std::size_t kMostMoves = 100;
constexpr std::size_t kMostMistakes = 20;  // of items, each read anew
constexpr double kDegreesARadian = 180.0 / std::numbers::pi;
constexpr std::size_t kLargestMove = kLargestUpload + (std::size_t{64} << 10U);
/// A report has its scripts within it: it may run them, but has no address of its own, and reaches nothing.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-downloads allow-popups; default-src 'none'; script-src 'unsafe-inline' blob: data:; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; worker-src blob: data:; frame-ancestors 'none'";

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

ApiAnswer as_answer(const Json& json, int status = 200) {
  ApiAnswer answer;
  answer.status = status;
  answer.body = text_of(json);
  return answer;
}

ApiAnswer refusal(int status, const std::string& text) { return as_answer({{"error", text}}, status); }

Json as_json(const InputError& error) {
  const std::size_t colon = error.where.rfind(':');
  const std::string digits = colon == std::string::npos ? std::string() : error.where.substr(colon + 1);
  const bool has_line =
      !digits.empty() && digits.size() < 9 && std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
  return {
      {"where", printable(error.where, kLongestMessage)},       {"line", has_line ? Json(std::stoi(digits)) : Json()},
      {"key", printable(error.key, kLongestMessage)},           {"got", printable(error.got, kLongestMessage)},
      {"expected", printable(error.expected, kLongestMessage)}, {"text", printable(error.what(), 4 * kLongestMessage)}};
}

/// Without its boxes.
Json summary_of(const RunStatus& status) {
  const RunProgress& progress = status.progress;
  return {{"name", status.name},       {"state", name_of(status.state)}, {"can_be_stopped", status.can_be_stopped},
          {"command", status.command}, {"message", status.message},      {"sequence", progress.sequence},
          {"plant", progress.plant},   {"items", progress.items},        {"done", progress.done},
          {"packed", progress.packed}, {"lost", progress.lost},          {"percent", progress.planned_percent},
          {"time", progress.time},     {"stopped", progress.stopped},    {"files", status.files},
          {"now", progress.now},       {"held", progress.held}};
}

Json as_json(const RunStatus& status) {
  Json json = summary_of(status);
  Json boxes = Json::array();
  for (const BoxProgress& box : status.progress.boxes)
    boxes.push_back({{"id", box.id}, {"end", box.end}, {"reason", box.reason}, {"packed", box.is_packed}});
  json["boxes"] = std::move(boxes);
  return json;
}

/// One mistake of each line that has any, the first ones: the others are read without the lines before.
Json mistakes_of_orders(std::string text, const std::string& name) {
  Json mistakes = Json::array();
  while (mistakes.size() < kMostMistakes) {
    try {
      (void)model::parse_orders_csv(text, name);
      return mistakes;
    } catch (const InputError& error) {
      Json mistake = as_json(error);
      if (mistake["line"].is_null() && !mistakes.empty()) return mistakes;  // nothing is left
      const int line = mistake["line"].is_null() ? 0 : mistake["line"].get<int>();
      mistakes.push_back(std::move(mistake));
      if (line < 2) return mistakes;
      std::size_t begin = 0;
      for (int k = 1; k < line; ++k) begin = text.find('\n', begin) + 1;
      text.erase(begin, std::min(text.find('\n', begin), text.size()) - begin);
    }
  }
  return mistakes;
}

Json in_mm(const Vector3& size) { return {1e3 * size.x(), 1e3 * size.y(), 1e3 * size.z()}; }

/// What a form shows of a text that can be used.
Json facts_of(FileKind kind, const std::string& text, const std::string& name) {
  if (kind == FileKind::Items) {
    Json lines = Json::array(), orders = Json::array();
    std::set<std::string> known;
    for (const model::OrderLine& line : model::parse_orders_csv(text, name)) {
      lines.push_back({{"line", line.line},
                       {"order", line.order},
                       {"article", line.article},
                       {"size_mm", in_mm(line.size)},
                       {"mass_kg", line.mass},
                       {"count", line.count}});
      if (known.insert(line.order).second) orders.push_back(line.order);
    }
    return {{"lines", std::move(lines)}, {"sequences", std::move(orders)}};
  }
  if (kind == FileKind::Urdf) {
    const ArmFacts facts = read_arm_facts(text, name);
    return {{"robot", facts.name}, {"links", facts.links}};
  }
  if (kind == FileKind::Mesh) return Json::object();
  const model::Scenario scenario = model::parse_scenario(text, name);
  Json sequences = Json::array(), containers = Json::array();
  for (const model::Sequence& sequence : scenario.sequences) sequences.push_back(sequence.name);
  for (const model::Container& container : scenario.containers)
    containers.push_back(
        {{"name", container.name}, {"inner_size_mm", in_mm(container.inner_size)}, {"walls", container.has_walls}});
  return {{"sequences", std::move(sequences)},
          {"containers", std::move(containers)},
          {"target", scenario.target},
          {"cup_radius_mm", 1e3 * scenario.cup.lip_radius}};
}

/// Of a template: its text, and its arm, which the text names as a file beside it.
Json template_of(const Template& one) {
  std::string text = read_file(one.file, "a scenario to begin with");
  constexpr std::string_view kRobot = "\n  urdf: ";
  const std::size_t at = text.find(kRobot);
  if (at == std::string::npos) return {{"text", text}, {"arm", nullptr}};
  const std::size_t begin = at + kRobot.size(), end = std::min(text.find_first_of(" \r\n#", begin), text.size());
  const std::filesystem::path file = one.file.parent_path() / text.substr(begin, end - begin);
  const std::string name = file.filename().string();
  text.replace(begin, end - begin, name);
  return {{"text", text}, {"arm", {{"name", name}, {"text", read_file(file, "an arm")}}}};
}

/// A member of an object; throws InputError for another type.
template <class T>
T member(const Json& json, const char* key, T otherwise) {
  const auto found = json.find(key);
  if (found == json.end() || found->is_null()) return otherwise;
  const bool is_right = std::is_same_v<T, std::string> ? found->is_string()
                        : std::is_same_v<T, double>    ? found->is_number()
                                                       : found->is_number_unsigned();
  if (!is_right)
    throw InputError("request", key, printable(text_of(*found), 40), "a value of its type, docs/ui-interface.md");
  return found->template get<T>();
}

Json parse_object(const std::string& body, std::size_t most = kLargestJson) {
  if (body.size() > most)
    throw InputError("request", "", "more than " + std::to_string(most) + " bytes", "a small JSON object");
  if (!is_shallow_json(body))
    throw InputError("request", "", "lists or objects that are too deep", "a small JSON object");
  Json json = Json::parse(body, nullptr, false);
  if (!json.is_object()) throw InputError("request", "", printable(body, 40), "a JSON object");
  return json;
}

/// What is typed from the data sheet of a cup.
cup::CupSheet cup_sheet_of(const Json& json) {
  if (!json.is_object()) throw InputError("request", "sheet", "", "an object");
  for (const auto& [key, value] : json.items())
    if (key != "diameter_mm" && key != "bellows" && key != "material" && key != "lip" && key != "vacuum_kPa" &&
        key != "stroke_mm")
      throw InputError("request", printable(key, 40), "",
                       "diameter_mm, bellows, material, lip, vacuum_kPa or stroke_mm");
  std::optional<double> stroke;
  if (json.contains("stroke_mm") && !json["stroke_mm"].is_null()) stroke = member(json, "stroke_mm", 0.0);
  return read_cup_sheet(member(json, "diameter_mm", 0.0), member(json, "bellows", 1.5),
                        member(json, "material", std::string("silicone")), member(json, "lip", std::string("plain")),
                        member(json, "vacuum_kPa", -60.0), stroke);
}

std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '/') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

Service::Service(const ServiceSettings& settings)
    : settings_(settings), folder_(settings.folder), runs_(folder_, settings.program, settings.runs_at_once) {}

ApiAnswer Service::answer(const ApiRequest& request) {
  try {
    return route(request);
  } catch (const InputError& error) {
    return as_answer({{"error", printable(error.what(), 4 * kLongestMessage)}, {"mistake", as_json(error)}}, 422);
  } catch (const OutputError& error) {
    return refusal(507, printable(error.what(), 4 * kLongestMessage));
  } catch (const std::exception& error) {
    return refusal(500, printable(error.what(), kLongestMessage));
  }
}

ApiAnswer Service::route(const ApiRequest& request) {
  if (!request.path.starts_with(kRoot)) return refusal(404, "this interface has only version 1: /api/1/");
  const std::vector<std::string> parts = split(std::string_view(request.path).substr(kRoot.size()));
  const std::string& what = parts[0];
  const std::string name = parts.size() > 1 ? parts[1] : std::string();
  const bool is_get = request.method == "GET", is_post = request.method == "POST";
  if (parts.size() == 1 && what == "folder" && is_get) return answer_folder();
  if (parts.size() == 1 && what == "runs" && is_post) return start_runs(request.body, true);
  if (parts.size() == 1 && what == "commands" && is_post) return start_runs(request.body, false);
  if (parts.size() == 2 && what == "files") return answer_file(request, name);
  if (parts.size() == 2 && what == "facts" && is_get) return answer_check(name, folder_.read(name));
  if (parts.size() == 2 && what == "check" && is_post) return answer_check(name, request.body);
  if (parts.size() == 2 && what == "scene" && is_post) return answer_scene(name, request.body);
  if (parts.size() == 2 && what == "reach" && is_post) return answer_reach(name, request.body);
  if (parts.size() == 2 && what == "sheet" && is_post) return answer_sheet(name, request.body);
  if (parts.size() == 2 && what == "move" && is_post) return answer_move(name, request.body);
  if (parts.size() == 1 && what == "catalogue" && is_get) {
    ApiAnswer answer;
    answer.body = format_catalogue();
    return answer;
  }
  if (parts.size() == 1 && what == "typical" && is_post) return answer_typical(request.body);
  if (parts.size() == 2 && (what == "cup" || what == "arm") && is_post) return answer_edit(what, name, request.body);
  if (parts.size() == 2 && what == "runs") return answer_run(request, name, "");
  if (parts.size() == 3 && what == "runs") return answer_run(request, name, parts[2]);
  if (parts.size() == 2 && what == "templates" && is_get) {
    for (const Template& one : settings_.templates) {
      if (one.name == name) return as_answer(template_of(one));
    }
  }
  return refusal(404, "no such address: docs/ui-interface.md lists them");
}

ApiAnswer Service::answer_folder() {
  Json scenarios = Json::array(), items = Json::array(), runs = Json::array(), templates = Json::array();
  Json arms = Json::array();
  for (const Entry& entry : folder_.list()) {
    if (entry.kind == FileKind::Scenario) scenarios.push_back({{"name", entry.name}, {"bytes", entry.bytes}});
    if (entry.kind == FileKind::Urdf) arms.push_back({{"name", entry.name}, {"bytes", entry.bytes}});
    if (entry.kind == FileKind::Items) items.push_back({{"name", entry.name}, {"bytes", entry.bytes}});
  }
  for (const RunStatus& status : runs_.list(kListPatience)) runs.push_back(summary_of(status));
  for (const Template& one : settings_.templates)
    templates.push_back({{"name", one.name}, {"description", one.description}});
  return as_answer({{"folder", printable_end(folder_.path().string(), kLongestMessage)},
                    {"version", settings_.version},
                    {"can_be_written", folder_.can_be_written()},
                    {"scenarios", std::move(scenarios)},
                    {"items", std::move(items)},
                    {"arms", std::move(arms)},
                    {"runs", std::move(runs)},
                    {"templates", std::move(templates)}});
}

ApiAnswer Service::answer_file(const ApiRequest& request, const std::string& name) {
  const FileKind kind = kind_of_name(name);
  if (request.method == "GET") {
    ApiAnswer answer;
    answer.body = folder_.read(name);
    answer.type = "application/octet-stream";
    answer.attachment = name;
    return answer;
  }
  if (request.method == "PUT") {
    if (kind != FileKind::Mesh && request.body.size() > kLargestUpload)
      return refusal(413, "at most " + std::to_string(kLargestUpload) + " bytes");
    const auto has = [this](const std::string& file) { return folder_.has(file); };
    const std::string text = kind == FileKind::Urdf ? take_in_urdf(request.body, name, has) : request.body;
    folder_.write(name, text);
    return as_answer({{"name", name}, {"facts", facts_of(kind, text, (folder_.path() / name).string())}});
  }
  if (request.method != "DELETE") return refusal(405, "GET, PUT or DELETE");
  if (kind != FileKind::Scenario && kind != FileKind::Items && kind != FileKind::Urdf && kind != FileKind::Mesh)
    return refusal(422, "files of a run are removed with it: DELETE /api/1/runs/NAME");
  folder_.remove(name);
  return as_answer({{"removed", name}});
}

/// Mistakes of a text that is being written are an answer, not an error.
ApiAnswer Service::answer_check(const std::string& name, const std::string& text) {
  try {
    folder_.check(name, text);
    const Json facts = facts_of(kind_of_name(name), text, (folder_.path() / name).string());
    return as_answer({{"text", text}, {"mistake", nullptr}, {"facts", facts}});
  } catch (const InputError& error) {
    (void)kind_of_name(name);  // a wrong name is an error
    Json answer = {{"text", text}, {"mistake", as_json(error)}, {"facts", nullptr}};
    if (kind_of_name(name) == FileKind::Items) answer["mistakes"] = mistakes_of_orders(text, name);
    return as_answer(answer);
  }
}

/// Throws InputError as Folder::check, in whose words mistakes are told.
model::Scenario Service::read_cell(const std::string& name, const std::string& text) const {
  if (kind_of_name(name) != FileKind::Scenario) throw InputError("name", "", name, "a name that ends in .yaml");
  folder_.check(name, text);
  return model::parse_scenario(text, (folder_.path() / name).string());
}

/// What is drawn and can be moved.
ApiAnswer Service::answer_scene(const std::string& name, const std::string& text) const {
  const model::Scenario scenario = read_cell(name, text);
  Json parts = Json::array();
  for (const model::CellPart& part : model::find_parts(scenario))
    parts.push_back({{"key", part.key},
                     {"name", part.name},
                     {"position_mm", in_mm(part.X_W.p)},
                     {"yaw_deg", model::yaw_about_vertical(part.X_W.R) * kDegreesARadian}});
  return as_answer({{"parts", std::move(parts)},
                    {"has_robot", scenario.robot.has_value()},
                    {"form", base64(replay::encode_cell(scenario))}});
}

ApiAnswer Service::answer_reach(const std::string& name, const std::string& text) const {
  ApiAnswer answer;
  answer.body = runs::format_json(runs::make_reach_map(read_cell(name, text), core_count()));
  return answer;
}

/// Orders drawn by a seed.
ApiAnswer Service::answer_typical(const std::string& body) {
  const Json json = parse_object(body);
  for (const auto& [key, value] : json.items())
    if (key != "orders" && key != "boxes" && key != "seed")
      throw InputError("request", printable(key, 40), "", "orders, boxes or seed");
  const auto count = [&](const char* key, int otherwise) {
    return static_cast<int>(std::min(member(json, key, static_cast<std::uint64_t>(otherwise)), std::uint64_t{1000000}));
  };
  const model::TypicalOrders usual;
  const model::TypicalOrders wanted{count("orders", usual.orders), count("boxes", usual.boxes),
                                    member(json, "seed", usual.seed)};
  const std::string seed = std::to_string(wanted.seed);
  return as_answer(
      {{"orders", model::draw_typical_orders(wanted)},
       {"command", as_shell_line({"snug", "items", "draw", "--orders", std::to_string(wanted.orders), "--boxes",
                                  std::to_string(wanted.boxes), "--seed", seed, "-o", "typical-" + seed + ".csv"})}});
}

/// A table of boxes as people keep it, as orders; or what it leaves open.
ApiAnswer Service::answer_sheet(const std::string& name, const std::string& body) const {
  if (kind_of_name(name) != FileKind::Items) throw InputError("name", "", name, "a name that ends in .csv");
  const Json json = parse_object(body, kLargestMove);
  for (const auto& [key, value] : json.items())
    if (key != "text" && key != "length" && key != "mass" && key != "decimal")
      throw InputError("request", printable(key, 40), "", "text, length, mass or decimal");
  const model::SheetAnswers answers{member(json, "length", std::string()), member(json, "mass", std::string()),
                                    member(json, "decimal", std::string())};
  const std::string text = member(json, "text", std::string());
  if (text.size() > kLargestUpload) return refusal(413, "at most " + std::to_string(kLargestUpload) + " bytes");
  const model::ItemsSheet sheet = model::read_items_sheet(text, name, answers);
  std::vector<std::string> words = {"snug", "items", "read", name};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--length-unit", answers.length);
  add("--mass-unit", answers.mass);
  add("--decimal", answers.decimal);
  add("-o", "orders.csv");
  Json columns = Json::array(), questions = Json::array();
  for (const model::SheetColumn& one : sheet.columns)
    columns.push_back({{"heading", one.heading}, {"column", one.column}});
  for (const model::SheetQuestion& one : sheet.questions) {
    Json choices = Json::array();
    for (const auto& [answer, meaning] : one.choices)
      choices.push_back({{"answer", answer}, {"meaning", printable(meaning, kLongestMessage)}});
    questions.push_back({{"about", one.about}, {"choices", std::move(choices)}});
  }
  return as_answer({{"orders", sheet.orders},
                    {"columns", std::move(columns)},
                    {"questions", std::move(questions)},
                    {"command", as_shell_line(words)}});
}

/// The text with parts of the cell moved; whether it can be used is another question.
ApiAnswer Service::answer_move(const std::string& name, const std::string& body) const {
  const Json json = parse_object(body, kLargestMove);
  for (const auto& [key, value] : json.items())
    if (key != "text" && key != "moves") throw InputError("request", printable(key, 40), "", "text or moves");
  const auto moves = json.find("moves");
  if (moves == json.end() || !moves->is_array() || moves->size() > kMostMoves)
    throw InputError("request", "moves", "", "a list of at most " + std::to_string(kMostMoves));
  std::vector<model::PoseEdit> edits;
  for (const Json& move : *moves) {
    if (!move.is_object()) throw InputError("request", "moves", printable(text_of(move), 40), "objects");
    for (const auto& [key, value] : move.items())
      if (key != "key" && key != "position_mm" && key != "yaw_deg")
        throw InputError("request", printable(key, 40), "", "key, position_mm or yaw_deg");
    model::PoseEdit edit;
    edit.key = printable(member(move, "key", std::string()), kLongestMessage);
    const auto position = move.find("position_mm");
    const bool is_position = position != move.end() && position->is_array() && position->size() == 3 &&
                             std::ranges::all_of(*position, [](const Json& one) { return one.is_number(); });
    if (!is_position) throw InputError("request", "position_mm", "", "three numbers");
    for (int i = 0; i < 3; ++i) edit.p_W[i] = 1e-3 * (*position)[static_cast<std::size_t>(i)].get<double>();
    edit.yaw = member(move, "yaw_deg", 0.0) / kDegreesARadian;
    edits.push_back(std::move(edit));
  }
  const model::Scenario scenario = read_cell(name, member(json, "text", std::string()));
  return as_answer({{"text", model::move_parts(scenario, edits)}});
}

/// The text with another cup or arm; whether it can be used is another question.
ApiAnswer Service::answer_edit(const std::string& what, const std::string& name, const std::string& body) const {
  const Json json = parse_object(body, kLargestMove);
  for (const auto& [key, value] : json.items())
    if (key != "text" && key != what && key != (what == "arm" ? "tool" : "sheet"))
      throw InputError("request", printable(key, 40), "", what == "arm" ? "text, arm or tool" : "text, cup or sheet");
  const std::string text = member(json, "text", std::string()), wanted = member(json, what.c_str(), std::string());
  if (kind_of_name(name) != FileKind::Scenario) throw InputError("name", "", name, "a name that ends in .yaml");
  if (what == "cup") {
    const auto sheet_json = json.find("sheet");
    const cup::CupSheet sheet = sheet_json == json.end() ? find_cup(wanted) : cup_sheet_of(*sheet_json);
    const cup::Estimate pull_off = cup::estimate_cup(sheet).pull_off;
    return as_answer({{"text", put_cup(text, name, sheet)},
                      {"command", cup_command(sheet)},
                      {"pull_off_N", {pull_off.low, pull_off.value, pull_off.high}}});
  }
  if (kind_of_name(wanted) != FileKind::Urdf) throw InputError("request", "arm", wanted, "a file that ends in .urdf");
  const ArmFacts facts = read_arm_facts(folder_.read(wanted), wanted);
  const std::string tool = member(json, "tool", facts.links.front());
  const std::string path = (folder_.path() / name).string();  // with its folder: other files are looked for beside it
  return as_answer(
      {{"text", put_arm(text, path, wanted, tool, folder_.path() / wanted)}, {"links", facts.links}, {"tool", tool}});
}

ApiAnswer Service::answer_run(const ApiRequest& request, const std::string& name, const std::string& part) {
  const bool is_get = request.method == "GET";
  if (part.empty() && is_get) return as_answer(as_json(runs_.status(name)));
  if (part.empty() && request.method == "DELETE") {
    runs_.remove(name);
    return as_answer({{"removed", name}});
  }
  if (part == "events" && is_get) return watch(name);
  if (part == "live" && is_get) return watch_frames(name);
  if (part == "stop" && request.method == "POST") {
    if (!runs_.stop(name))
      return refusal(409, "this program does not own this run: it is over, or another program started it");
    return as_answer({{"stopping", name}});
  }
  if (part == "stop-now" && request.method == "POST") {
    if (!runs_.stop_now(name))
      return refusal(409, "this program does not own this run: it is over, or another program started it");
    return as_answer({{"stopped", name}});
  }
  if (part == "operator" && request.method == "POST") {
    const Json json = parse_object(request.body);
    const std::string order = member(json, "order", std::string());
    runs_.operate(name, order);
    return as_answer({{"said", order}, {"command", "echo " + as_shell_line({order}) + " >> " + name + ".operator"}});
  }
  if (part == "decisions" && is_get) {
    (void)runs_.status(name);
    ApiAnswer answer;
    answer.body = format_decisions(folder_.has(name + ".jsonl") ? folder_.read(name + ".jsonl") : "", name + ".jsonl");
    return answer;
  }
  if (part == "make" && request.method == "POST") {
    const Json json = parse_object(request.body);
    const std::string what = member(json, "what", std::string());
    return as_answer({{"made", what}, {"command", as_shell_line(runs_.make(name, what))}});
  }
  if (part == "report" && is_get) {
    ApiAnswer answer;
    answer.body = runs_.report(name);
    answer.type = "text/html; charset=utf-8";
    answer.policy = kReportPolicy;
    return answer;
  }
  return refusal(404, "no such address: docs/ui-interface.md lists them");
}

ApiAnswer Service::start_runs(const std::string& body, bool starts) {
  const Json json = parse_object(body);
  static constexpr std::array kKeys = {"name",       "scenario",      "items",   "sequence", "plants",
                                       "plant_seed", "tempo",         "resumes", "plant",    "observe",
                                       "perception", "moves_a_robot", "holds"};
  for (const auto& [key, value] : json.items()) {
    if (std::ranges::find(kKeys, std::string_view(key)) == kKeys.end())
      throw InputError("request", printable(key, 40), "",
                       "name, scenario, items, sequence, plants, plant_seed, tempo, resumes, plant, observe, "
                       "perception, moves_a_robot or holds");
  }
  RunRequest request;
  request.name = member(json, "name", std::string());
  request.scenario = member(json, "scenario", std::string());
  request.items = member(json, "items", std::string());
  request.sequence = member(json, "sequence", std::string());
  request.resumes = member(json, "resumes", std::string());
  request.plant = member(json, "plant", std::string());
  request.observe = member(json, "observe", std::string());
  request.perception = member(json, "perception", std::string());
  request.plant_seed = member(json, "plant_seed", std::uint64_t{0});
  if (json.contains("tempo") && !json["tempo"].is_null()) request.tempo = member(json, "tempo", 1.0);
  const auto is_set = [&](const char* key) {
    const auto found = json.find(key);
    if (found == json.end() || found->is_null()) return false;
    if (!found->is_boolean()) throw InputError("request", key, "", "true or false");
    return found->get<bool>();
  };
  request.moves_a_robot = is_set("moves_a_robot");
  request.holds = is_set("holds");
  const auto plants = member(json, "plants", std::uint64_t{1});
  if (plants < 1 || plants > static_cast<std::uint64_t>(kMostPlants))
    throw InputError("request", "plants", std::to_string(plants), "1 to " + std::to_string(kMostPlants));
  if (!request.plant.empty() && plants != 1)
    throw InputError("request", "plants", std::to_string(plants), "1, with a plant of its own");
  if (!request.resumes.empty() && plants != 1)
    throw InputError("request", "plants", std::to_string(plants), "1, with resumes");
  if (request.plant_seed > UINT64_MAX - plants) throw InputError("request", "plant_seed", "", "a smaller number");
  const std::string stem = request.name;
  Json started = Json::array();
  request.threads = plants > 1 ? 1 : 0;
  for (std::uint64_t i = 0; i < plants; ++i) {
    if (plants > 1) request.name = stem + "-" + std::to_string(i + 1);
    check(request);
    if (starts) runs_.start(request);
    started.push_back({{"name", request.name}, {"command", as_shell_line(command_of(request))}});
    ++request.plant_seed;
  }
  return as_answer({{"runs", std::move(started)}}, starts ? 201 : 200);
}

/// The whole status whenever it has changed; ends after the one that says that the run is over.
ApiAnswer Service::watch(const std::string& name) {
  (void)runs_.status(name);
  ApiAnswer answer;
  const auto last = std::make_shared<std::string>();
  const auto is_over = std::make_shared<bool>(false);
  answer.next = [this, name, last, is_over]() -> std::optional<std::string> {
    if (*is_over) return std::nullopt;
    if (!last->empty()) std::this_thread::sleep_for(kBetweenLooks);
    try {
      const RunStatus status = runs_.status(name);
      const std::string text = text_of(as_json(status));
      *is_over = status.state != RunState::Running && status.state != RunState::Waiting;
      if (text == *last) return *is_over ? std::optional<std::string>() : std::optional<std::string>("");
      *last = text;
      return "event: status\ndata: " + text + "\n\n";
    } catch (const std::exception&) {
      return std::nullopt;  // it was removed
    }
  };
  return answer;
}

/// What `snug pack --live` writes, from its beginning and as it grows; `over` when no more comes.
ApiAnswer Service::watch_frames(const std::string& name) {
  (void)runs_.status(name);
  ApiAnswer answer;
  const auto offset = std::make_shared<std::uintmax_t>(0);
  const auto is_over = std::make_shared<bool>(false);
  const auto next_look = std::make_shared<std::chrono::steady_clock::time_point>();
  answer.next = [this, name, offset, is_over, next_look]() -> std::optional<std::string> {
    if (*is_over) return std::nullopt;
    const auto over = [&] {
      *is_over = true;
      return std::optional<std::string>("event: over\ndata: {}\n\n");
    };
    try {
      std::string text = folder_.has(name + ".live") ? folder_.read_from(name + ".live", *offset, kMostFrames) : "";
      const std::size_t end = text.rfind("\n\n");
      text.resize(end == std::string::npos ? 0 : end + 2);
      *offset += text.size();
      if (!text.empty()) return text;
      const auto now = std::chrono::steady_clock::now();
      if (now < *next_look) {
        std::this_thread::sleep_for(kBetweenFrames);
        return std::string();
      }
      *next_look = now + kBetweenLooks;
      const RunState state = runs_.status(name).state;
      if (state != RunState::Running && state != RunState::Waiting) return over();
      return std::string();
    } catch (const std::exception&) {
      return over();  // it was removed
    }
  };
  return answer;
}

}  // namespace snug::workspace
