// Contact law: what steps of Newton's method take the law of one contact for. docs/theory/contact.md, section 4.
#pragma once

#include <algorithm>

#include "snug/physics/internal/contact_row.hpp"

namespace snug::physics::internal {

enum class ContactStatus : char { Unknown, Open, Sticks, Slides };

/// A contact law about the present state: what it answers to a relative velocity, and minus its derivative.
struct LinearLaw {
  double lambda[3];  ///< N s
  double slope[9];   ///< row-major, N s/(m/s)
};

/// Of the normal axis, 1/kg. Turning rows have none; the largest penalty then makes the law of their known impulse.
inline double rigid_mobility(const Row& row) { return std::max(row.W[0] - row.gamma, 1e-30); }

inline ContactStatus open_law(LinearLaw& law) {
  std::fill_n(law.slope, 9, 0.0);
  std::fill_n(law.lambda, 3, 0.0);
  return ContactStatus::Open;
}

/// Law of one step of Alart and Curnier's generalized Newton method: the status is that of the natural map, the law of
/// that status is linearised about the present impulse and velocity. `penalty` in units of 1 / W.
ContactStatus generalized_law(const Row& row, double penalty, const double (&xi)[3], LinearLaw& law);

/// The Alart-Curnier law relaxed around `center` with penalties [N s/(m/s)].
void augmented_law(const Row& row, double penalty_n, double penalty_t, const double* center, const double (&xi)[3],
                   LinearLaw& law);

}  // namespace snug::physics::internal
