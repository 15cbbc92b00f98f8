// ContactSystem: bodies and patches of a group, blocks of its linear system.
#include "snug/physics/internal/contact_system.hpp"

#include <algorithm>
#include <utility>

#include "snug/physics/internal/panel_kernels.hpp"

namespace snug::physics::internal {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

ContactSystem::ContactSystem(std::size_t bodies, std::size_t rows, std::shared_ptr<FactorStore> store)
    : place_(bodies, -1), solver_(bodies, rows, std::move(store)), right_(6 * bodies) {
  bodies_.reserve(bodies);
  patches_.reserve(rows);
}

void ContactSystem::begin() {
  for (const int body : bodies_) place_[at(body)] = -1;
  bodies_.clear();
  patches_.clear();
  row_count_ = 0;
  is_analyzed_ = false;
}

void ContactSystem::add_body(int body) {
  if (body < 0 || place_[at(body)] >= 0) return;
  place_[at(body)] = static_cast<int>(bodies_.size());
  bodies_.push_back(body);
}

void ContactSystem::add_row(const Row& row) {
  const bool is_same = !patches_.empty() && patches_.back().ia == row.ia && patches_.back().ib == row.ib &&
                       patches_.back().count < kMaxContactTerms;
  if (!is_same) {
    add_body(row.ia);
    add_body(row.ib);
    patches_.push_back({row_count_, 0, row.ia, row.ib, -1, {}});
    is_analyzed_ = false;
  }
  ++patches_.back().count;
  ++row_count_;
}

bool ContactSystem::analyze() {
  solver_.begin(static_cast<int>(bodies_.size()));
  for (RowPatch& patch : patches_) {
    if (patch.ia >= 0 && patch.ib >= 0) patch.connection = solver_.connect(place_[at(patch.ia)], place_[at(patch.ib)]);
  }
  if (!solver_.analyze()) return false;
  for (RowPatch& patch : patches_) {
    if (patch.ia >= 0) patch.blocks.aa = solver_.diagonal(place_[at(patch.ia)]);
    if (patch.ib >= 0) patch.blocks.bb = solver_.diagonal(place_[at(patch.ib)]);
    if (patch.connection < 0) continue;
    const BlockSolver::Coupling coupling = solver_.coupling(patch.connection);
    patch.blocks.ab = coupling.ij, patch.blocks.ba = coupling.ji;
  }
  is_analyzed_ = true;
  return true;
}

bool ContactSystem::factorize(const Row* rows, const NewtonLaw* laws) {
  if (!is_analyzed_ && !analyze()) return false;
  solver_.set_identity();
  for (const RowPatch& patch : patches_) add_patch(patch, rows, laws);
  solver_.factorize();
  return true;
}

/// What the contacts of one pair of bodies bring in.
void ContactSystem::add_patch(const RowPatch& patch, const Row* rows, const NewtonLaw* laws) {
  ContactTerm terms[kMaxContactTerms];
  const bool is_pair = patch.connection >= 0;
  const int column = is_pair || patch.ia >= 0 ? 0 : 6;
  int count = 0;
  for (int i = patch.first; i < patch.first + patch.count; ++i) {
    if (laws[i].law.slope[0] > 0.0) terms[count++] = {rows[i].j[0] + column, laws[i].law.slope};
  }
  if (count == 0) return;
  if (is_pair) return add_contact_terms(terms, count, patch.blocks);
  add_contact_terms(terms, count, patch.ia >= 0 ? patch.blocks.aa : patch.blocks.bb);
}

void ContactSystem::solve(const double* y, double* x) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) std::copy_n(y + 6 * bodies_[i], 6, right_.data() + 6 * i);
  solver_.solve(right_.data());
  for (std::size_t i = 0; i < bodies_.size(); ++i) std::copy_n(right_.data() + 6 * i, 6, x + 6 * bodies_[i]);
}

}  // namespace snug::physics::internal
