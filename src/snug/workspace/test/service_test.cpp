// Tests of the interface of `snug ui`: right requests, wrong ones, and random ones; nothing outside the folder is read.
#include "snug/workspace/service.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "snug/core/read_file.hpp"
#include "snug/core/rng.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/workspace/api_forms.hpp"

namespace snug::workspace {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kTwoOrders =
    "order,article,length_mm,width_mm,height_mm,mass_kg,count\nmine,A,200,150,100,0.5,1\nyours,B,180,120,90,0.4,2\n";

class ServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    cells_ = scratch_.path() / "cells";
    fs::create_directory(cells_);
    std::ofstream(scratch_.path() / "secret.yaml") << "secret";
    const fs::path init = fs::path(SNUG_SOURCE_DIR) / "scenarios/init/cell.yaml";
    cell_ = read_file(init, "a scenario");
    // A program that does nothing: runs are not what is tested here.
    service_ = std::make_unique<Service>(ServiceSettings{cells_, "/bin/true", "1.0", {{"cell", "a cell", init}}, 1});
  }
  [[nodiscard]] serve::ApiAnswer ask(const std::string& method, const std::string& path, const std::string& body = "") {
    return service_->answer({method, "/api/1/" + path, body});
  }
  [[nodiscard]] Json json(const std::string& method, const std::string& path, const std::string& body = "",
                          int status = 200) {
    const serve::ApiAnswer answer = ask(method, path, body);
    EXPECT_EQ(answer.status, status) << path << ": " << answer.body;
    if (const std::string form = form_of(method, path, answer.status); !form.empty()) {
      EXPECT_EQ(find_deviation(nlohmann::ordered_json::parse(answer.body), form), "") << method << " " << path;
    }
    return Json::parse(answer.body);
  }
  /// The form of an answer (api_forms.hpp); empty: it is none of the page's.
  [[nodiscard]] static std::string form_of(const std::string& method, const std::string& path, int status) {
    static const std::map<std::string, std::string> kForms = {
        {"folder", "FolderList"},   {"templates", "TemplateText"}, {"facts", "Checked"},   {"check", "Checked"},
        {"sheet", "SheetRead"},     {"typical", "TypicalDrawn"},   {"scene", "CellScene"}, {"reach", "ReachMap"},
        {"move", "EditedText"},     {"cup", "EditedText"},         {"arm", "EditedText"},  {"catalogue", "Catalogue"},
        {"commands", "RunCommands"}};
    if (status >= 400) return "Refusal";
    const std::string what = path.substr(0, path.find('/'));
    if (what == "files") return method == "PUT" ? "Written" : "";
    if (what == "runs") {
      if (path == "runs") return "RunCommands";
      if (path.ends_with("/decisions")) return "Decisions";
      if (path.ends_with("/operator")) return "Said";
      if (path.ends_with("/make")) return "Made";
      return method == "GET" && path.find('/', 5) == std::string::npos ? "RunStatus" : "";
    }
    const auto found = kForms.find(what);
    return found == kForms.end() ? "" : found->second;
  }

  test::ScratchFolder scratch_;
  fs::path cells_;
  std::string cell_;
  std::unique_ptr<Service> service_;
};

TEST_F(ServiceTest, WritesAndListsScenariosAndItems) {
  EXPECT_EQ(json("GET", "templates/cell")["text"], cell_);
  EXPECT_EQ(json("PUT", "files/a.yaml", cell_)["facts"]["sequences"], Json({"first"}));
  const Json items = json("PUT", "files/b.csv", kTwoOrders)["facts"];
  EXPECT_EQ(items["sequences"], Json({"mine", "yours"}));
  EXPECT_EQ(items["lines"][1]["count"], 2);
  EXPECT_NEAR(items["lines"][0]["size_mm"][0].get<double>(), 200.0, 1e-9);
  const Json folder = json("GET", "folder");
  EXPECT_EQ(folder["scenarios"][0]["name"], "a.yaml");
  EXPECT_EQ(folder["items"][0]["name"], "b.csv");
  EXPECT_EQ(json("GET", "facts/a.yaml")["facts"]["containers"][0]["name"], "tote");
  EXPECT_EQ(ask("GET", "files/a.yaml").body, cell_);
  EXPECT_EQ(ask("GET", "files/a.yaml").attachment, "a.yaml");
  (void)json("DELETE", "files/a.yaml");
  EXPECT_FALSE(fs::exists(cells_ / "a.yaml"));
}

TEST_F(ServiceTest, TellsMistakesWithTheirLineAndKeepsWhatWasThere) {
  (void)json("PUT", "files/a.yaml", cell_);
  const std::string wrong = "name: x\nsteps: 3\n";
  const Json mistake = json("POST", "check/a.yaml", wrong)["mistake"];
  EXPECT_EQ(mistake["line"], 2);
  EXPECT_EQ(mistake["key"], "steps");
  EXPECT_EQ(json("PUT", "files/a.yaml", wrong, 422)["mistake"]["line"], 2);
  EXPECT_EQ(ask("GET", "files/a.yaml").body, cell_);
  EXPECT_EQ(json("POST", "check/b.csv", std::string(kTwoOrders) + "mine,C,x,1,1,1,1\n")["mistake"]["line"], 4);
}

TEST_F(ServiceTest, DrawsTypicalOrders) {
  const Json drawn = json("POST", "typical", R"({"orders":2,"boxes":5,"seed":7})");
  EXPECT_EQ(drawn["command"], "snug items draw --orders 2 --boxes 5 --seed 7 -o typical-7.csv");
  EXPECT_EQ(json("PUT", "files/t.csv", drawn["orders"])["facts"]["sequences"], Json({"order-1", "order-2"}));
  for (const char* wrong : {R"({"orders":0})", R"({"boxes":201})", R"({"orders":99999999999})", R"({"seed":-1})",
                            R"({"orders":1.5})", R"({"x":1})", "[]"})
    (void)json("POST", "typical", wrong, 422);
}

TEST_F(ServiceTest, PutsACupOfADataSheet) {
  const Json request = {{"text", cell_}, {"sheet", {{"diameter_mm", 42}, {"bellows", 2.5}, {"material", "nitrile"}}}};
  const Json put = json("POST", "cup/a.yaml", request.dump());
  EXPECT_EQ(put["command"], "snug cup estimate --diameter 42 --bellows 2.5 --material nitrile --lip plain");
  EXPECT_GT(put["pull_off_N"][1], put["pull_off_N"][0]);
  EXPECT_NEAR(json("POST", "check/a.yaml", put["text"])["facts"]["cup_radius_mm"].get<double>(), 21.0, 1e-6);
  for (const char* wrong : {R"({})", R"({"diameter_mm":1e9})", R"({"diameter_mm":"40"})",
                            R"({"diameter_mm":40,"lip":"--x"})", R"({"diameter_mm":40,"y":1})", "[]", R"("40")"}) {
    (void)json("POST", "cup/a.yaml", R"({"text":"","sheet":)" + std::string(wrong) + "}", 422);
  }
}

TEST_F(ServiceTest, ShowsCommandsAndStartsThemOncePerPlant) {
  (void)json("PUT", "files/a.yaml", cell_);
  const std::string request = R"({"name":"r","scenario":"a.yaml","sequence":"first","plants":2,"plant_seed":7})";
  const Json shown = json("POST", "commands", request);
  EXPECT_TRUE(json("GET", "folder")["runs"].empty());
  EXPECT_EQ(json("POST", "runs", request, 201), shown);
  EXPECT_EQ(shown["runs"][1]["command"],
            "snug pack a.yaml --sequence first --plant-seed 8 --threads 1 --log r-2.jsonl --operator r-2.operator "
            "--program r-2.program.csv --live r-2.live -o "
            "r-2.h5");
  EXPECT_EQ(json("GET", "runs/r-2")["command"], shown["runs"][1]["command"]);
  const serve::ApiAnswer events = ask("GET", "runs/r-1/events");
  ASSERT_TRUE(events.next);
  EXPECT_TRUE(events.next()->starts_with("event: status\ndata: {\"name\":\"r-1\""));
  int pieces = 0;
  while (events.next() && pieces < 50) ++pieces;
  EXPECT_LT(pieces, 50);  // the stream ends with the run
}

TEST_F(ServiceTest, MovesPartsInTheTextAndShowsThem) {
  const Json moved = json(
      "POST", "move/a.yaml",
      Json{{"text", cell_}, {"moves", {{{"key", "containers.tote"}, {"position_mm", {500, 0, 20}}, {"yaw_deg", 0}}}}}
          .dump());
  const std::string text = moved["text"];
  EXPECT_NE(text.find("{name: tote, pose: {position: [0.5, 0.0, 0.02]}"), std::string::npos);
  EXPECT_NE(text.find("# What is packed into"), std::string::npos);
  const Json scene = json("POST", "scene/a.yaml", text);
  EXPECT_EQ(scene["parts"][0]["key"], "containers.tote");
  EXPECT_NEAR(scene["parts"][0]["position_mm"][0].get<double>(), 500.0, 1e-9);
  EXPECT_GT(scene["form"].get<std::string>().size(), 100U);
  EXPECT_FALSE(scene["has_robot"].get<bool>());
  EXPECT_EQ(json("POST", "reach/a.yaml", text, 422)["mistake"]["key"], "robot");
  // Into the bench: the text is given, its mistake is told when it is asked for.
  const Json below = json(
      "POST", "move/a.yaml",
      Json{{"text", cell_}, {"moves", {{{"key", "containers.tote"}, {"position_mm", {500, 0, 0}}, {"yaw_deg", 0}}}}}
          .dump());
  EXPECT_NE(json("POST", "check/a.yaml", below["text"].get<std::string>())["mistake"], nullptr);
  EXPECT_EQ(ask("POST", "scene/a.yaml", below["text"].get<std::string>()).status, 422);
  for (const char* body : {"{}", "[]", "{\"text\":\"\"}", "{\"text\":1,\"moves\":[]}", "{\"text\":\"x\",\"moves\":[1]}",
                           "{\"text\":\"x\",\"moves\":[{\"key\":\"robot\"}]}", "{\"moves\":[],\"more\":1}",
                           "{\"text\":\"x\",\"moves\":[{\"key\":\"robot\",\"position_mm\":[1,2]}]}",
                           "{\"text\":\"x\",\"moves\":[{\"key\":\"robot\",\"position_mm\":[1e999,2,3]}]}"}) {
    EXPECT_EQ(ask("POST", "move/a.yaml", body).status, 422) << body;
  }
  for (const char* path : {"scene/a.csv", "reach/a.csv", "move/..", "scene/link"})
    EXPECT_EQ(ask("POST", path, cell_).status, 422) << path;
  EXPECT_EQ(ask("GET", "scene/a.yaml").status, 404);
}

TEST_F(ServiceTest, ShowsWhatTheDemonstratorReaches) {
  const fs::path file = fs::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml";
  Service service({cells_, "/bin/true", "1.0", {{"demonstrator", "a cell", file}}, 1});
  const Json begun = Json::parse(service.answer({"GET", "/api/1/templates/demonstrator", ""}).body);
  const std::string text = begun["text"];
  EXPECT_NE(text.find("\n  urdf: ur10.urdf\n"), std::string::npos);  // beside it, wherever the folder goes
  EXPECT_EQ(service.answer({"POST", "/api/1/reach/a.yaml", text}).status, 422);
  ASSERT_EQ(begun["arm"]["name"], "ur10.urdf");
  ASSERT_EQ(service.answer({"PUT", "/api/1/files/ur10.urdf", begun["arm"]["text"]}).status, 200);
  const serve::ApiAnswer answer = service.answer({"POST", "/api/1/reach/a.yaml", text});
  ASSERT_EQ(answer.status, 200) << answer.body;
  const Json map = Json::parse(answer.body);
  EXPECT_EQ(map["layers"].size(), 4U);
  EXPECT_EQ(map["layers"][0]["verdicts"].size(), 384U);
  EXPECT_GT(map["counts"]["reached"], 1000);
}

TEST_F(ServiceTest, ReadsSheetsAndAsksForUnits) {
  const std::string text = "Sku;Length;Width;Height;kg weight\nA;20,5;15;10;0,5\n";
  const Json open = json("POST", "sheet/a.csv", Json{{"text", text}}.dump());
  EXPECT_EQ(open["orders"], "");
  EXPECT_EQ(open["questions"][0]["about"], "length");
  EXPECT_EQ(open["questions"][0]["choices"][1]["meaning"], "205 x 150 x 100 mm");
  const Json said = json("POST", "sheet/a.csv", Json{{"text", text}, {"length", "cm"}}.dump());
  EXPECT_EQ(said["orders"], "article,length_mm,width_mm,height_mm,mass_kg\nA,205,150,100,0.5\n");
  EXPECT_EQ(said["command"], "snug items read a.csv --length-unit cm -o orders.csv");
  EXPECT_EQ(said["columns"][4]["column"], "mass_kg");
  for (const Json& wrong : {Json{{"text", text}, {"length", "furlong"}}, Json{{"text", 7}}, Json{{"other", text}}})
    EXPECT_EQ(ask("POST", "sheet/a.csv", wrong.dump()).status, 422);
  EXPECT_EQ(ask("POST", "sheet/a.yaml", "{}").status, 422);
}

TEST_F(ServiceTest, StreamsFramesThatAreWhole) {
  std::ofstream(cells_ / "r.txt") << "$ snug pack a.yaml\n";
  std::ofstream(cells_ / "r.live") << "event: header\ndata: a\n\nevent: frames\nda";
  const serve::ApiAnswer frames = ask("GET", "runs/r/live");
  ASSERT_TRUE(frames.next);
  EXPECT_EQ(frames.next(), "event: header\ndata: a\n\n");
  std::ofstream(cells_ / "r.live", std::ios::app) << "ta: b\n\n";
  EXPECT_EQ(frames.next(), "event: frames\ndata: b\n\n");
  std::optional<std::string> last;
  int pieces = 0;
  while (const std::optional<std::string> piece = frames.next()) {
    last = piece;
    ASSERT_LT(++pieces, 100);
  }
  EXPECT_EQ(last, "event: over\ndata: {}\n\n");
  EXPECT_EQ(ask("GET", "runs/none/live").status, 422);
}

TEST_F(ServiceTest, RefusesRequestsThatAreWrong) {
  for (const char* body :
       {"", "[]", "{", "nul", "{\"name\":1}", "{\"plants\":-1}", "{\"plants\":0}", "{\"plants\":101}",
        "{\"plants\":1.5}", "{\"plants\":1e99}", "{\"agent\":\"x\"}",
        "{\"name\":\"r\",\"scenario\":\"a.yaml\",\"sequence\":\"--agent\"}", "{\"tempo\":\"fast\"}",
        "{\"name\":\"r\",\"plant_seed\":18446744073709551615}", "\xff\xfe", "{\"name\":\"\\u0000\"}"}) {
    EXPECT_EQ(ask("POST", "runs", body).status, 422) << body;
  }
  std::string deep = "{\"name\":";
  deep.append(60000, '[');
  EXPECT_EQ(ask("POST", "runs", deep).status, 422);
  for (const char* path :
       {"", "nothing", "files", "runs/a/b/c", "files/a/b", "templates/none", "templates/../cell", "../2/folder"}) {
    EXPECT_EQ(ask("GET", path).status, 404) << path;
  }
  EXPECT_EQ(service_->answer({"GET", "/api/2/folder", ""}).status, 404);
  for (const char* path :
       {"files/../secret.yaml", "files/..", "files/", "facts/secret", "runs/..", "runs//report", "runs/-o/report"})
    EXPECT_GE(ask("GET", path).status, 400) << path;
  fs::create_symlink(scratch_.path() / "secret.yaml", cells_ / "link.yaml");
  fs::create_symlink(scratch_.path() / "secret.yaml", cells_ / "link.html");
  EXPECT_EQ(ask("GET", "files/link.yaml").body.find("secret\""), std::string::npos);
  EXPECT_EQ(ask("GET", "files/link.yaml").status, 422);
  EXPECT_EQ(ask("GET", "files/link.html").status, 422);
  EXPECT_EQ(ask("PUT", "files/link.yaml", cell_).status, 422);
}

TEST_F(ServiceTest, RefusesDeepRequests) {
  const std::string body = "{\"name\":" + std::string(31000, '[') + std::string(31000, ']') + "}";
  EXPECT_EQ(ask("POST", "runs", body).status, 422);
}

TEST_F(ServiceTest, AnswersRandomRequestsWithoutLeavingTheFolder) {
  (void)json("PUT", "files/a.yaml", cell_);
  Rng rng(11);
  const std::vector<std::string> words = {
      "files", "runs",      "check",    "facts", "templates", "folder",    "commands",   "a.yaml",
      "a",     "..",        ".",        "",      "%2e%2e",    "stop",      "events",     "report",
      "scene", "move",      "reach",    "live",  "operator",  "decisions", "make",       "arm",
      "cup",   "catalogue", "stop-now", "sheet", "\n",        "\xff",      "secret.yaml"};
  const std::vector<std::string> methods = {"GET", "POST", "PUT", "DELETE", "PATCH", ""};
  const auto any = [&](const std::vector<std::string>& of) {
    return of[static_cast<std::size_t>(rng.index(static_cast<int>(of.size())))];
  };
  for (int i = 0; i < 3000; ++i) {
    std::string path = any(words);
    for (int k = rng.index(4); k > 0; --k) path += "/" + any(words);
    std::string body = any(words);
    for (int k = rng.index(20); k > 0; --k) body += static_cast<char>(rng.index(256));
    const serve::ApiAnswer answer = ask(any(methods), path, body);
    EXPECT_TRUE(answer.status == 200 || (answer.status >= 404 && answer.status <= 422)) << answer.status << " " << path;
    if (answer.type == "application/json" && !answer.next) {
      EXPECT_TRUE(Json::accept(answer.body)) << path;
    }
  }
  EXPECT_EQ(read_file(scratch_.path() / "secret.yaml", "a file"), "secret");
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_.path()), {}), 2);
}

}  // namespace
}  // namespace snug::workspace
