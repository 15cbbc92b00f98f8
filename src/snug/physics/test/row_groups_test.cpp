// Row groups: rows that bear on each other, and the open ones that are watched while they are solved.
#include "snug/physics/internal/row_groups.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <vector>

#include "snug/physics/internal/contact_newton.hpp"

namespace snug::physics::internal {
namespace {

/// Bodies on each other, one contact a pair along one axis; each column on what does not move. No contact is solved.
/// Bodies that nothing bears on stand beside them, open by 1 m/s.
class Columns {
 public:
  explicit Columns(std::span<const int> heights) {
    for (const int height : heights) {
      int below = -1;
      for (int i = 0; i < height; ++i) {
        add(below, bodies_, 1.0);
        below = bodies_++;
      }
      tops_.push_back(below);
    }
    column_rows_ = rows_.size();
  }
  /// A body beside the tops of columns.
  void add_body_beside(std::span<const int> columns) {
    for (const int column : columns) add(tops_[static_cast<std::size_t>(column)], bodies_, -1.0);
    ++bodies_;
  }
  struct Found {
    std::size_t rows = 0;   ///< of the groups
    std::size_t woken = 0;  ///< open rows that close when all that is beside falls onto the columns
  };
  [[nodiscard]] Found find() {
    std::vector<double> u(6 * static_cast<std::size_t>(bodies_));
    RowGroups groups(static_cast<std::size_t>(bodies_), rows_.size());
    EXPECT_GT(groups.find(rows_.data(), rows_.data() + rows_.size(), u.data(), 1e-5, nullptr), 1e-5);
    for (std::size_t i = column_rows_; i < rows_.size(); ++i) u[6 * static_cast<std::size_t>(rows_[i].ib)] = -2.0;
    Found found;
    for (std::size_t i = 0; i < groups.count(); ++i) {
      OpenGroup open(rows_.size());
      found.rows += open.open(groups, i, nullptr).size();
      found.woken += open.wake(u.data(), nullptr);
    }
    return found;
  }

 private:
  /// `target`: of a velocity that is zero.
  void add(int a, int b, double target) {
    Row row{};
    row.ia = a, row.ib = b;
    row.kind = RowKind::Contact;
    row.is_rigid = true;
    row.target = target;
    for (int axis = 0; axis < 3; ++axis) {
      row.j[axis][axis] = -1.0, row.j[axis][6 + axis] = 1.0;
    }
    finish_row(row);
    rows_.push_back(row);
  }

  int bodies_ = 0;
  std::size_t column_rows_ = 0;
  std::vector<int> tops_;
  std::vector<Row> rows_;
};

constexpr int kLarge = static_cast<int>(kSharedGroup), kSmall = 20;

TEST(RowGroups, OfManyRowsWatchWhatMayFallOntoThem) {
  Columns columns(std::vector{kLarge, kSmall});
  columns.add_body_beside(std::vector{0});
  columns.add_body_beside(std::vector{0});
  columns.add_body_beside(std::vector{1});  // small groups watch their own rows alone
  const Columns::Found found = columns.find();
  EXPECT_EQ(found.rows, static_cast<std::size_t>(kLarge + kSmall));
  EXPECT_EQ(found.woken, 2U);
}

TEST(RowGroups, ShareNoBodyThatTheyWatch) {
  Columns columns(std::vector{kLarge, kLarge, kSmall});
  columns.add_body_beside(std::vector{0, 1});
  columns.add_body_beside(std::vector{1, 2});
  EXPECT_EQ(columns.find().woken, 1U) << "the second body, by the second column";
}

}  // namespace
}  // namespace snug::physics::internal
