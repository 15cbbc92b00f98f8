// BlockSolver: direct solution of sparse linear systems in 6 x 6 blocks of bodies.
#include "snug/physics/internal/block_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <new>

namespace snug::physics::internal {
namespace {

constexpr std::size_t kFillPerBody = 64;
constexpr std::align_val_t kAlignment{64};

std::size_t max_fill(std::size_t bodies) {
  return std::min(bodies * (bodies - std::min<std::size_t>(bodies, 1)) / 2, kFillPerBody * bodies);
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

BlockStore::BlockStore(std::size_t blocks)
    : blocks_(static_cast<Matrix6*>(::operator new(std::max<std::size_t>(1, blocks) * sizeof(Matrix6), kAlignment))) {}

void BlockStore::Free::operator()(Matrix6* blocks) const { ::operator delete(blocks, kAlignment); }

BlockSolver::BlockSolver(std::size_t bodies, std::size_t connections)
    : max_fill_(max_fill(bodies)),
      rank_(bodies),
      body_(bodies),
      column_(bodies + 1),
      row_(max_fill_),
      diagonal_(bodies),
      lower_(max_fill_),
      upper_(max_fill_),
      x_(6 * bodies),
      trace_length_(std::min(bodies, kMaxResponses)),
      trace_ranks_(trace_length_.size() * bodies),
      left_(trace_ranks_.size()),
      right_(trace_ranks_.size()),
      slot_(bodies, -1) {
  connections_.reserve(connections);
  links_.reserve(2 * (max_fill_ + std::min(connections, max_fill_)));
  for (Index* index : {&first_link_, &degree_, &mark_, &next_in_bucket_, &last_in_bucket_}) index->resize(bodies);
  bucket_.resize(bodies + 1);
}

void BlockSolver::begin(int count) {
  count_ = count;
  connections_.clear();
  links_.clear();
  std::fill_n(first_link_.begin(), count, -1);
  std::fill_n(degree_.begin(), count, 0);
  std::fill_n(mark_.begin(), count, -1);
  stamp_ = 0;
}

int BlockSolver::connect(int i, int j) {
  connections_.push_back({i, j, -1});
  return static_cast<int>(connections_.size()) - 1;
}

bool BlockSolver::add_link(int from, int to) {
  if (links_.size() == links_.capacity()) return false;
  links_.push_back({to, first_link_[at(from)]});
  first_link_[at(from)] = static_cast<int>(links_.size()) - 1;
  ++degree_[at(from)];
  return true;
}

void BlockSolver::put_in_bucket(int node, int degree) {
  int& head = bucket_[at(degree)];
  next_in_bucket_[at(node)] = head;
  last_in_bucket_[at(node)] = -1;
  if (head >= 0) last_in_bucket_[at(head)] = node;
  head = node;
  least_degree_ = std::min(least_degree_, degree);
}

void BlockSolver::take_from_bucket(int node) {
  const int next = next_in_bucket_[at(node)], last = last_in_bucket_[at(node)];
  if (next >= 0) last_in_bucket_[at(next)] = last;
  (last >= 0 ? next_in_bucket_[at(last)] : bucket_[at(degree_[at(node)])]) = next;
}

int BlockSolver::take_least() {
  while (bucket_[at(least_degree_)] < 0) ++least_degree_;
  const int node = bucket_[at(least_degree_)];
  take_from_bucket(node);
  return node;
}

/// Makes the neighbours of `node` a clique and writes its column, rows as bodies.
bool BlockSolver::eliminate(int node, int rank) {
  rank_[at(node)] = at(rank);
  body_[at(rank)] = node;
  const std::size_t first = fill_;
  for (int link = first_link_[at(node)]; link >= 0; link = links_[at(link)].next) {
    const int other = links_[at(link)].node;
    if (degree_[at(other)] < 0) continue;  // eliminated
    if (fill_ == max_fill_) return false;
    row_[fill_++] = other;
  }
  column_[at(rank) + 1] = fill_;
  degree_[at(node)] = -1;
  for (std::size_t e = first; e < fill_; ++e) {
    const int i = row_[e];
    take_from_bucket(i);
    mark_[at(i)] = ++stamp_;
    int degree = 0;
    for (int* link = &first_link_[at(i)]; *link >= 0;) {
      const int other = links_[at(*link)].node;
      if (degree_[at(other)] < 0) {  // eliminated: unlink
        *link = links_[at(*link)].next;
        continue;
      }
      mark_[at(other)] = stamp_;
      ++degree;
      link = &links_[at(*link)].next;
    }
    degree_[at(i)] = degree;
    for (std::size_t f = first; f < fill_; ++f) {
      if (mark_[at(row_[f])] != stamp_ && !add_link(i, row_[f])) return false;
    }
    put_in_bucket(i, degree_[at(i)]);
  }
  return true;
}

bool BlockSolver::analyze() {
  for (const Connection& c : connections_) {
    bool is_known = false;
    const bool is_from_i = degree_[at(c.i)] <= degree_[at(c.j)];
    const int from = is_from_i ? c.i : c.j, to = is_from_i ? c.j : c.i;
    for (int link = first_link_[at(from)]; link >= 0 && !is_known; link = links_[at(link)].next) {
      is_known = links_[at(link)].node == to;
    }
    if (!is_known && (!add_link(c.i, c.j) || !add_link(c.j, c.i))) return false;
  }
  std::fill_n(bucket_.begin(), count_ + 1, -1);
  least_degree_ = count_;
  for (int i = count_ - 1; i >= 0; --i) put_in_bucket(i, degree_[at(i)]);
  fill_ = 0;
  column_[0] = 0;
  for (int rank = 0; rank < count_; ++rank) {
    if (!eliminate(take_least(), rank)) return false;
  }
  for (std::size_t e = 0; e < fill_; ++e) row_[e] = static_cast<int>(rank_[at(row_[e])]);
  for (int rank = 0; rank < count_; ++rank) {
    std::sort(row_.begin() + static_cast<std::ptrdiff_t>(column_[at(rank)]),
              row_.begin() + static_cast<std::ptrdiff_t>(column_[at(rank) + 1]));
  }
  for (Connection& c : connections_) {
    const std::size_t low = std::min(rank_[at(c.i)], rank_[at(c.j)]), high = std::max(rank_[at(c.i)], rank_[at(c.j)]);
    const auto begin = row_.begin() + static_cast<std::ptrdiff_t>(column_[low]);
    const auto end = row_.begin() + static_cast<std::ptrdiff_t>(column_[low + 1]);
    c.entry = static_cast<int>(std::lower_bound(begin, end, static_cast<int>(high)) - row_.begin());
  }
  return true;
}

void BlockSolver::set_identity() {
  for (int i = 0; i < count_; ++i) diagonal_[at(i)].setIdentity();
  for (std::size_t e = 0; e < fill_; ++e) {
    lower_[e].setZero();
    upper_[e].setZero();
  }
}

BlockSolver::Coupling BlockSolver::coupling(int connection) {
  const Connection& c = connections_[at(connection)];
  Matrix6& lower = lower_[at(c.entry)];
  Matrix6& upper = upper_[at(c.entry)];
  if (rank_[at(c.i)] < rank_[at(c.j)]) return {upper, lower};
  return {lower, upper};
}

void BlockSolver::factorize() {
  for (int k = 0; k < count_; ++k) {
    const Matrix6 inverse = diagonal_[at(k)].inverse();
    diagonal_[at(k)] = inverse;
    const std::size_t first = column_[at(k)], end = column_[at(k) + 1];
    for (std::size_t e = first; e < end; ++e) {
      const auto i = at(row_[e]);
      Matrix6 factor;
      factor.noalias() = lower_[e] * inverse;
      lower_[e] = factor;
      // Row i of the rest: (i, j) for the rows j of this column. Those after i lie in column i, those before in theirs.
      diagonal_[i].noalias() -= factor * upper_[e];
      std::size_t place = column_[i];
      for (std::size_t f = e + 1; f < end; ++f) {
        while (row_[place] != row_[f]) ++place;
        upper_[place].noalias() -= factor * upper_[f];
      }
    }
    // Lower blocks (j, i) of later columns need the factors of all rows: a second pass over pairs i < j.
    for (std::size_t e = first; e < end; ++e) {
      std::size_t place = column_[at(row_[e])];
      for (std::size_t f = e + 1; f < end; ++f) {
        while (row_[place] != row_[f]) ++place;
        lower_[place].noalias() -= lower_[f] * upper_[e];
      }
    }
  }
}

void BlockSolver::solve(double* x) {
  using Part = Eigen::Map<Vector6>;
  for (int k = 0; k < count_; ++k) Part(x_.data() + 6 * k) = Part(x + 6 * body_[at(k)]);
  for (int k = 0; k < count_; ++k) {
    const Vector6 part = Part(x_.data() + 6 * k);
    for (std::size_t e = column_[at(k)]; e < column_[at(k) + 1]; ++e) {
      Part(x_.data() + 6 * row_[e]).noalias() -= lower_[e] * part;
    }
  }
  for (int k = count_ - 1; k >= 0; --k) {
    Vector6 part = Part(x_.data() + 6 * k);
    for (std::size_t e = column_[at(k)]; e < column_[at(k) + 1]; ++e) {
      part.noalias() -= upper_[e] * Part(x_.data() + 6 * row_[e]);
    }
    Part(x_.data() + 6 * k).noalias() = diagonal_[at(k)] * part;
  }
  for (int k = 0; k < count_; ++k) Part(x + 6 * body_[at(k)]) = Part(x_.data() + 6 * k);
}

/// The first entry of a column is its parent in the elimination tree, and the parent's column holds the later ones: the
/// way of a body ends at a root.
void BlockSolver::trace(int body, std::size_t asked) {
  const std::size_t first = trace_place(asked, 0);
  std::size_t length = 0;
  for (std::size_t k = rank_[at(body)];; k = at(row_[column_[k]])) {
    slot_[k] = static_cast<int>(length);
    trace_ranks_[first + length] = static_cast<int>(k);
    left_[first + length].setZero();
    right_[first + length].setZero();
    ++length;
    if (column_[k] == column_[k + 1]) break;
  }
  trace_length_[asked] = length;
  left_[first].setIdentity();
  right_[first].setIdentity();
  for (std::size_t s = first; s < first + length; ++s) {
    const auto k = at(trace_ranks_[s]);
    left_[s] = left_[s] * diagonal_[k];
    for (std::size_t e = column_[k]; e < column_[k + 1]; ++e) {
      const std::size_t to = first + at(slot_[at(row_[e])]);
      left_[to].noalias() -= left_[s] * upper_[e];
      right_[to].noalias() -= lower_[e] * right_[s];
    }
  }
  for (std::size_t s = first; s < first + length; ++s) slot_[at(trace_ranks_[s])] = -1;
}

void BlockSolver::respond(const std::vector<int>& bodies, std::vector<Matrix6>& response) {
  const std::size_t n = bodies.size();
  for (std::size_t i = 0; i < n; ++i) trace(bodies[i], i);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = trace_place(i, 0);
    for (std::size_t s = 0; s < trace_length_[i]; ++s) slot_[at(trace_ranks_[first + s])] = static_cast<int>(s);
    for (std::size_t j = 0; j < n; ++j) {
      Matrix6& block = response[n * i + j];
      block.setZero();
      for (std::size_t s = trace_place(j, 0); s < trace_place(j, trace_length_[j]); ++s) {
        const int slot = slot_[at(trace_ranks_[s])];
        if (slot >= 0) block.noalias() += left_[first + at(slot)] * right_[s];
      }
    }
    for (std::size_t s = 0; s < trace_length_[i]; ++s) slot_[at(trace_ranks_[first + s])] = -1;
  }
}

}  // namespace snug::physics::internal
