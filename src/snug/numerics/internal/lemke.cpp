// Lemke: the packaged pivoting solver of linear complementarity problems, behind a call without its types.
#include "snug/numerics/internal/lemke.hpp"

#include <LCP_Solvers.h>
#include <LinearComplementarityProblem.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <lcp_cst.h>

#include <algorithm>
#include <cstdlib>

namespace snug::numerics::internal {

struct Lemke::Options {
  SolverOptions* options = solver_options_create(SICONOS_LCP_LEMKE);
  Options() { options->iparam[SICONOS_IPARAM_MAX_ITER] = 500; }  // a few times the largest number of rows
  ~Options() {
    solver_options_delete(options);  // what it holds
    std::free(options);
  }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;
};

Lemke::Lemke() : options_(std::make_unique<Options>()) {}
Lemke::~Lemke() = default;
Lemke::Lemke(Lemke&&) noexcept = default;
Lemke& Lemke::operator=(Lemke&&) noexcept = default;

bool Lemke::solve(int size, double* M, double* q, double* z, double* w) {
  std::fill(z, z + size, 0.0);
  std::fill(w, w + size, 0.0);
  NumericsMatrix matrix{};
  matrix.storageType = NM_DENSE;
  matrix.size0 = size;
  matrix.size1 = size;
  matrix.matrix0 = M;
  LinearComplementarityProblem problem{size, &matrix, q};
  int info = 1;
  lcp_lexicolemke(&problem, z, w, &info, options_->options);
  return info == 0;
}

}  // namespace snug::numerics::internal
