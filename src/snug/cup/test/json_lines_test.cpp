// Tests of the JSON lines: reference vectors in and out, and what each kind of wrong input is told.
#include "snug/cup/json_lines.hpp"

#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/cup/test/vectors.hpp"

namespace snug::cup {
namespace {

using nlohmann::json;

json identity_rows(int n, double scale) {
  json rows = json::array();
  for (int i = 0; i < n; ++i) {
    rows.push_back(json::array());
    for (int j = 0; j < n; ++j) rows.back().push_back(i == j ? scale : 0.0);
  }
  return rows;
}

json deformation_line() {
  return {{"id", "a"},
          {"R", identity_rows(3, 1.0)},
          {"o", {0.001, 0.0, 0.002}},
          {"K", identity_rows(6, 1000.0)},
          {"S_R_S1", identity_rows(3, 1.0)},
          {"S_o_S1", {0.0, 0.0, -0.025}}};
}

json load_line() {
  const json R = {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.0, 0.0, -1.0}};
  return {{"W_R_E", R},
          {"mass", 0.5},
          {"com_S", {0, 0, 0.05}},
          {"K", identity_rows(6, 1000.0)},
          {"E_H_S2", {{"R", identity_rows(3, 1.0)}, {"o", {0.0, 0.0, 0.025}}}},
          {"S_H_S1", {{"R", identity_rows(3, 1.0)}, {"o", {0.0, 0.0, -0.025}}}}};
}

/// The error that `line` makes, or one whose key says that there was none.
template <class F>
InputError error_of(const F& answer, const std::string& line) {
  try {
    const std::string text = answer(line, 7, "lines.jsonl");
    return InputError("", "no error", text, "");
  } catch (const InputError& error) {
    return error;
  }
}

InputError evaluate_error(const json& line) { return error_of(evaluate_json_line, line.dump()); }
InputError settle_error(const json& line) { return error_of(settle_json_line, line.dump()); }

TEST(EvaluateLine, AnswersTheReferenceVectorsAsTheyStandInTheFile) {
  const json vectors = test::load_vectors("wrench.json");
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("wrench.json");
  for (const json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    const json answer = json::parse(evaluate_json_line(c.dump(), 1, "wrench.jsonl"));
    EXPECT_EQ(answer.at("id"), c.at("id"));
    const double V = c.at("V").get<double>();
    EXPECT_LE(std::abs(answer.at("V").get<double>() - V), 1e-10 * (std::abs(V) + 1e-12));  // the vectors' own
    for (const char* key : {"wrench_S1", "wrench_S"}) {
      const Vector6 want = test::vector6(c.at(key));
      EXPECT_LE((test::vector6(answer.at(key)) - want).norm(), 1e-9 * (want.norm() + 1e-6)) << key;
    }
  }
}

TEST(EvaluateLine, WritesNumbersThatReadBackExactly) {
  Rng rng = Rng(1).split("round trip");
  for (int i = 0; i < 100; ++i) {
    const Pose H{Matrix3::Identity(), test::random_vector(rng, 0.01)};
    json line = deformation_line();
    line["o"] = {H.p.x(), H.p.y(), H.p.z()};
    const json answer = json::parse(evaluate_json_line(line.dump(), 1, "x"));
    const Matrix6 K = 1000.0 * Matrix6::Identity();
    EXPECT_EQ(answer.at("V").get<double>(), potential(H, K));
    EXPECT_EQ(test::vector6(answer.at("wrench_S1")), spring_wrench(H, K));
  }
}

TEST(EvaluateLine, IsOneLineAndHasAnIdOnlyWhenAsked) {
  json line = deformation_line();
  EXPECT_EQ(evaluate_json_line(line.dump(), 1, "x").find('\n'), std::string::npos);
  line.erase("id");
  EXPECT_FALSE(json::parse(evaluate_json_line(line.dump(), 1, "x")).contains("id"));
}

TEST(EvaluateLine, NamesFileLineKeyAndTheNearestKeyWhenOneIsUnknown) {
  json line = deformation_line();
  line["S_o_S2"] = line["S_o_S1"];
  const InputError error = evaluate_error(line);
  EXPECT_EQ(error.where, "lines.jsonl:7");
  EXPECT_EQ(error.key, "S_o_S2");
  EXPECT_NE(error.expected.find("S_o_S1"), std::string::npos);
}

TEST(EvaluateLine, RefusesWhatIsMissingMisshapenOrNotARotation) {
  for (const char* key : {"R", "o", "K", "S_R_S1", "S_o_S1"}) {
    json line = deformation_line();
    line.erase(key);
    EXPECT_EQ(evaluate_error(line).key, key);
    EXPECT_EQ(evaluate_error(line).got, "nothing");
    for (const json& wrong : {json("text"), json(1.0), json(nullptr), json::array({1.0, 2.0}), json::object()}) {
      line = deformation_line();
      line[key] = wrong;
      EXPECT_EQ(evaluate_error(line).key, key) << wrong;
    }
  }
  json line = deformation_line();
  line["R"][0][0] = 1.00001;
  EXPECT_EQ(evaluate_error(line).key, "R");
  line["R"][0][0] = 1.0000001;  // printed with seven digits: within 1e-6
  EXPECT_EQ(evaluate_error(line).key, "no error");
  line["R"] = identity_rows(3, -1.0);
  EXPECT_NE(evaluate_error(line).got.find("reflection"), std::string::npos);
  line = deformation_line();
  line["R"][1][2] = "x";
  EXPECT_EQ(evaluate_error(line).key, "R[1][2]");
  line = deformation_line();
  line["o"][2] = nullptr;  // how NaN is usually written
  EXPECT_EQ(evaluate_error(line).key, "o[2]");
}

TEST(EvaluateLine, RefusesAStiffnessThatIsNotOne) {
  json line = deformation_line();
  line["K"][0][4] = 1.0;
  EXPECT_EQ(evaluate_error(line).key, "K[4][0]");
  EXPECT_NE(evaluate_error(line).expected.find("symmetric"), std::string::npos);
  line = deformation_line();
  line["K"][2][2] = -1.0;
  EXPECT_EQ(evaluate_error(line).key, "K");
  line["K"] = identity_rows(6, 0.0);  // positive semi-definite: allowed here
  EXPECT_EQ(evaluate_error(line).key, "no error");
  line["K"] = identity_rows(5, 1.0);
  EXPECT_EQ(evaluate_error(line).got, "5 rows");
}

TEST(EvaluateLine, RefusesWhatIsNotOneObject) {
  for (const char* text : {"", "nonsense", "[1, 2]", "3", "{", "{} {}", "{\"o\": NaN}", "{\"o\": 1e999}"}) {
    SCOPED_TRACE(text);
    const InputError error = error_of(evaluate_json_line, text);
    EXPECT_EQ(error.where, "lines.jsonl:7");
    EXPECT_NE(error.expected, "");
  }
  std::string twice = deformation_line().dump();
  twice.insert(1, "\"o\": [0, 0, 0], ");
  EXPECT_EQ(error_of(evaluate_json_line, twice).key, "o");
  json line = deformation_line();
  line["o"] = {1e200, 0.0, 0.0};
  EXPECT_NE(evaluate_error(line).got.find("overflow"), std::string::npos);
}

TEST(SettleLine, AnswersTheReferenceVectorsAsTheyStandInTheFile) {
  const json vectors = test::load_vectors("static.json");
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("static.json");
  for (const json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    const json answer = json::parse(settle_json_line(c.dump(), 1, "static.jsonl"));
    EXPECT_EQ(answer.at("id"), c.at("id"));
    EXPECT_LE((test::vector3(answer.at("E_o_S")) - test::vector3(c.at("E_o_S"))).norm(), 1e-7);  // the vectors' own
    EXPECT_LE(angle_between(test::matrix3(answer.at("E_R_S")), test::matrix3(c.at("E_R_S"))), 1e-6);
    EXPECT_EQ(answer.at("stable"), true);
    EXPECT_EQ(answer.at("status"), "converged");
  }
}

TEST(SettleLine, TakesGravityFromTheLineAndIs981Otherwise) {
  json line = load_line();
  const auto length = [&line] {
    return json::parse(settle_json_line(line.dump(), 1, "x")).at("E_o_S")[2].get<double>();
  };
  EXPECT_NEAR(length(), 0.05 + 0.5 * 9.81 / 1000.0, 1e-15);
  line["gravity"] = 1.62;
  EXPECT_NEAR(length(), 0.05 + 0.5 * 1.62 / 1000.0, 1e-15);
}

TEST(SettleLine, SaysSoWhenTheLoadIsMoreThanTheCupHolds) {
  json line = load_line();
  line["K"] = identity_rows(6, 5.0);
  for (int i = 0; i < 3; ++i) line["K"][static_cast<std::size_t>(i)][static_cast<std::size_t>(i)] = 2500.0;
  line["com_S"] = {0.3, 0.0, 0.05};
  line["mass"] = 8.0;
  const json answer = json::parse(settle_json_line(line.dump(), 1, "x"));
  EXPECT_EQ(answer.at("stable"), false);
  EXPECT_EQ(answer.at("status"), "beyond_capacity");
}

TEST(SettleLine, RefusesLoadsThatAreNone) {
  json line = load_line();
  line["mass"] = -1.0;
  EXPECT_EQ(settle_error(line).key, "mass");
  line = load_line();
  line["gravity"] = {0.0, 0.0, -9.81};
  EXPECT_EQ(settle_error(line).key, "gravity");
  line = load_line();
  line["K"][5][5] = 0.0;  // free to spin: no place to rest
  EXPECT_EQ(settle_error(line).key, "K");
  line = load_line();
  line["E_H_S2"].erase("o");
  EXPECT_EQ(settle_error(line).key, "E_H_S2.o");
  line = load_line();
  line["S_H_S1"]["p"] = 1.0;
  EXPECT_EQ(settle_error(line).key, "S_H_S1.p");
  line = load_line();
  line["S_H_S1"] = identity_rows(3, 1.0);
  EXPECT_EQ(settle_error(line).key, "S_H_S1");
  line = load_line();
  line["com"] = line["com_S"];
  EXPECT_EQ(settle_error(line).key, "com");
  EXPECT_NE(settle_error(line).expected.find("com_S"), std::string::npos);
}

}  // namespace
}  // namespace snug::cup
