// RowGroups: the parts of an island that press on each other, each a contact problem of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "snug/core/worker_pool.hpp"
#include "snug/physics/internal/contact_row.hpp"

namespace snug::physics::internal {

/// An island is held together by all contacts that may matter in the step; half of them bear nothing in a pile. Those
/// that are open and open further are idle: without them the island falls into groups that share no body. Idle contacts
/// within a group are watched while it is solved (OpenGroup); a group of kSharedGroup rows or more watches also those
/// with a body on which nothing bears, where no other such group does. Never allocates after construction.
class RowGroups {
 public:
  RowGroups(std::size_t bodies, std::size_t rows);

  /// The groups in which a row misses its law by more than `residual`. `pool`: threads to use, or nullptr. Returns the
  /// largest such miss of all rows, m/s; where that is not more, groups are not looked for.
  double find(Row* first, Row* end, const double* u, double residual, WorkerPool* pool);
  [[nodiscard]] std::size_t count() const { return groups_.size(); }
  /// Of a group, without the idle.
  [[nodiscard]] std::size_t row_count(std::size_t group) const { return groups_[group].rows; }

 private:
  friend class OpenGroup;
  enum class State : char { Idle, Bears };
  struct Bodies {
    std::int32_t a, b;  ///< active, or -1
    bool operator==(const Bodies&) const = default;
  };
  /// Rows behind each other with the same bodies.
  struct Run {
    Bodies bodies;
    std::size_t first, end;
    std::size_t bearing;  ///< rows that are not idle
    int group = -1;       ///< that they belong to, or that watches them
  };
  struct Group {
    std::size_t rows = 0, end = 0;  ///< in order_: those that bear come first
    std::size_t idle = 0;
    std::size_t next = 0, next_idle = 0;  ///< places in order_, while it is filled
  };

  [[nodiscard]] int root_of(int body);
  double measure(const double* u, WorkerPool* pool);
  void list_runs();
  void join_bodies(double residual);
  void number_groups();
  void sort_rows();
  [[nodiscard]] int group_of(const Bodies& bodies) const;
  [[nodiscard]] int watched_by(const Bodies& bodies) const;
  [[nodiscard]] int free_body(const Bodies& bodies) const;
  void find_groups_beside();

  Row* first_ = nullptr;  ///< of the island
  std::size_t row_count_ = 0;
  std::unique_ptr<State[]> state_;
  std::unique_ptr<Bodies[]> between_;  ///< of each row, since rows themselves are far apart in memory
  std::vector<Run> runs_;
  std::unique_ptr<double[]> miss_;     ///< m/s, of each row that is not idle
  std::vector<int> parent_;            ///< union-find over bodies
  std::vector<int> group_;             ///< of each root: its number, or kNone, kUnsolved; in the end of each body
  std::vector<int> bodies_;            ///< of the island
  std::vector<int> beside_;            ///< of each body: the large group beside it
  std::vector<std::int64_t> seen_in_;  ///< of each body: the search that last met it
  std::int64_t search_ = 0;
  std::vector<Group> groups_;
  std::unique_ptr<int[]> order_;
};

/// One group of RowGroups while it is solved. Groups share no body: several may be open at a time, on as many threads.
/// Never allocates after construction.
class OpenGroup {
 public:
  explicit OpenGroup(std::size_t rows);

  /// Its memory for copies of rows: free for other uses while no group is open.
  [[nodiscard]] const std::shared_ptr<Row[]>& room() const { return copies_; }

  /// The rows of a group behind each other. `groups` stays as it is until close(). `pool`:
  /// threads to use, or nullptr.
  std::span<Row> open(const RowGroups& groups, std::size_t group, WorkerPool* pool);
  /// Adds the idle rows of the group that close as bodies move now. Returns how many.
  std::size_t wake(const double* u, WorkerPool* pool);
  /// Gives the impulses back to the island.
  void close();

 private:
  /// What it takes to see whether an idle row stays idle.
  struct IdleRow {
    double least;  ///< m/s, of the normal velocity that its bodies make
    std::int32_t ia, ib;
    std::int32_t row;  ///< of the island
    bool closes;
  };
  void list_idle(const int* rows, std::size_t count, WorkerPool* pool);
  [[nodiscard]] bool closes(const IdleRow& idle, const double* u) const;

  Row* first_ = nullptr;             ///< of the island
  std::shared_ptr<Row[]> copies_;    ///< of the group
  std::unique_ptr<int[]> source_;    ///< of each copy: its row of the island
  std::size_t copy_count_ = 0;       ///< 0: the group is the island itself
  std::unique_ptr<IdleRow[]> idle_;  ///< of the group
  std::size_t idle_count_ = 0;
};

}  // namespace snug::physics::internal
