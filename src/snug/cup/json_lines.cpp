// Questions to the cup model as JSON lines: what `snug cup evaluate` and `snug cup settle` read and print.
#include "snug/cup/json_lines.hpp"

#include <cmath>
#include <istream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/cup/internal/line_reader.hpp"
#include "snug/cup/law.hpp"
#include "snug/cup/statics.hpp"

namespace snug::cup {
namespace {

using internal::LineReader;
using nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

template <class V>
ordered_json list_of(const V& vector) {
  ordered_json list = ordered_json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(vector[i]);
  return list;
}

ordered_json rows_of(const Matrix3& R) {
  ordered_json rows = ordered_json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({R(i, 0), R(i, 1), R(i, 2)});
  return rows;
}

/// Every number is written with as many digits as it takes to read the same one back.
ordered_json begin_answer(const LineReader& line) {
  ordered_json answer = ordered_json::object();
  if (const auto id = line.content().find("id"); id != line.content().end()) answer["id"] = *id;
  return answer;
}

constexpr std::size_t kLongestLine = 65536;  // a question with all its digits has some 1500

/// Like std::getline, but of a line that does not end only a little more than is allowed.
bool read_line(std::istream& input, std::string& line) {
  line.clear();
  for (int c = input.get(); c != std::char_traits<char>::eof(); c = input.get()) {
    if (c == '\n' || line.size() > kLongestLine) return true;
    line += static_cast<char>(c);
  }
  return !line.empty();
}

}  // namespace

std::string evaluate_json_line(std::string_view line, int line_number, std::string_view source) {
  const LineReader reader(line, line_number, source, {"id", "R", "o", "K", "S_R_S1", "S_o_S1"},
                          {"kind", "e", "V", "wrench_S1", "wrench_S", "reaction_on_gripper_S2", "bend_deg"});
  const Pose H{reader.rotation("R"), reader.vector("o")};
  const Matrix6 K = reader.stiffness("K");
  const Pose X_SS1{reader.rotation("S_R_S1"), reader.vector("S_o_S1")};
  const double V = potential(H, K);
  const Vector6 wrench_S1 = spring_wrench(H, K);
  const Vector6 wrench_S = wrench_transform(X_SS1) * wrench_S1;
  if (!std::isfinite(V) || !wrench_S1.allFinite() || !wrench_S.allFinite()) {
    reader.fail("K", "numbers whose products overflow", "a wrench within the range of double precision");
  }
  ordered_json answer = begin_answer(reader);
  answer["V"] = V;
  answer["wrench_S1"] = list_of(wrench_S1);
  answer["wrench_S"] = list_of(wrench_S);
  answer["bend_deg"] = bend_angle(H.R) * kDegrees;
  return answer.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string settle_json_line(std::string_view line, int line_number, std::string_view source) {
  const LineReader reader(
      line, line_number, source, {"id", "W_R_E", "mass", "com_S", "K", "E_H_S2", "S_H_S1", "gravity"},
      {"tilt_deg", "L0", "W_o_E", "E_R_S", "E_o_S", "E_q_S_wxyz", "H_R", "H_o", "rot_deg", "disp_mm", "wrench_S",
       "residual", "min_tangent_eig", "stable", "status", "bend_deg", "iterations", "load_fraction"});
  HeldLoad load;
  load.R_WE = reader.rotation("W_R_E");
  load.mass = reader.number_at_least_zero("mass");
  load.p_SScm = reader.vector("com_S");
  load.stiffness = reader.stiffness("K");
  load.X_ES2 = reader.pose("E_H_S2");
  load.X_SS1 = reader.pose("S_H_S1");
  if (reader.content().contains("gravity")) load.gravity_W.z() = -reader.number_at_least_zero("gravity");
  const SettleResult result = settle(load);
  if (result.status == SettleStatus::BadInput) {
    reader.fail("K", "a stiffness without a free direction", "a positive definite matrix");
  }
  if (!result.X_ES.p.allFinite() || !std::isfinite(result.residual)) {
    reader.fail("mass", "numbers whose products overflow", "a load within the range of double precision");
  }
  ordered_json answer = begin_answer(reader);
  answer["E_R_S"] = rows_of(result.X_ES.R);
  answer["E_o_S"] = list_of(result.X_ES.p);
  answer["stable"] = result.is_stable;
  answer["status"] = name_of(result.status);
  answer["residual"] = result.residual;
  answer["bend_deg"] = result.bend * kDegrees;
  answer["iterations"] = result.iterations;
  answer["load_fraction"] = result.load_fraction;
  answer["min_tangent_eig"] = result.smallest_eigenvalue;
  return answer.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

void answer_json_lines(std::istream& input, const std::string& source, AnswerLine answer,
                       const std::function<void(const std::string&)>& take) {
  std::string line;
  for (int number = 1; read_line(input, line); ++number) {
    if (line.size() > kLongestLine) {
      throw InputError(source + ":" + std::to_string(number), "",
                       "a line of more than " + std::to_string(kLongestLine) + " bytes",
                       "one JSON object on each line");
    }
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    take(answer(line, number, source));
  }
}

}  // namespace snug::cup
