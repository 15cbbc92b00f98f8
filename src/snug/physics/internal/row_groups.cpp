// RowGroups: measures the rows of an island, joins bodies that bear on each other, sorts rows by group.
#include "snug/physics/internal/row_groups.hpp"

#include <algorithm>

#include "snug/physics/internal/chunks.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kNone = -1, kUnsolved = -2;  // of a root
/// m/s, by which an idle contact opens at least. Those that hardly open are about to close.
constexpr double kIdleSpeed = 1e-2;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RowGroups::RowGroups(std::size_t bodies, std::size_t rows)
    : state_(new State[rows]),
      miss_(new double[rows]),
      parent_(bodies),
      group_(bodies),
      seen_in_(bodies),
      order_(new int[rows]) {
  bodies_.reserve(bodies);
  groups_.reserve(bodies);
}

int RowGroups::root_of(int body) {
  while (parent_[at(body)] != body) {
    int& up = parent_[at(body)];
    body = up = parent_[at(up)];
  }
  return body;
}

void RowGroups::begin_bodies(const Row* first, const Row* end) {
  ++search_;
  bodies_.clear();
  for (const Row* row = first; row != end; ++row) {
    for (const int body : {row->ia, row->ib}) {
      if (body < 0 || seen_in_[at(body)] == search_) continue;
      seen_in_[at(body)] = search_;
      parent_[at(body)] = body, group_[at(body)] = kNone;
      bodies_.push_back(body);
    }
  }
}

void RowGroups::measure(const double* u, WorkerPool* pool) {
  for_ranges(pool, row_count_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Row& row = first_[i];
      const bool is_open = stays_open(row, u);
      state_[i] = is_open && relative_velocity(row, 0, u) >= row.target + kIdleSpeed ? State::Idle : State::Bears;
      miss_[i] = 0.0;
      if (is_open) continue;
      double xi[3];
      contact_velocity(row, u, xi);
      miss_[i] = natural_map(row, xi, row.lambda);
    }
  });
}

double RowGroups::find(Row* first, Row* end, const double* u, double residual, WorkerPool* pool) {
  first_ = first;
  row_count_ = static_cast<std::size_t>(end - first);
  begin_bodies(first, end);
  measure(u, pool);
  double worst = 0.0;
  for (std::size_t i = 0; i < row_count_; ++i) {
    if (state_[i] == State::Idle) continue;
    const Row& row = first[i];
    int root = root_of(std::max(row.ia, row.ib));
    if (row.ia >= 0 && row.ib >= 0) {
      const int other = root_of(std::min(row.ia, row.ib));
      if (group_[at(other)] == kUnsolved || group_[at(root)] == kUnsolved) {
        group_[at(other)] = group_[at(root)] = kUnsolved;
      }
      parent_[at(std::max(root, other))] = std::min(root, other);
      root = std::min(root, other);
    }
    worst = std::max(worst, miss_[i]);
    if (miss_[i] > residual) group_[at(root)] = kUnsolved;
  }
  number_groups();
  return worst;
}

int RowGroups::group_of(const Row& row) const {
  const int a = row.ia >= 0 ? group_[at(row.ia)] : kNone;
  const int b = row.ib >= 0 ? group_[at(row.ib)] : kNone;
  if (row.ia < 0) return b;
  return row.ib < 0 || a == b ? a : kNone;  // between two groups: of none
}

/// Groups in the order of their first rows, and the rows of each.
void RowGroups::number_groups() {
  groups_.clear();
  for (std::size_t i = 0; i < row_count_; ++i) {
    if (state_[i] == State::Idle) continue;
    int& group = group_[at(root_of(std::max(first_[i].ia, first_[i].ib)))];
    if (group == kNone) continue;
    if (group == kUnsolved) group = static_cast<int>(groups_.size()), groups_.push_back({});
    ++groups_[at(group)].rows;
  }
  for (const int body : bodies_) {
    if (parent_[at(body)] != body) group_[at(body)] = group_[at(root_of(body))];
  }
  sort_rows();
}

void RowGroups::sort_rows() {
  for (std::size_t i = 0; i < row_count_; ++i) {
    const int group = state_[i] == State::Idle ? group_of(first_[i]) : kNone;
    if (group >= 0) ++groups_[at(group)].idle;
  }
  std::size_t begin = 0;
  for (Group& group : groups_) {
    group.end = begin;  // of its rows so far, until all are there
    begin += group.rows + group.idle;
  }
  for (const State state : {State::Bears, State::Idle}) {
    for (std::size_t i = 0; i < row_count_; ++i) {
      if (state_[i] != state) continue;
      const int group = group_of(first_[i]);
      if (group >= 0) order_[groups_[at(group)].end++] = static_cast<int>(i);
    }
  }
}

OpenGroup::OpenGroup(std::size_t rows) : copies_(new Row[rows]), source_(new int[rows]), idle_(new IdleRow[rows]) {}

void OpenGroup::add_idle(const Row& row, int index) {
  IdleRow& idle = idle_[idle_count_++];
  idle.least = row.target - row.bias[0];
  idle.ia = row.ia;
  idle.ib = row.ib;
  idle.row = index;
}

std::span<Row> OpenGroup::open(const RowGroups& groups, std::size_t group, WorkerPool* pool) {
  const RowGroups::Group& open = groups.groups_[group];
  first_ = groups.first_;
  copy_count_ = idle_count_ = 0;
  if (open.rows == groups.row_count_) {
    for (std::size_t i = 0; i < open.rows; ++i) first_[i].is_changed = true;
    return {first_, open.rows};
  }
  const int* order = groups.order_.get() + open.end - open.idle - open.rows;
  copy_count_ = open.rows;
  for_ranges(pool, copy_count_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      copies_[i] = first_[order[i]];
      source_[i] = order[i];
    }
  });
  for (std::size_t i = open.rows; i < open.rows + open.idle; ++i) add_idle(first_[order[i]], order[i]);
  return {copies_.get(), copy_count_};
}

bool OpenGroup::closes(const IdleRow& idle, const double* u) const {
  const Row& row = first_[idle.row];
  Pair s{};
  if (idle.ia >= 0) s = dot(row.a(0), u + 6 * idle.ia);
  if (idle.ib >= 0) s += dot(row.b(0), u + 6 * idle.ib);
  return !(s[0] + s[1] >= idle.least);
}

std::size_t OpenGroup::wake(const double* u, WorkerPool* pool) {
  for_ranges(pool, idle_count_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) idle_[i].closes = closes(idle_[i], u);
  });
  std::size_t woken = 0;
  for (std::size_t i = 0; i < idle_count_;) {
    const IdleRow& idle = idle_[i];
    if (!idle.closes) {
      ++i;
      continue;
    }
    copies_[copy_count_] = first_[idle.row];
    source_[copy_count_++] = idle.row;
    ++woken;
    idle_[i] = idle_[--idle_count_];
  }
  return woken;
}

void OpenGroup::close() {
  for (std::size_t i = 0; i < copy_count_; ++i) {
    Row& row = first_[source_[i]];
    std::copy_n(copies_[i].lambda, 3, row.lambda);
    row.is_changed = true;
  }
}

}  // namespace snug::physics::internal
