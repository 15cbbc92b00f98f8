// JSON lines of the cup: one question a line in, one answer a line out; behind `snug cup evaluate` and `snug cup settle`.
#pragma once

#include <string>
#include <string_view>

namespace snug::cup {

/// Wrench of a deformation. Keys in: R, o, K; S_R_S1, S_o_S1 (default: S = S1); id (echoed). Out: wrench_S, wrench_S1, V.
/// Other keys of a stored test case are accepted and ignored. Throws InputError{where, key, ...}.
[[nodiscard]] std::string evaluate_json_line(const std::string& line, std::string_view where = "line 1");

/// Where a held load hangs. Keys in: W_R_E, mass, com_S, K, E_H_S2 and S_H_S1 (each {R, o}), gravity (m/s^2 downwards,
/// default 9.81), id (echoed). Out: E_R_S, E_o_S, stable, residual, bend_deg, status, iterations. Other keys of a stored
/// test case are accepted and ignored. Throws InputError{where, key, ...}.
[[nodiscard]] std::string settle_json_line(const std::string& line, std::string_view where = "line 1");

}  // namespace snug::cup
