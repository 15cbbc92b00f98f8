// ContactSystem: bodies and patches of a group, blocks of its linear system.
#include "snug/physics/internal/contact_system.hpp"

#include <algorithm>

#include "snug/physics/internal/panel_kernels.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kMaxPatchRows = 8;  ///< whose products are made at once

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// M += the block whose columns lie behind each other at `stride`.
void add_block(const PanelBlock& M, const double* block, std::ptrdiff_t stride) {
  if (M.is_transposed) {
    for (int j = 0; j < 6; ++j, block += stride) {
      for (int i = 0; i < 6; ++i) M.data[j + i * M.stride] += block[i];
    }
    return;
  }
  double* column = M.data;
  for (int j = 0; j < 6; ++j, column += M.stride, block += stride) {
    for (int i = 0; i < 6; i += 2) store(column + i, load(column + i) + load(block + i));
  }
}

/// slope * rows.
void multiply(const double (&slope)[9], const double (&rows)[3][6], double* out) {
  for (int i = 0; i < 3; ++i) {
    const Pair s0{slope[3 * i], slope[3 * i]}, s1{slope[3 * i + 1], slope[3 * i + 1]},
        s2{slope[3 * i + 2], slope[3 * i + 2]};
    for (int k = 0; k < 6; k += 2) {
      store(out + 6 * i + k, load(rows[0] + k) * s0 + load(rows[1] + k) * s1 + load(rows[2] + k) * s2);
    }
  }
}

}  // namespace

ContactSystem::ContactSystem(std::size_t bodies, std::size_t rows)
    : place_(bodies, -1), solver_(bodies, rows), right_(6 * bodies) {
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
                       patches_.back().count < kMaxPatchRows;
  if (!is_same) {
    add_body(row.ia);
    add_body(row.ib);
    patches_.push_back({row_count_, 0, row.ia, row.ib, -1, {}, {}, {}, {}});
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
    if (patch.ia >= 0) patch.aa = solver_.diagonal(place_[at(patch.ia)]);
    if (patch.ib >= 0) patch.bb = solver_.diagonal(place_[at(patch.ib)]);
    if (patch.connection < 0) continue;
    const BlockSolver::Coupling coupling = solver_.coupling(patch.connection);
    patch.ab = coupling.ij, patch.ba = coupling.ji;
  }
  is_analyzed_ = true;
  return true;
}

bool ContactSystem::factorize(const Row* rows, const NewtonRow* newton) {
  if (!is_analyzed_ && !analyze()) return false;
  solver_.set_identity();
  for (const RowPatch& patch : patches_) add_patch(patch, rows, newton);
  solver_.factorize();
  return true;
}

/// What the contacts of one pair of bodies bring in: [a b]^T slope a and [a b]^T slope b, each one product.
void ContactSystem::add_patch(const RowPatch& patch, const Row* rows, const NewtonRow* newton) {
  alignas(64) double left[3 * kMaxPatchRows * 12], force_a[3 * kMaxPatchRows * 6], force_b[3 * kMaxPatchRows * 6];
  alignas(64) double product[12 * 6];
  const Row* row = rows + patch.first;
  newton += patch.first;
  const bool is_pair = patch.connection >= 0;
  const int width = is_pair ? 12 : 6;
  int depth = 0;
  for (int i = 0; i < patch.count; ++i, ++row, ++newton) {
    const double(&slope)[9] = newton->law.slope;
    if (slope[0] <= 0.0) continue;
    const double(&own)[3][6] = row->ia >= 0 ? row->a : row->b;
    double* to = left + depth * width;
    for (int k = 0; k < 3; ++k, to += width) {
      std::copy_n(own[k], 6, to);
      if (is_pair) std::copy_n(row->b[k], 6, to + 6);
    }
    multiply(slope, own, force_a + 6 * depth);
    if (is_pair) multiply(slope, row->b, force_b + 6 * depth);
    depth += 3;
  }
  if (depth == 0) return;
  set_product({width, depth, left, width, force_a, 1, 6, product, width});
  if (!is_pair) return add_block(patch.ia >= 0 ? patch.aa : patch.bb, product, width);
  add_block(patch.aa, product, width);
  add_block(patch.ba, product + 6, width);
  set_product({width, depth, left, width, force_b, 1, 6, product, width});
  add_block(patch.ab, product, width);
  add_block(patch.bb, product + 6, width);
}

void ContactSystem::solve(const double* y, double* x) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) std::copy_n(y + 6 * bodies_[i], 6, right_.data() + 6 * i);
  solver_.solve(right_.data());
  for (std::size_t i = 0; i < bodies_.size(); ++i) std::copy_n(right_.data() + 6 * i, 6, x + 6 * bodies_[i]);
}

}  // namespace snug::physics::internal
