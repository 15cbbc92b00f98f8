// RowGroups: measures the rows of an island, joins bodies that bear on each other, sorts rows by group.
#include "snug/physics/internal/row_groups.hpp"

#include <algorithm>

#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_newton.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kNone = -1, kUnsolved = -2, kSolved = -3;  // of a root; kNone: nothing bears on it
constexpr int kSeveral = -2;                             // groups beside a body: none watches it
/// m/s, by which an idle contact opens at least. Those that hardly open are about to close.
constexpr double kIdleSpeed = 1e-2;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RowGroups::RowGroups(std::size_t bodies, std::size_t rows)
    : state_(new State[rows]),
      between_(new Bodies[rows]),
      miss_(new double[rows]),
      parent_(bodies),
      group_(bodies),
      beside_(bodies),
      seen_in_(bodies),
      order_(new int[rows]) {
  bodies_.reserve(bodies);
  groups_.reserve(bodies);
  runs_.reserve(rows);
}

int RowGroups::root_of(int body) {
  while (parent_[at(body)] != body) {
    int& up = parent_[at(body)];
    body = up = parent_[at(up)];
  }
  return body;
}

/// And the bodies of the island, in the order of their first row.
void RowGroups::list_runs() {
  ++search_;
  bodies_.clear(), runs_.clear();
  for (std::size_t i = 0; i < row_count_; ++i) {
    const std::size_t bearing = state_[i] == State::Bears ? 1 : 0;
    if (!runs_.empty() && runs_.back().bodies == between_[i]) {
      runs_.back().end = i + 1;
      runs_.back().bearing += bearing;
      continue;
    }
    runs_.push_back({between_[i], i, i + 1, bearing});
    for (const int body : {between_[i].a, between_[i].b}) {
      if (body < 0 || seen_in_[at(body)] == search_) continue;
      seen_in_[at(body)] = search_;
      parent_[at(body)] = body, group_[at(body)] = kNone;
      bodies_.push_back(body);
    }
  }
}

void RowGroups::join_bodies(double residual) {
  for (const Run& run : runs_) {
    if (run.bearing == 0) continue;
    const auto [a, b] = run.bodies;
    int root = root_of(std::max(a, b));
    if (a >= 0 && b >= 0) {
      const int other = root_of(std::min(a, b));
      if (group_[at(other)] == kUnsolved || group_[at(root)] == kUnsolved) {
        group_[at(other)] = group_[at(root)] = kUnsolved;
      }
      parent_[at(std::max(root, other))] = std::min(root, other);
      root = std::min(root, other);
    }
    const double miss = *std::max_element(miss_.get() + run.first, miss_.get() + run.end);
    if (miss > residual) group_[at(root)] = kUnsolved;
    if (group_[at(root)] == kNone) group_[at(root)] = kSolved;
  }
}

/// Returns the largest miss.
double RowGroups::measure(const double* u, WorkerPool* pool) {
  return largest_of_ranges(pool, row_count_, [&](std::size_t begin, std::size_t end) {
    double worst = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const Row& row = first_[i];
      between_[i] = {row.ia, row.ib};
      const bool is_open = stays_open(row, u);
      state_[i] = is_open && relative_velocity(row, 0, u) >= row.target + kIdleSpeed ? State::Idle : State::Bears;
      miss_[i] = 0.0;
      if (is_open) continue;
      double xi[3];
      contact_velocity(row, u, xi);
      miss_[i] = natural_map(row, xi, row.lambda);
      worst = std::max(worst, miss_[i]);
    }
    return worst;
  });
}

double RowGroups::find(Row* first, Row* end, const double* u, double residual, WorkerPool* pool) {
  first_ = first;
  row_count_ = static_cast<std::size_t>(end - first);
  const double worst = measure(u, pool);
  if (!(worst > residual)) return worst;
  list_runs();
  join_bodies(residual);
  number_groups();
  return worst;
}

int RowGroups::group_of(const Bodies& bodies) const {
  const int a = bodies.a >= 0 ? group_[at(bodies.a)] : kNone;
  const int b = bodies.b >= 0 ? group_[at(bodies.b)] : kNone;
  if (bodies.a < 0) return b;
  return bodies.b < 0 || a == b ? a : kNone;  // between two groups: of none
}

/// The large group that watches an idle contact between one of its bodies and one on which nothing bears, or kNone.
int RowGroups::watched_by(const Bodies& bodies) const {
  if (bodies.a < 0 || bodies.b < 0) return kNone;
  const int a = group_[at(bodies.a)], b = group_[at(bodies.b)];
  const int group = std::max(a, b);
  return group >= 0 && std::min(a, b) == kNone && groups_[at(group)].rows >= kSharedGroup ? group : kNone;
}

/// Of bodies with a contact that a group watches: the one on which nothing bears.
int RowGroups::free_body(const Bodies& bodies) const { return group_[at(bodies.a)] == kNone ? bodies.a : bodies.b; }

/// Of each body on which nothing bears the large group beside it, since groups share no body.
void RowGroups::find_groups_beside() {
  for (const int body : bodies_) beside_[at(body)] = kNone;
  for (const Run& run : runs_) {
    const int group = watched_by(run.bodies);
    if (group < 0) continue;
    int& beside = beside_[at(free_body(run.bodies))];
    beside = beside == kNone || beside == group ? group : kSeveral;
  }
}

/// Groups in the order of their first rows, and the rows of each.
void RowGroups::number_groups() {
  groups_.clear();
  for (const Run& run : runs_) {
    if (run.bearing == 0) continue;
    int& group = group_[at(root_of(std::max(run.bodies.a, run.bodies.b)))];
    if (group == kUnsolved) group = static_cast<int>(groups_.size()), groups_.push_back({});
  }
  for (const int body : bodies_) {
    if (parent_[at(body)] != body) group_[at(body)] = group_[at(root_of(body))];
  }
  sort_rows();
}

void RowGroups::sort_rows() {
  for (const Run& run : runs_) {
    const int group = group_of(run.bodies);
    if (group >= 0) groups_[at(group)].rows += run.bearing;
  }
  find_groups_beside();
  for (Run& run : runs_) {
    run.group = group_of(run.bodies);
    if (run.group < 0 && watched_by(run.bodies) >= 0) run.group = beside_[at(free_body(run.bodies))];
    if (run.group >= 0) groups_[at(run.group)].idle += run.end - run.first - run.bearing;
  }
  std::size_t begin = 0;
  for (Group& group : groups_) {
    group.next = begin;
    group.next_idle = begin + group.rows;
    group.end = begin = group.next_idle + group.idle;
  }
  for (const Run& run : runs_) {
    if (run.group < 0) continue;
    Group& group = groups_[at(run.group)];
    for (std::size_t i = run.first; i < run.end; ++i) {
      order_[state_[i] == State::Bears ? group.next++ : group.next_idle++] = static_cast<int>(i);
    }
  }
}

OpenGroup::OpenGroup(std::size_t rows) : copies_(new Row[rows]), source_(new int[rows]), idle_(new IdleRow[rows]) {}

/// `rows`: of the island.
void OpenGroup::list_idle(const int* rows, std::size_t count, WorkerPool* pool) {
  idle_count_ = count;
  for_ranges(pool, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Row& row = first_[rows[i]];
      idle_[i] = {row.target - row.bias[0], row.ia, row.ib, rows[i], false};
    }
  });
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
  list_idle(order + open.rows, open.idle, pool);
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
