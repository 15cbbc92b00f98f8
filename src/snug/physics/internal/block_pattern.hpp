// BlockPattern: in which order bodies are eliminated from a sparse linear system, and which blocks that fills.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/core/bounded_vector.hpp"

namespace snug::physics::internal {

/// Order of minimum degree (ties: least recently touched), then by the elimination tree, so that bodies which fill
/// nearly the same rows stand beside each other: these form a front and share a dense panel. All of it depends on the
/// pattern alone. Never allocates after construction.
class BlockPattern {
 public:
  /// Bodies [first, first + width) in the order of elimination, and the later ones that their elimination touches.
  struct Front {
    int first = 0, width = 0;
    std::size_t row_begin = 0, row_end = 0;        ///< in rows()
    std::size_t panel = 0;                         ///< blocks before it, of panels of width x (width + rows)
    std::size_t update_begin = 0, update_end = 0;  ///< in updates()
    [[nodiscard]] int rows() const { return static_cast<int>(row_end - row_begin); }
    [[nodiscard]] int height() const { return width + rows(); }
  };
  /// An earlier front that changes this one: its rows [begin, end), counted from its first, are bodies of this one.
  struct Update {
    int source = 0, begin = 0, end = 0;
  };

  BlockPattern(std::size_t bodies, std::size_t connections);

  void begin(int count);
  /// Returns the number of this call. Pairs i != j may repeat.
  int connect(int i, int j);
  /// False when the fill does not fit into the memory reserved.
  [[nodiscard]] bool analyze();

  [[nodiscard]] static std::size_t max_blocks(std::size_t bodies);
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int rank(int body) const { return rank_[static_cast<std::size_t>(body)]; }
  [[nodiscard]] int body(int rank) const { return body_[static_cast<std::size_t>(rank)]; }
  struct Connection {
    int i = 0, j = 0;
    bool operator==(const Connection&) const = default;
  };
  [[nodiscard]] const Connection& connection(int number) const {
    return connections_[static_cast<std::size_t>(number)];
  }
  [[nodiscard]] int front_count() const { return front_count_; }
  [[nodiscard]] const Front& front(int number) const { return fronts_[static_cast<std::size_t>(number)]; }
  [[nodiscard]] int front_of(int rank) const { return front_of_[static_cast<std::size_t>(rank)]; }
  /// Ranks, ascending within a front.
  [[nodiscard]] const int* rows(const Front& front) const { return rows_.get() + front.row_begin; }
  [[nodiscard]] const Update* updates() const { return updates_.begin(); }
  /// Place of a later rank among the rows of a front.
  [[nodiscard]] int row_place(const Front& front, int rank) const;

 private:
  struct Link {
    int node, next;
  };
  using Index = std::vector<int>;

  bool order_by_degree();
  bool add_link(int from, int to);
  bool eliminate(int node, int rank);
  void put_in_bucket(int node, int degree);
  void take_from_bucket(int node);
  int take_least();
  void order_by_tree();
  bool make_fronts();
  bool list_updates();

  std::size_t max_fill_;
  int count_ = 0;
  std::vector<Connection> connections_, last_connections_;
  int last_count_ = -1;  ///< of the pattern analyzed last; -1: none
  // Elimination graph: lists of neighbours, those already eliminated are dropped on the way.
  std::vector<Link> links_;
  Index first_link_, degree_, mark_, bucket_, next_in_bucket_, last_in_bucket_;
  int stamp_ = 0, least_degree_ = 0;
  std::size_t fill_ = 0;
  std::vector<std::size_t> column_;  ///< of each place in the order of degree: first entry of fill_row_, and the end
  std::unique_ptr<int[]> fill_row_;  ///< bodies; memory that becomes real where it is written to, as that of rows_
  Index rank_, body_;
  Index by_degree_;  ///< bodies in the order of degree
  Index parent_, first_child_, next_child_, heaviest_, fill_of_;

  std::vector<Front> fronts_;
  int front_count_ = 0;
  Index front_of_;
  std::unique_ptr<int[]> rows_;
  BoundedVector<Update> updates_;
};

}  // namespace snug::physics::internal
