// RowClusters: the parts of an island whose contacts are not solved yet, as small contact problems of their own.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "snug/core/worker_pool.hpp"
#include "snug/physics/internal/contact_row.hpp"

namespace snug::physics::internal {

struct RowPatch;
struct NewtonRow;

/// Rows near those whose residual is too large, in groups that share no body: each can be solved alone, with the
/// impulses of all other rows as they are. Never allocates after construction.
class RowClusters {
 public:
  /// How many rows they may have.
  struct Limits {
    double all;  ///< of those of the island
    std::size_t each = std::numeric_limits<std::size_t>::max();
  };

  RowClusters(std::size_t bodies, std::size_t rows);

  /// Takes the bodies of all rows above `residual` and, `rings` times, what touches these; then the rows between them.
  /// False when these are more than `most`: then it has no parts.
  [[nodiscard]] bool find(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches, double residual,
                          int rings, const Limits& most, WorkerPool* pool);
  /// Copies of the rows of each, in the order of the island.
  [[nodiscard]] std::size_t count() const { return ends_.size(); }
  [[nodiscard]] std::span<Row> operator[](std::size_t cluster);
  /// The impulses of all clusters.
  void put_back(Row* rows) const;

 private:
  enum class Bearing : char { None, Solved, Unsolved };

  [[nodiscard]] int root_of(int body);
  [[nodiscard]] static Bearing bearing_of(const RowPatch& patch, const Row* rows, const NewtonRow* newton,
                                          double residual);
  void mark_unsolved(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches, double residual,
                     WorkerPool* pool);
  void add_ring(int ring);
  [[nodiscard]] std::size_t join();
  [[nodiscard]] int& cluster_of(const RowPatch& patch);
  void count_rows();
  void copy_rows(const Row* rows, WorkerPool* pool);

  std::unique_ptr<Bearing[]> bearings_;   ///< of each patch
  std::vector<const RowPatch*> bearing_;  ///< open ones join nothing and are left out
  std::vector<int> ring_;                 ///< of each body: the ring that took it, or -1
  std::vector<int> parent_;               ///< union-find over bodies
  std::vector<int> cluster_;              ///< of each root, or -1
  std::vector<std::size_t> ends_;         ///< of each cluster, in copies_
  std::unique_ptr<Row[]> copies_;
  std::unique_ptr<int[]> source_;  ///< of each copy: its row
};

}  // namespace snug::physics::internal
