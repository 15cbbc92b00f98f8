// RowClusters: the parts of an island whose contacts are not solved yet, as small contact problems of their own.
#pragma once

#include <cstddef>
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
  /// Rows that they may have.
  struct Limits {
    std::size_t all, each;
  };

  RowClusters(std::size_t bodies, std::size_t rows);

  /// Takes the bodies of all rows above `residual` and, `rings` times, what touches these; then the rows between them.
  /// False when these are more than `most`: then it has no parts.
  [[nodiscard]] bool find(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches, double residual,
                          int rings, std::size_t most, WorkerPool* pool);
  /// The same with rings of their own: one around a body that is found at an unsolved row for the first time, one more
  /// each time that it is found again. All bodies of a cluster go on from the most of them, so it grows as long as its
  /// solution only moves what is unsolved. Fewer rings where there would be more rows than `most`; false where there
  /// would be without any.
  [[nodiscard]] bool find_growing(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches,
                                  double residual, const Limits& most, WorkerPool* pool);
  /// Forgets which bodies were found before.
  void forget();
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
  void find_unsolved(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches, double residual,
                     WorkerPool* pool);
  void add_rings();
  void join();
  [[nodiscard]] int& cluster_of(const RowPatch& patch);
  void count_rows();
  void take_bodies();
  [[nodiscard]] bool take_ring(std::size_t most);
  void share_rings();
  void copy_rows(const Row* rows, WorkerPool* pool);

  std::unique_ptr<Bearing[]> bearings_;   ///< of each patch
  std::vector<const RowPatch*> bearing_;  ///< open ones join nothing and are left out
  std::vector<const RowPatch*> taken_;    ///< those of them in clusters
  std::vector<int> unsolved_;             ///< bodies at unsolved rows
  std::vector<int> rings_;                ///< of each body, when it is at an unsolved row
  std::vector<int> reach_;                ///< of each body: rings that are to be added around it, or -1
  std::vector<int> parent_;               ///< union-find over bodies
  std::vector<int> cluster_;              ///< of each root, or -1
  std::vector<std::size_t> ends_;         ///< of each cluster, in copies_
  std::vector<int> most_rings_;           ///< of each cluster
  std::unique_ptr<Row[]> copies_;
  std::unique_ptr<int[]> source_;  ///< of each copy: its row
};

}  // namespace snug::physics::internal
