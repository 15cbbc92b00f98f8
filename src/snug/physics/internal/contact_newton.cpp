// Contact Newton: an island's groups, one after the other, until all of its contacts are solved.
#include "snug/physics/internal/contact_newton.hpp"

#include <algorithm>

namespace snug::physics::internal {
namespace {

constexpr int kRounds = 5;  ///< in which groups are found anew, since contacts between them have closed

}  // namespace

int newton_rows(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work) noexcept {
  int iterations = 0;
  work.is_infeasible = false;
  for (int round = 0; round < kRounds; ++round) {
    const bool is_first = round == 0;
    const double enough = is_first ? residuals.wanted : residuals.accepted;
    if (!(work.groups.find(first, end, u, enough) > enough)) return iterations;  // the caller says what is not finite
    int most = 0;
    for (std::size_t i = 0; i < work.groups.count(); ++i) {
      most = std::max(most, solve_group(residuals, work.groups.open(i), u, work.group, &work.groups, !is_first));
      work.groups.close();
      work.is_infeasible |= work.group.is_infeasible;
    }
    iterations += most;
    if (work.is_infeasible) return iterations;
  }
  if (worst_residual(first, end, u) <= residuals.accepted) return iterations;
  return iterations + solve_group(residuals, {first, end}, u, work.group, nullptr, true);
}

}  // namespace snug::physics::internal
