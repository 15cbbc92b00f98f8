// JsonValue and measured tables: what a file may hold, and how each thing that it may not hold is named.
#include "snug/identification/internal/json_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "snug/core/rng.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/internal/measured_table.hpp"
#include "snug/identification/test/helpers.hpp"

namespace snug::identification::internal {
namespace {

using identification::test::expect_refused;
using nlohmann::json;

/// The getter of a document of one value, at the path "a[0]".
template <class Get>
auto read_json(const std::string& text, const Get& get) {
  const json document = parse_json("{\"a\": [" + text + "]}", "m.json");
  return get(JsonValue(document, "m.json").at("a").entries().front());
}

template <class Get>
void expect_json_refused(const std::string& text, const Get& get, const std::string& part) {
  expect_refused([&] { (void)read_json(text, get); }, part);
  expect_refused([&] { (void)read_json(text, get); }, "m.json: a[0]");
}

const auto kNumber = [](const JsonValue& value) { return value.number(); };
const auto kPositive = [](const JsonValue& value) { return value.positive(); };
const auto kNotNegative = [](const JsonValue& value) { return value.not_negative(); };
const auto kRotation = [](const JsonValue& value) { return value.rotation(); };
const auto kQuaternion = [](const JsonValue& value) { return value.quaternion(); };
const auto kSymmetric3 = [](const JsonValue& value) { return value.symmetric3(); };
const auto kSymmetric6 = [](const JsonValue& value) { return value.symmetric6(); };

template <class Matrix>
std::string rows_text(const Matrix& A) {
  json rows = json::array();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    rows.push_back(json::array());
    for (Eigen::Index j = 0; j < A.cols(); ++j) rows.back().push_back(A(i, j));
  }
  return rows.dump();
}

TEST(JsonFile, TellsTheLineOfWhatIsNoJson) {
  expect_refused([] { (void)parse_json("{\n\"a\": 1,\n\"b\": x\n}", "m.json"); }, "m.json:3");
  expect_refused([] { (void)parse_json("{\n\"a\": 1,\n\"b\": x\n}", "m.json"); }, "not JSON at byte 16");
  expect_refused([] { (void)parse_json("{\n\"a\": [1,\n2", "m.json"); }, "a file that ends in the middle");
  expect_refused([] { (void)parse_json("", "m.json"); }, "m.json:1");
  expect_refused([] { (void)parse_json("{} {}", "m.json"); }, "one whole JSON document");
  expect_refused([] { (void)parse_json("[NaN]", "m.json"); }, "m.json:1");
  expect_refused([] { (void)parse_json("[1e999]", "m.json"); }, "beyond the range of double precision");
  expect_refused([] { (void)parse_json("[\"\xff\xfe\"]", "m.json"); }, "m.json:1");
}

TEST(JsonFile, MayBeAsDeepAsItSaysAndNotDeeper) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_NO_THROW((void)parse_json(nested(kDeepestJson), "m.json"));
  expect_refused([&] { (void)parse_json(nested(kDeepestJson + 1), "m.json"); }, "more than 100");
  // Depth is of what is open, not of what was: a list of many short lists is flat.
  std::string flat = "[[]";
  for (int i = 0; i < 300; ++i) flat += ",[[]]";
  EXPECT_NO_THROW((void)parse_json(flat + "]", "m.json"));
}

TEST(JsonFile, TakesFiniteNumbersOfTheSignAskedForOnly) {
  EXPECT_EQ(read_json("-2.5", kNumber), -2.5);
  EXPECT_EQ(read_json("7", kNumber), 7.0);
  EXPECT_EQ(read_json("0", kNotNegative), 0.0);
  EXPECT_EQ(read_json("1e-300", kPositive), 1e-300);
  for (const char* text : {"\"2\"", "null", "true", "[1]", "{}"}) {
    SCOPED_TRACE(text);
    expect_json_refused(text, kNumber, "a finite number");
  }
  expect_json_refused("0", kPositive, "a number above 0");
  expect_json_refused("-1e-9", kPositive, "a number above 0");
  expect_json_refused("-1e-9", kNotNegative, "a number that is not negative");
}

TEST(JsonFile, NamesTheEntryOfAVectorThatIsNone) {
  const auto vector3 = [](const JsonValue& value) { return value.vector3(); };
  const auto vector6 = [](const JsonValue& value) { return value.vector6(); };
  EXPECT_EQ(read_json("[1, 2, 3]", vector3), Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(read_json("[1, 2, 3, 4, 5, 6]", vector6)[5], 6.0);
  expect_json_refused("[1, 2]", vector3, "a list of 3 numbers");
  expect_json_refused("[1, 2, 3, 4]", vector3, "a list of 3 numbers");
  expect_json_refused("{\"x\": 1, \"y\": 2, \"z\": 3}", vector3, "a list of 3 numbers");
  expect_json_refused("[1, null, 3]", vector3, "a[0][1]");
  expect_json_refused("[1, 2, 3, 4, 5]", vector6, "force first");
}

TEST(JsonFile, TakesRotationsRowByRow) {
  Rng rng = Rng(3).split("rotations");
  for (int i = 0; i < 20; ++i) {
    const Matrix3 R = exp_rotation(normal3(rng, 1.5));
    EXPECT_EQ(read_json(rows_text(R), kRotation), R);  // what is written is what is read, not its transposed
  }
  Matrix3 R = exp_rotation(Vector3(0.4, -0.3, 0.9));
  expect_json_refused(rows_text(Matrix3(1.00001 * R)), kRotation, "R^T R equal to the identity within 1e-6");
  expect_json_refused(rows_text(Matrix3(-R)), kRotation, "a reflection, determinant -1");
  R(1, 2) += 1e-4;
  expect_json_refused(rows_text(R), kRotation, "a rotation");
  expect_json_refused("[[1, 0, 0], [0, 1, 0]]", kRotation, "3 rows of 3 numbers");
  expect_json_refused("[[1, 0, 0], [0, 1], [0, 0, 1]]", kRotation, "a[0][1]");
}

TEST(JsonFile, ReadsAQuaternionAsScalarFirstAndOfUnitLength) {
  const double s = std::sqrt(0.5);
  const auto text = [](double w, double x, double y, double z) { return json({w, x, y, z}).dump(); };
  // A quarter turn about x takes y to z.
  EXPECT_LT((read_json(text(s, s, 0, 0), kQuaternion) * Vector3::UnitY() - Vector3::UnitZ()).norm(), 1e-15);
  // A quaternion and its opposite are one rotation; a length that is off by less than 1e-3 makes no stretch.
  EXPECT_EQ(read_json(text(s, s, 0, 0), kQuaternion), read_json(text(-s, -s, 0, 0), kQuaternion));
  const Matrix3 R = read_json(text(0.9995 * s, 0.9995 * s, 0, 0), kQuaternion);
  EXPECT_LT((R.transpose() * R - Matrix3::Identity()).norm(), 1e-15);
  expect_json_refused(text(0.998, 0, 0, 0), kQuaternion, "length 1 within 0.001");
  expect_json_refused(text(1.002, 0, 0, 0), kQuaternion, "length 1 within 0.001");
  expect_json_refused(text(0, 0, 0, 0), kQuaternion, "length 1 within 0.001");
  expect_json_refused("[1, 0, 0]", kQuaternion, "w, x, y, z");
  Matrix3 unused = Matrix3::Zero();
  for (const double bad : {std::nan(""), HUGE_VAL, 1e200}) {
    const double wxyz[4] = {1.0, 0.0, bad, 0.0};
    EXPECT_FALSE(rotation_from_quaternion(wxyz, unused)) << bad;
  }
}

TEST(JsonFile, TakesMatricesThatAreSymmetricWithinTheirRounding) {
  Matrix3 A = Vector3(0.002, 0.003, 0.004).asDiagonal();
  A(0, 1) = A(1, 0) = 1e-4;
  EXPECT_EQ(read_json(rows_text(A), kSymmetric3), A);
  A(0, 1) += 1e-14;
  EXPECT_NO_THROW((void)read_json(rows_text(A), kSymmetric3));
  A(0, 1) += 1e-10;  // relative to the largest entry, 0.004: 2.5e-8
  expect_json_refused(rows_text(A), kSymmetric3, "a symmetric matrix (within 1e-9)");
  Matrix6 K = Matrix6::Identity() * 2000.0;
  K(0, 4) = K(4, 0) = -20.0;
  EXPECT_EQ(read_json(rows_text(K), kSymmetric6), K);
  K(4, 0) = 20.0;
  expect_json_refused(rows_text(K), kSymmetric6, "a symmetric matrix");
  expect_json_refused(rows_text(Matrix3(Matrix3::Identity())), kSymmetric6, "6 rows of 6 numbers");
}

TEST(JsonFile, NamesPathsOfWhatIsNotThere) {
  const json document = parse_json(R"({"records": [{"mass": 1, "pose": {"p": [0]}}]})", "m.json");
  const JsonValue root(document, "m.json");
  const JsonValue record = root.at("records").entries().front();
  EXPECT_TRUE(record.has("mass"));
  EXPECT_FALSE(record.has("masse"));
  EXPECT_EQ(record.where(), "m.json: records[0]");
  EXPECT_EQ(root.where(), "m.json");
  EXPECT_EQ(record.at("pose").at("p").where(), "m.json: records[0].pose.p");
  expect_refused([&] { (void)record.at("com_S"); }, "m.json: records[0].com_S");
  expect_refused([&] { (void)record.at("mass").at("unit"); }, "an object with unit");
  expect_refused([&] { (void)record.entries(); }, "a list that is not empty");
  const json empty = json::array();
  expect_refused([&] { (void)JsonValue(empty, "m.json", "records").entries(); }, "m.json: records");
}

TEST(JsonFile, RefusesSlipsOfTheKeysThatItKnowsAndLeavesOthersAlone) {
  const std::vector<std::string> known = {"mass", "com_S", "wrench_S_meas"};
  const auto check = [&](const char* text) {
    const json document = parse_json(text, "m.json");
    JsonValue(document, "m.json").check_keys(known);
  };
  EXPECT_NO_THROW(check(R"({"mass": 1, "com_S": 2})"));
  EXPECT_NO_THROW(check(R"({"operator_remark": "warm day"})"));
  EXPECT_NO_THROW(check(R"({"mas": 1})"));  // too short to be told from another word
  expect_refused([&] { check(R"({"wrench_S_maes": 1})"); }, "perhaps wrench_S_meas");
  expect_refused([&] { check(R"({"wrench_S_maes": 1})"); }, "m.json: wrench_S_maes");
  expect_refused([&] { check("[1]"); }, "an object");
}

TEST(JsonFile, ShowsLongValuesCut) {
  const json document = parse_json("{\"a\": \"" + std::string(500, 'x') + "\"}", "m.json");
  try {
    (void)JsonValue(document, "m.json").at("a").number();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.got.size(), 60U);
    EXPECT_TRUE(error.got.ends_with("...")) << error.got;
  }
  EXPECT_EQ(JsonValue(document, "m.json").at("a").text().size(), 500U);
  const json number = 12.5;
  EXPECT_EQ(JsonValue(number, "m.json").text(), "12.5");
}

TEST(MeasuredTable, GroupsAreThereWholeInAnyOrderOrNotAtAll) {
  const std::vector<std::string> force = {"fx", "fy", "fz"};
  // The reader brings columns to the order asked for: vectors are read from where the first one stands.
  const Table table = parse_table("fz,t,fx,fy\n3,0,1,2\n", "t.csv", {"t"}, force);
  ASSERT_TRUE(find_group(table, force));
  EXPECT_EQ(vector_at(table, 0, *find_group(table, force)), Vector3(1.0, 2.0, 3.0));
  EXPECT_FALSE(find_group(parse_table("t\n0\n", "t.csv", {"t"}, force), force));
  const Table part = parse_table("t,fy\n0,2\n", "t.csv", {"t"}, force);
  expect_refused([&] { (void)find_group(part, force); }, "it without fx, fz");
  expect_refused([&] { (void)find_group(part, force); }, "column 'fy'");
}

TEST(MeasuredTable, NamesLineAndColumnOfWhatIsNoRotation) {
  const Table table =
      parse_table("# robot\nqw,qx,qy,qz\n1,0,0,0\n\n0.6,0,0.8,0.1\n", "t.csv", {"qw", "qx", "qy", "qz"});
  EXPECT_EQ(rotation_at(table, 0, 0), Matrix3(Matrix3::Identity()));
  expect_refused([&] { (void)rotation_at(table, 1, 0); }, "t.csv:5");
  expect_refused([&] { (void)rotation_at(table, 1, 0); }, "qw");
}

}  // namespace
}  // namespace snug::identification::internal
