// Questions to the cup model as JSON lines: what `snug cup evaluate` and `snug cup settle` read and print.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace snug::cup {

/// Wrench of one deformation. Reads an object with R, o (H = S2_H_S1), K, S_R_S1, S_o_S1 and answers with V,
/// wrench_S1, wrench_S and bend_deg; `id` is handed on. Units SI, matrices as nested rows, wrenches force first.
/// Throws InputError with "source:line" for anything else: src/snug/cup/README.md lists the keys.
[[nodiscard]] std::string evaluate_json_line(std::string_view line, int line_number, std::string_view source);

/// Where a held load comes to rest. Reads W_R_E, mass, com_S, K, E_H_S2 {R, o}, S_H_S1 {R, o} and perhaps gravity
/// (m/s^2 along -Wz, 9.81 when absent); answers with E_R_S, E_o_S, stable, status, residual, bend_deg, iterations,
/// load_fraction and min_tangent_eig (see SettleResult). Throws InputError as above.
[[nodiscard]] std::string settle_json_line(std::string_view line, int line_number, std::string_view source);

/// One of these.
using AnswerLine = std::string (*)(std::string_view line, int line_number, std::string_view source);
/// Hands the answer of each line that is not blank to `take`, as it comes. Throws InputError as above, and for a line
/// of more than 64 KiB.
void answer_json_lines(std::istream& input, const std::string& source, AnswerLine answer,
                       const std::function<void(const std::string&)>& take);

}  // namespace snug::cup
