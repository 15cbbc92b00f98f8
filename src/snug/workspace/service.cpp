// Service: the interface of `snug ui`, version 1: requests of a page answered by a folder and its runs.
#include "snug/workspace/service.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "snug/core/input_error.hpp"
#include "snug/core/json_value.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/model/items_file.hpp"
#include "snug/model/scenario.hpp"

namespace snug::workspace {
namespace {

using Json = nlohmann::ordered_json;
using serve::ApiAnswer;
using serve::ApiRequest;

constexpr std::string_view kRoot = "/api/1/";
constexpr std::size_t kLargestJson = std::size_t{64} << 10U;
constexpr std::chrono::milliseconds kBetweenLooks(250);  // at a log that grows
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

Json as_json(const RunStatus& status) {
  const RunProgress& progress = status.progress;
  Json boxes = Json::array();
  for (const BoxProgress& box : progress.boxes)
    boxes.push_back({{"id", box.id}, {"end", box.end}, {"reason", box.reason}, {"packed", box.is_packed}});
  return {{"name", status.name},       {"state", name_of(status.state)}, {"can_be_stopped", status.can_be_stopped},
          {"command", status.command}, {"message", status.message},      {"sequence", progress.sequence},
          {"plant", progress.plant},   {"items", progress.items},        {"done", progress.done},
          {"packed", progress.packed}, {"lost", progress.lost},          {"percent", progress.planned_percent},
          {"time", progress.time},     {"stopped", progress.stopped},    {"boxes", std::move(boxes)},
          {"files", status.files}};
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
  const model::Scenario scenario = model::parse_scenario(text, name);
  Json sequences = Json::array(), containers = Json::array();
  for (const model::Sequence& sequence : scenario.sequences) sequences.push_back(sequence.name);
  for (const model::Container& container : scenario.containers)
    containers.push_back({{"name", container.name}, {"inner_size_mm", in_mm(container.inner_size)}});
  return {{"sequences", std::move(sequences)},
          {"containers", std::move(containers)},
          {"target", scenario.target},
          {"cup_radius_mm", 1e3 * scenario.cup.lip_radius}};
}

/// A member of an object; throws InputError for another type.
template <class T>
T member(const Json& json, const char* key, T otherwise) {
  const auto found = json.find(key);
  if (found == json.end() || found->is_null()) return otherwise;
  const bool is_right = std::is_same_v<T, std::string> ? found->is_string()
                        : std::is_same_v<T, double>    ? found->is_number()
                                                       : found->is_number_unsigned();
  if (!is_right) throw InputError("request", key, printable(text_of(*found), 40), "a value of its type, docs/ui.md");
  return found->template get<T>();
}

Json parse_object(const std::string& body) {
  if (body.size() > kLargestJson) throw InputError("request", "", "more than 64 kB", "a small JSON object");
  if (!is_shallow_json(body))
    throw InputError("request", "", "lists or objects that are too deep", "a small JSON object");
  Json json = Json::parse(body, nullptr, false);
  if (!json.is_object()) throw InputError("request", "", printable(body, 40), "a JSON object");
  return json;
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
  if (!request.path.starts_with(kRoot)) return refusal(404, "there is version 1 of this interface only: /api/1/");
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
  if (parts.size() == 2 && what == "runs") return answer_run(request, name, "");
  if (parts.size() == 3 && what == "runs") return answer_run(request, name, parts[2]);
  if (parts.size() == 2 && what == "templates" && is_get) {
    for (const Template& one : settings_.templates) {
      if (one.name == name) return as_answer({{"text", read_file(one.file, "a scenario to begin with")}});
    }
  }
  return refusal(404, "there is no such address: docs/ui.md lists them");
}

ApiAnswer Service::answer_folder() {
  Json scenarios = Json::array(), items = Json::array(), runs = Json::array(), templates = Json::array();
  for (const Entry& entry : folder_.list()) {
    if (entry.kind == FileKind::Scenario) scenarios.push_back({{"name", entry.name}, {"bytes", entry.bytes}});
    if (entry.kind == FileKind::Items) items.push_back({{"name", entry.name}, {"bytes", entry.bytes}});
  }
  for (const RunStatus& status : runs_.list()) {
    Json run = as_json(status);
    run.erase("boxes");
    runs.push_back(std::move(run));
  }
  for (const Template& one : settings_.templates)
    templates.push_back({{"name", one.name}, {"description", one.description}});
  return as_answer({{"folder", printable_end(folder_.path().string(), kLongestMessage)},
                    {"version", settings_.version},
                    {"scenarios", std::move(scenarios)},
                    {"items", std::move(items)},
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
    folder_.write(name, request.body);
    return as_answer({{"name", name}, {"facts", facts_of(kind, request.body, (folder_.path() / name).string())}});
  }
  if (request.method != "DELETE") return refusal(405, "GET, PUT or DELETE");
  if (kind != FileKind::Scenario && kind != FileKind::Items)
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
    return as_answer({{"text", text}, {"mistake", as_json(error)}, {"facts", nullptr}});
  }
}

ApiAnswer Service::answer_run(const ApiRequest& request, const std::string& name, const std::string& part) {
  const bool is_get = request.method == "GET";
  if (part.empty() && is_get) return as_answer(as_json(runs_.status(name)));
  if (part.empty() && request.method == "DELETE") {
    runs_.remove(name);
    return as_answer({{"removed", name}});
  }
  if (part == "events" && is_get) return watch(name);
  if (part == "stop" && request.method == "POST") {
    if (!runs_.stop(name))
      return refusal(409, "this run is none of this program: it is over, or another program started it");
    return as_answer({{"stopping", name}});
  }
  if (part == "report" && is_get) {
    runs_.make_report(name);
    ApiAnswer answer;
    answer.body = folder_.read(name + ".html");
    answer.type = "text/html; charset=utf-8";
    answer.policy = kReportPolicy;
    return answer;
  }
  return refusal(404, "there is no such address: docs/ui.md lists them");
}

ApiAnswer Service::start_runs(const std::string& body, bool starts) {
  const Json json = parse_object(body);
  static constexpr std::array kKeys = {"name",   "scenario",   "items", "sequence",
                                       "plants", "plant_seed", "tempo", "resumes"};
  for (const auto& [key, value] : json.items()) {
    if (std::ranges::find(kKeys, std::string_view(key)) == kKeys.end())
      throw InputError("request", printable(key, 40), "",
                       "name, scenario, items, sequence, plants, plant_seed, tempo or resumes");
  }
  RunRequest request;
  request.name = member(json, "name", std::string());
  request.scenario = member(json, "scenario", std::string());
  request.items = member(json, "items", std::string());
  request.sequence = member(json, "sequence", std::string());
  request.resumes = member(json, "resumes", std::string());
  request.plant_seed = member(json, "plant_seed", std::uint64_t{0});
  if (json.contains("tempo") && !json["tempo"].is_null()) request.tempo = member(json, "tempo", 1.0);
  const auto plants = member(json, "plants", std::uint64_t{1});
  if (plants < 1 || plants > static_cast<std::uint64_t>(kMostPlants))
    throw InputError("request", "plants", std::to_string(plants), "1 to " + std::to_string(kMostPlants));
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

}  // namespace snug::workspace
