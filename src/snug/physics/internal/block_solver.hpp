// BlockSolver: direct solution of sparse linear systems in 6 x 6 blocks of bodies.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::physics::internal {

/// Memory for blocks that is reserved at once and becomes real only where it is written to.
class BlockStore {
 public:
  explicit BlockStore(std::size_t blocks);
  [[nodiscard]] Matrix6& operator[](std::size_t i) { return blocks_.get()[i]; }
  [[nodiscard]] const Matrix6& operator[](std::size_t i) const { return blocks_.get()[i]; }

 private:
  struct Free {
    void operator()(Matrix6* blocks) const;
  };
  std::unique_ptr<Matrix6, Free> blocks_;
};

/// LU factorisation of matrices I + sum J^T S J, whose pattern is symmetric and whose blocks on the diagonal stay
/// regular without pivoting. Bodies are eliminated in the order of minimum degree (ties: least recently touched), so
/// that fill, work and the bytes of the result depend on the pattern alone. Never allocates after construction.
///
/// For a pattern: begin(n), connect(i, j) for pairs of bodies that share contacts, analyze(). For a matrix:
/// set_identity(), add to diagonal() and coupling(), factorize(), solve().
class BlockSolver {
 public:
  /// For up to `bodies` bodies and `connections` calls of connect().
  BlockSolver(std::size_t bodies, std::size_t connections);

  void begin(int count);
  /// Returns the number of this call, for coupling(). Pairs i != j may repeat.
  int connect(int i, int j);
  /// Order and fill. False when the fill does not fit into the memory reserved (64 blocks a body).
  [[nodiscard]] bool analyze();

  void set_identity();
  [[nodiscard]] Matrix6& diagonal(int i) { return diagonal_[rank_[static_cast<std::size_t>(i)]]; }
  struct Coupling {
    Matrix6& ij;  ///< row i, column j of connect(i, j)
    Matrix6& ji;
  };
  [[nodiscard]] Coupling coupling(int connection);

  /// Overwrites the matrix by its factors.
  void factorize();
  /// A^-1 x in place, 6 entries a body.
  void solve(double* x);

  /// Blocks (i, j) of A^-1 for the bodies given, of a factorised A, as 6n x 6n, row-major by body. Costs only the ways
  /// of these bodies through the elimination. At most kMaxResponses bodies.
  static constexpr std::size_t kMaxResponses = 24;
  void respond(const std::vector<int>& bodies, std::vector<Matrix6>& response);

  [[nodiscard]] int count() const { return count_; }
  /// Pairs of blocks beside the diagonal in the factors.
  [[nodiscard]] std::size_t fill() const { return fill_; }

 private:
  struct Link {
    int node, next;
  };
  struct Connection {
    int i, j, entry;
  };
  using Index = std::vector<int>;

  bool add_link(int from, int to);
  bool eliminate(int node, int rank);
  void put_in_bucket(int node, int degree);
  void take_from_bucket(int node);
  int take_least();

  std::size_t max_fill_;
  int count_ = 0;
  std::size_t fill_ = 0;
  std::vector<Connection> connections_;
  // Elimination graph: lists of neighbours, those already eliminated are dropped on the way.
  std::vector<Link> links_;
  Index first_link_, degree_, mark_, bucket_, next_in_bucket_, last_in_bucket_;
  int stamp_ = 0, least_degree_ = 0;
  // Factors by rank, the position in the order of elimination. Entry e of column k couples k with row_[e] > k.
  std::vector<std::size_t> rank_;    ///< of each body
  Index body_;                       ///< of each rank
  std::vector<std::size_t> column_;  ///< first entry of each rank, and one past the last
  Index row_;                        ///< rank of each entry
  BlockStore diagonal_, lower_, upper_;
  std::vector<double> x_;  ///< by rank
  /// What a body touches on its way through the elimination, by body asked for: ranks, rows of U^-1, columns of L^-1.
  void trace(int body, std::size_t asked);
  [[nodiscard]] std::size_t trace_place(std::size_t asked, std::size_t step) const {
    return asked * rank_.size() + step;
  }
  std::vector<std::size_t> trace_length_;
  Index trace_ranks_;
  BlockStore left_, right_;
  Index slot_;  ///< of each rank on the way at hand, or -1
};

}  // namespace snug::physics::internal
