// minimize_bounded: NLopt behind one function.
#include "snug/numerics/bounded_search.hpp"

#include <cmath>
#include <nlopt.hpp>
#include <vector>

#include "snug/core/check.hpp"

namespace snug::numerics {
namespace {

constexpr double kWorst = 1e300;

std::string name_of(nlopt::result result) {
  switch (result) {
    case nlopt::XTOL_REACHED:
      return "the unknowns no longer change";
    case nlopt::MAXEVAL_REACHED:
      return "all evaluations were used";
    default:
      return "the cost no longer changes";
  }
}

}  // namespace

SearchResult minimize_bounded(const std::function<double(const Eigen::VectorXd&)>& cost, const Eigen::VectorXd& start,
                              const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                              const SearchOptions& options) {
  const Eigen::VectorXd span = upper - lower;
  SNUG_CHECK(start.size() > 0 && (span.array() > 0.0).all(), "a search has unknowns with room between their bounds");
  const Eigen::Index n = start.size();
  SearchResult best{start, kWorst, 0, ""};
  // In units of the span, so that one tolerance is right for all.
  const auto evaluate = [&](const std::vector<double>& s) {
    const Eigen::VectorXd x = lower + span.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(s.data(), n));
    ++best.evaluations;
    const double value = cost(x);
    if (!std::isfinite(value)) return kWorst;
    if (value < best.cost) best.cost = value, best.x = x;
    return value;
  };
  using Cost = decltype(evaluate);
  const auto call = [](const std::vector<double>& s, std::vector<double>&, void* data) {
    return (*static_cast<Cost*>(data))(s);
  };
  nlopt::opt search(options.method == SearchMethod::Subplex ? nlopt::LN_SBPLX : nlopt::GN_CRS2_LM,
                    static_cast<unsigned>(n));
  nlopt::srand(static_cast<unsigned long>(options.seed));
  search.set_lower_bounds(0.0);
  search.set_upper_bounds(1.0);
  search.set_min_objective(call, const_cast<void*>(static_cast<const void*>(&evaluate)));
  search.set_maxeval(options.evaluations);
  // Controlled random search compares its best with the best before: one lucky small step would end it.
  if (options.method == SearchMethod::Subplex) search.set_xtol_abs(options.tolerance);
  const Eigen::VectorXd first = (start - lower).cwiseQuotient(span).cwiseMax(0.0).cwiseMin(1.0);
  std::vector<double> s(first.data(), first.data() + n);
  if (options.step.size() == n) {
    const Eigen::VectorXd step = options.step.cwiseQuotient(span);
    search.set_initial_step(std::vector<double>(step.data(), step.data() + n));
  } else {
    search.set_initial_step(0.1);
  }
  double least = 0.0;
  best.message = name_of(search.optimize(s, least));
  return best;
}

}  // namespace snug::numerics
