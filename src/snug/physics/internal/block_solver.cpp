// BlockSolver: direct solution of sparse linear systems in 6 x 6 blocks of bodies.
#include "snug/physics/internal/block_solver.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/internal/panel_kernels.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::physics::internal {
namespace {

constexpr std::align_val_t kAlignment{64};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Stride = Eigen::OuterStride<>;
using BlockMap = Eigen::Map<Matrix6, 0, Stride>;
using BlockView = Eigen::Map<const Matrix6, 0, Stride>;

/// y += A x over a panel of `rows` x `columns` numbers.
void add_product(int rows, int columns, const double* a, std::ptrdiff_t stride, const double* x, double* y) {
  for (int k = 0; k < columns; ++k, a += stride) {
    const double factor = x[k];
    for (int i = 0; i < rows; ++i) y[i] += a[i] * factor;
  }
}

/// y -= A^T x, sums over even and odd rows apart.
void subtract_transposed(int rows, int columns, const double* a, std::ptrdiff_t stride, const double* x, double* y) {
  for (int k = 0; k < columns; ++k, a += stride) {
    double even = 0.0, odd = 0.0;
    for (int i = 0; i < rows; i += 2) even += a[i] * x[i], odd += a[i + 1] * x[i + 1];
    y[k] -= even + odd;
  }
}

/// Inverse of a block by Gauss and Jordan's elimination in place. Where contacts do not slide every pivot is at least
/// 1, what the identity brings in: only below half of that are rows exchanged.
Matrix6 invert(const BlockView& block) {
  Pair m[6][3];  // by columns
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 3; ++i) m[j][i] = load(&block.coeffRef(2 * i, j));
  }
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    const double pivot = m[k][k / 2][k % 2];
    if (!(std::abs(pivot) > 0.5)) return snug::inverse(Matrix6(block));
    const double scale = 1.0 / pivot;
    m[k][k / 2][k % 2] = 1.0;
    for (Pair& part : m[k]) part *= Pair{scale, scale};
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) {
      if (j == k) continue;
      const double factor = m[j][k / 2][k % 2];
      m[j][k / 2][k % 2] = 0.0;
      for (int i = 0; i < 3; ++i) m[j][i] -= Pair{factor, factor} * m[k][i];
    }
  }
  Matrix6 inverse;
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 3; ++i) store(&inverse(2 * i, j), m[j][i]);
  }
  return inverse;
}

}  // namespace

LazyStore::LazyStore(std::size_t count)
    : data_(static_cast<double*>(::operator new(std::max<std::size_t>(1, count) * sizeof(double), kAlignment))) {}

void LazyStore::Free::operator()(double* data) const { ::operator delete(data, kAlignment); }

FactorStore::FactorStore(std::size_t bodies)
    : lower(36 * BlockPattern::max_blocks(bodies)),
      upper(36 * BlockPattern::max_blocks(bodies)),
      place(bodies),
      product(36 * bodies),
      x(6 * bodies),
      gathered(6 * bodies) {}

BlockSolver::BlockSolver(std::size_t bodies, std::size_t connections, std::shared_ptr<FactorStore> store)
    : pattern_(bodies, connections), store_(std::move(store)) {}

void BlockSolver::set_identity() {
  for (int f = 0; f < pattern_.front_count(); ++f) {
    const Front& front = pattern_.front(f);
    const auto width = static_cast<std::size_t>(front.width);
    std::fill_n(lower(front), 36 * width * at(front.height()), 0.0);
    std::fill_n(upper(front), 36 * width * at(front.rows()), 0.0);
    for (int k = 0; k < 6 * front.width; ++k) lower(front)[k * (lower_stride(front) + 1)] = 1.0;
  }
}

PanelBlock BlockSolver::diagonal(int i) {
  const int rank = pattern_.rank(i);
  const Front& front = pattern_.front(pattern_.front_of(rank));
  const std::ptrdiff_t stride = lower_stride(front);
  return {lower(front) + 6 * (rank - front.first) * (stride + 1), stride, false};
}

BlockSolver::Coupling BlockSolver::coupling(int connection) {
  const BlockPattern::Connection& c = pattern_.connection(connection);
  const int low = std::min(pattern_.rank(c.i), pattern_.rank(c.j));
  const int high = std::max(pattern_.rank(c.i), pattern_.rank(c.j));
  const Front& front = pattern_.front(pattern_.front_of(low));
  const std::ptrdiff_t stride = lower_stride(front);
  const std::ptrdiff_t column = 6 * (low - front.first);
  PanelBlock below, beside;  // (high, low) and (low, high)
  if (high < front.first + front.width) {
    const std::ptrdiff_t other = 6 * (high - front.first);
    below = {lower(front) + other + column * stride, stride, false};
    beside = {lower(front) + column + other * stride, stride, false};
  } else {
    const int place = pattern_.row_place(front, high);
    below = {lower(front) + 6 * (front.width + place) + column * stride, stride, false};
    beside = {upper(front) + 6 * place + column * upper_stride(front), upper_stride(front), true};
  }
  if (pattern_.rank(c.i) < pattern_.rank(c.j)) return {beside, below};
  return {below, beside};
}

void BlockSolver::place_rows(const Front& front) {
  std::vector<int>& place = store_->place;
  for (int k = 0; k < front.width; ++k) place[at(front.first + k)] = k;
  const int* rows = pattern_.rows(front);
  for (int i = 0; i < front.rows(); ++i) place[at(rows[i])] = front.width + i;
}

/// Subtracts what the elimination of an earlier front leaves in the columns and rows of this one.
void BlockSolver::take_update(const Front& front, const BlockPattern::Update& update) {
  const Front& source = pattern_.front(update.source);
  const int* rows = pattern_.rows(source);
  const double* source_lower = lower(source) + 6 * source.width;  // its rows below the diagonal
  const double* source_upper = upper(source);
  const std::ptrdiff_t ld = lower_stride(source), ud = upper_stride(source);
  const std::ptrdiff_t front_ld = lower_stride(front), front_ud = upper_stride(front);
  const int depth = 6 * source.width, count = source.rows();
  const std::vector<int>& place = store_->place;
  double* product = store_->product.get();
  const auto subtract = [&](int first, double* to, std::ptrdiff_t stride, int above) {
    const int height = 6 * (count - first);
    for (int i = first; i < count; ++i) {
      double* c = to + 6 * (place[at(rows[i])] - above);
      const double* p = product + 6 * (i - first);
      for (int j = 0; j < 6; ++j, c += stride, p += height) {
        for (int k = 0; k < 6; ++k) c[k] -= p[k];
      }
    }
  };
  for (int j = update.begin; j < update.end; ++j) {
    const std::ptrdiff_t column = 6 * place[at(rows[j])];
    const int below = 6 * (count - update.begin), beside = 6 * (count - update.end);
    set_product({below, depth, source_lower + 6 * update.begin, ld, source_upper + 6 * j, 1, ud, product, below});
    subtract(update.begin, lower(front) + column * front_ld, front_ld, 0);
    if (beside == 0) continue;
    set_product({beside, depth, source_upper + 6 * update.end, ud, source_lower + 6 * j, 1, ld, product, beside});
    subtract(update.end, upper(front) + column * front_ud, front_ud, front.width);
  }
}

/// LU of the panel, one body after the other.
void BlockSolver::eliminate(const Front& front) {
  double* panel = lower(front);
  double* side = upper(front);
  double* product = store_->product.get();
  const std::ptrdiff_t ld = lower_stride(front), ud = upper_stride(front);
  const int beside = 6 * front.rows();
  for (int c = 0; c < front.width; ++c) {
    const int below = 6 * (front.height() - c - 1);
    double* pivot = panel + 6 * c * (ld + 1);
    const Matrix6 inverse = invert(BlockView(pivot, Stride(ld)));
    BlockMap(pivot, Stride(ld)) = inverse;
    if (below == 0) continue;
    double* column = pivot + 6;
    set_product({below, 6, column, ld, inverse.data(), 6, 1, product, below});
    for (int k = 0; k < 6; ++k) std::copy_n(product + k * below, below, column + k * ld);
    for (int d = c + 1; d < front.width; ++d) {
      const double* right = panel + 6 * c + 6 * d * ld;  // U(c, d)
      subtract_product({below, 6, column, ld, right, ld, 1, panel + 6 * (c + 1) + 6 * d * ld, ld});
      if (beside == 0) continue;
      subtract_product({beside, 6, side + 6 * c * ud, ud, panel + 6 * d + 6 * c * ld, 1, ld, side + 6 * d * ud, ud});
    }
  }
}

void BlockSolver::factorize() {
  for (int f = 0; f < pattern_.front_count(); ++f) {
    const Front& front = pattern_.front(f);
    place_rows(front);
    for (std::size_t i = front.update_begin; i < front.update_end; ++i) take_update(front, pattern_.updates()[i]);
    eliminate(front);
  }
}

void BlockSolver::solve(double* x) {
  using Part = Eigen::Map<Vector6>;
  double* by_rank = store_->x.get();
  double* gathered = store_->gathered.get();
  for (int k = 0; k < count(); ++k) Part(by_rank + 6 * k) = Part(x + 6 * pattern_.body(k));
  for (int f = 0; f < pattern_.front_count(); ++f) {
    const Front& front = pattern_.front(f);
    const std::ptrdiff_t ld = lower_stride(front);
    double* own = by_rank + 6 * front.first;
    for (int c = 0; c < front.width; ++c) {
      for (int d = c + 1; d < front.width; ++d) {
        Part(own + 6 * d).noalias() -= BlockView(lower(front) + 6 * d + 6 * c * ld, Stride(ld)) * Part(own + 6 * c);
      }
    }
    const int rows = front.rows();
    if (rows == 0) continue;
    std::fill_n(gathered, 6 * rows, 0.0);
    add_product(6 * rows, 6 * front.width, lower(front) + 6 * front.width, ld, own, gathered);
    const int* row = pattern_.rows(front);
    for (int i = 0; i < rows; ++i) Part(by_rank + 6 * row[i]) -= Part(gathered + 6 * i);
  }
  for (int f = pattern_.front_count() - 1; f >= 0; --f) {
    const Front& front = pattern_.front(f);
    const std::ptrdiff_t ld = lower_stride(front);
    double* own = by_rank + 6 * front.first;
    const int rows = front.rows();
    const int* row = pattern_.rows(front);
    for (int i = 0; i < rows; ++i) Part(gathered + 6 * i) = Part(by_rank + 6 * row[i]);
    subtract_transposed(6 * rows, 6 * front.width, upper(front), upper_stride(front), gathered, own);
    for (int c = front.width - 1; c >= 0; --c) {
      Vector6 part = Part(own + 6 * c);
      for (int d = c + 1; d < front.width; ++d) {
        part.noalias() -= BlockView(lower(front) + 6 * c + 6 * d * ld, Stride(ld)) * Part(own + 6 * d);
      }
      Part(own + 6 * c).noalias() = BlockView(lower(front) + 6 * c * (ld + 1), Stride(ld)) * part;
    }
  }
  for (int k = 0; k < count(); ++k) Part(x + 6 * pattern_.body(k)) = Part(by_rank + 6 * k);
}

}  // namespace snug::physics::internal
