// BlockPattern: minimum degree, elimination tree, fronts.
#include "snug/physics/internal/block_pattern.hpp"

#include <algorithm>

namespace snug::physics::internal {
namespace {

constexpr std::size_t kFillPerBody = 64;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::size_t max_fill(std::size_t bodies) {
  return std::min(bodies * (bodies - std::min<std::size_t>(bodies, 1)) / 2, kFillPerBody * bodies);
}

}  // namespace

/// Of all panels: the fill, the diagonal and what fronts share without need.
std::size_t BlockPattern::max_blocks(std::size_t bodies) {
  return std::min(bodies * bodies, (2 * kFillPerBody + 1) * bodies);
}

BlockPattern::BlockPattern(std::size_t bodies, std::size_t connections)
    : max_fill_(max_fill(bodies)),
      column_(bodies + 1),
      fill_row_(new int[max_fill_]),
      fronts_(bodies),
      rows_(new int[max_fill_]),
      updates_(max_fill_) {
  connections_.reserve(connections);
  last_connections_.reserve(connections);
  links_.reserve(2 * (max_fill_ + std::min(connections, max_fill_)));
  for (Index* index : {&first_link_, &degree_, &mark_, &next_in_bucket_, &last_in_bucket_, &rank_, &body_, &by_degree_,
                       &parent_, &first_child_, &next_child_, &heaviest_, &fill_of_, &front_of_}) {
    index->resize(bodies);
  }
  bucket_.resize(bodies + 1);
}

void BlockPattern::begin(int count) {
  count_ = count;
  connections_.clear();
}

int BlockPattern::connect(int i, int j) {
  connections_.push_back({i, j});
  return static_cast<int>(connections_.size()) - 1;
}

bool BlockPattern::analyze() {
  if (count_ == last_count_ && connections_ == last_connections_) return true;
  last_count_ = -1;
  if (!order_by_degree()) return false;
  order_by_tree();
  if (!make_fronts() || !list_updates()) return false;
  last_count_ = count_;
  last_connections_ = connections_;
  return true;
}

bool BlockPattern::add_link(int from, int to) {
  if (links_.size() == links_.capacity()) return false;
  links_.push_back({to, first_link_[at(from)]});
  first_link_[at(from)] = static_cast<int>(links_.size()) - 1;
  ++degree_[at(from)];
  return true;
}

void BlockPattern::put_in_bucket(int node, int degree) {
  int& head = bucket_[at(degree)];
  next_in_bucket_[at(node)] = head;
  last_in_bucket_[at(node)] = -1;
  if (head >= 0) last_in_bucket_[at(head)] = node;
  head = node;
  least_degree_ = std::min(least_degree_, degree);
}

void BlockPattern::take_from_bucket(int node) {
  const int next = next_in_bucket_[at(node)], last = last_in_bucket_[at(node)];
  if (next >= 0) last_in_bucket_[at(next)] = last;
  (last >= 0 ? next_in_bucket_[at(last)] : bucket_[at(degree_[at(node)])]) = next;
}

int BlockPattern::take_least() {
  while (bucket_[at(least_degree_)] < 0) ++least_degree_;
  const int node = bucket_[at(least_degree_)];
  take_from_bucket(node);
  return node;
}

/// Makes the neighbours of `node` a clique and writes them down.
bool BlockPattern::eliminate(int node, int place) {
  by_degree_[at(place)] = node;
  rank_[at(node)] = place;
  const std::size_t first = fill_;
  for (int link = first_link_[at(node)]; link >= 0; link = links_[at(link)].next) {
    const int other = links_[at(link)].node;
    if (degree_[at(other)] < 0) continue;  // eliminated
    if (fill_ == max_fill_) return false;
    fill_row_[fill_++] = other;
  }
  column_[at(place) + 1] = fill_;
  degree_[at(node)] = -1;
  for (std::size_t e = first; e < fill_; ++e) {
    const int i = fill_row_[e];
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
      if (mark_[at(fill_row_[f])] != stamp_ && !add_link(i, fill_row_[f])) return false;
    }
    put_in_bucket(i, degree_[at(i)]);
  }
  return true;
}

bool BlockPattern::order_by_degree() {
  links_.clear();
  std::fill_n(first_link_.begin(), count_, -1);
  std::fill_n(degree_.begin(), count_, 0);
  std::fill_n(mark_.begin(), count_, -1);
  stamp_ = 0;
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
  for (int place = 0; place < count_; ++place) {
    if (!eliminate(take_least(), place)) return false;
  }
  return true;
}

/// The parent of a body is the first one that its elimination touches. Children before parents, each subtree at one
/// stretch, the child with most fill next to its parent.
void BlockPattern::order_by_tree() {
  const auto fill_of = [&](int place) { return static_cast<int>(column_[at(place) + 1] - column_[at(place)]); };
  for (Index* index : {&first_child_, &next_child_, &heaviest_}) std::fill_n(index->begin(), count_, -1);
  for (int place = 0; place < count_; ++place) {
    int parent = count_;
    for (std::size_t e = column_[at(place)]; e < column_[at(place) + 1]; ++e) {
      parent = std::min(parent, rank_[at(fill_row_[e])]);
    }
    parent_[at(place)] = parent < count_ ? parent : -1;
    if (parent == count_) continue;
    int& heaviest = heaviest_[at(parent)];
    if (heaviest < 0 || fill_of(place) >= fill_of(heaviest)) heaviest = place;
  }
  for (int place = count_ - 1; place >= 0; --place) {
    const int parent = parent_[at(place)];
    if (parent < 0 || heaviest_[at(parent)] == place) continue;
    next_child_[at(place)] = first_child_[at(parent)];
    first_child_[at(parent)] = place;
  }
  for (int place = 0; place < count_; ++place) {  // the heaviest comes last
    if (heaviest_[at(place)] < 0) continue;
    int* link = &first_child_[at(place)];
    while (*link >= 0) link = &next_child_[at(*link)];
    *link = heaviest_[at(place)];
  }
  int rank = 0;
  for (int root = 0; root < count_; ++root) {
    if (parent_[at(root)] >= 0) continue;
    for (int place = root;;) {
      while (first_child_[at(place)] >= 0) place = first_child_[at(place)];
      // All children are done: number it, go on with its sibling or its parent.
      body_[at(rank)] = by_degree_[at(place)];
      fill_of_[at(rank)] = place;
      ++rank;
      if (place == root) break;
      const int parent = parent_[at(place)], sibling = next_child_[at(place)];
      if (sibling >= 0) {
        place = sibling;
      } else {
        first_child_[at(parent)] = -1;
        place = parent;
      }
    }
  }
  for (int r = 0; r < count_; ++r) rank_[at(body_[at(r)])] = r;
}

/// A body joins the front before it when it is the parent of that one's last and fills little more than it. Zeros in
/// the panels cost work, narrow fronts cost more.
bool BlockPattern::make_fronts() {
  constexpr int kMaxWidth = 12;
  constexpr double kZeros = 0.15;  ///< of a panel
  const auto fill_of = [&](int rank) {
    const std::size_t place = at(fill_of_[at(rank)]);
    return static_cast<int>(column_[place + 1] - column_[place]);
  };
  front_count_ = 0;
  double zeros = 0.0;
  for (int rank = 0; rank < count_; ++rank) {
    if (rank > 0) {
      Front& last = fronts_[at(front_count_ - 1)];
      const int parent = parent_[at(fill_of_[at(rank - 1)])];
      const int more = fill_of(rank) + 1 - fill_of(rank - 1);
      const double with = zeros + last.width * more;
      const double size = (last.width + 1) * (fill_of(rank) + 0.5 * (last.width + 2));
      if (parent == fill_of_[at(rank)] && last.width < kMaxWidth && (more == 0 || with <= kZeros * size)) {
        ++last.width;
        zeros = with;
        front_of_[at(rank)] = front_count_ - 1;
        continue;
      }
    }
    fronts_[at(front_count_)] = {rank, 1};
    front_of_[at(rank)] = front_count_++;
    zeros = 0.0;
  }
  std::size_t rows = 0, blocks = 0;
  const std::size_t most = max_blocks(first_link_.size());
  for (int f = 0; f < front_count_; ++f) {
    Front& front = fronts_[at(f)];
    const std::size_t place = at(fill_of_[at(front.first + front.width - 1)]);
    front.row_begin = rows;
    for (std::size_t e = column_[place]; e < column_[place + 1]; ++e) rows_[rows++] = rank_[at(fill_row_[e])];
    front.row_end = rows;
    std::sort(rows_.get() + front.row_begin, rows_.get() + rows);
    front.panel = blocks;
    blocks += at(front.width * front.height());
    if (blocks > most) return false;
  }
  return true;
}

bool BlockPattern::list_updates() {
  // Twice over the rows of all fronts: how many updates each front gets, and which.
  std::size_t total = 0;
  const auto each_update = [&](auto&& visit) {
    for (int f = 0; f < front_count_; ++f) {
      const Front& front = fronts_[at(f)];
      const int* row = rows(front);
      for (int begin = 0, end = 0; begin < front.rows(); begin = end) {
        const int target = front_of(row[begin]);
        while (end < front.rows() && front_of(row[end]) == target) ++end;
        visit(fronts_[at(target)], Update{f, begin, end});
      }
    }
  };
  for (int f = 0; f < front_count_; ++f) fronts_[at(f)].update_end = 0;
  each_update([&](Front& target, const Update&) { ++target.update_end, ++total; });
  if (total > updates_.capacity()) return false;
  updates_.resize(total);
  std::size_t begin = 0;
  for (int f = 0; f < front_count_; ++f) {
    Front& front = fronts_[at(f)];
    front.update_begin = begin;
    begin += front.update_end;
    front.update_end = front.update_begin;
  }
  each_update([&](Front& target, const Update& update) { updates_[target.update_end++] = update; });
  return true;
}

int BlockPattern::row_place(const Front& front, int rank) const {
  const int* begin = rows(front);
  return static_cast<int>(std::lower_bound(begin, begin + front.rows(), rank) - begin);
}

}  // namespace snug::physics::internal
