// RowClusters: takes bodies ring by ring, groups them by union-find, copies their rows.
#include "snug/physics/internal/row_clusters.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kMostRings = 6;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RowClusters::RowClusters(std::size_t bodies, std::size_t rows)
    : bearings_(new Bearing[rows]),
      rings_(bodies),
      reach_(bodies, -1),
      parent_(bodies),
      cluster_(bodies),
      copies_(new Row[rows]),
      source_(new int[rows]) {
  ends_.reserve(bodies);
  most_rings_.reserve(bodies);
  unsolved_.reserve(bodies);
  bearing_.reserve(rows);
  taken_.reserve(rows);
}

std::span<Row> RowClusters::operator[](std::size_t cluster) {
  const std::size_t begin = cluster > 0 ? ends_[cluster - 1] : 0;
  return {copies_.get() + begin, ends_[cluster] - begin};
}

void RowClusters::put_back(Row* rows) const {
  for (std::size_t i = 0; i < ends_.back(); ++i) std::copy_n(copies_[i].lambda, 3, rows[source_[i]].lambda);
}

int RowClusters::root_of(int body) {
  while (parent_[at(body)] != body) {
    int& up = parent_[at(body)];
    body = up = parent_[at(up)];
  }
  return body;
}

RowClusters::Bearing RowClusters::bearing_of(const RowPatch& patch, const Row* rows, const NewtonRow* newton,
                                             double residual) {
  Bearing bearing = Bearing::None;
  for (int i = patch.first; i < patch.first + patch.count; ++i) {
    if (newton[i].residual > residual) return Bearing::Unsolved;
    if (rows[i].lambda[0] > 0.0 || newton[i].residual > 0.0) bearing = Bearing::Solved;
  }
  return bearing;
}

/// And the patches that bear or are unsolved.
void RowClusters::find_unsolved(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches,
                                double residual, WorkerPool* pool) {
  for_ranges(pool, patches.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) bearings_[i] = bearing_of(patches[i], rows, newton, residual);
  });
  bearing_.clear();
  unsolved_.clear();
  for (const RowPatch& patch : patches) {
    for (const int body : {patch.ia, patch.ib}) {
      if (body >= 0) reach_[at(body)] = -1;
    }
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (bearings_[i] == Bearing::None) continue;
    bearing_.push_back(&patches[i]);
    if (bearings_[i] == Bearing::Solved) continue;
    for (const int body : {patches[i].ia, patches[i].ib}) {
      if (body >= 0 && std::exchange(reach_[at(body)], 0) != 0) unsolved_.push_back(body);
    }
  }
}

/// Around each unsolved body as many as it has.
void RowClusters::add_rings() {
  for (const RowPatch* patch : bearing_) {
    for (const int body : {patch->ia, patch->ib}) {
      if (body >= 0) reach_[at(body)] = -1, parent_[at(body)] = body, cluster_[at(body)] = -1;
    }
  }
  int reach = 0;
  for (const int body : unsolved_) {
    reach_[at(body)] = rings_[at(body)];
    reach = std::max(reach, rings_[at(body)]);
  }
  for (; reach > 0; --reach) {
    for (const RowPatch* patch : bearing_) {
      if (patch->ia < 0 || patch->ib < 0) continue;
      int &a = reach_[at(patch->ia)], &b = reach_[at(patch->ib)];
      if (a == reach) b = std::max(b, reach - 1);
      if (b == reach) a = std::max(a, reach - 1);
    }
  }
}

/// Takes the patches between bodies of rings; such bodies get one root.
void RowClusters::join() {
  const auto has_body = [&](int body) { return body < 0 || reach_[at(body)] >= 0; };
  taken_.clear();
  for (const RowPatch* patch : bearing_) {
    if (!has_body(patch->ia) || !has_body(patch->ib)) continue;
    taken_.push_back(patch);
    if (patch->ia < 0 || patch->ib < 0) continue;
    const int a = root_of(patch->ia), b = root_of(patch->ib);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }
}

int& RowClusters::cluster_of(const RowPatch& patch) { return cluster_[at(root_of(std::max(patch.ia, patch.ib)))]; }

/// Rings around the unsolved, joined to clusters; how many rows each has is in ends_.
void RowClusters::take_bodies() {
  add_rings();
  join();
  count_rows();
}

/// Of each cluster, in ends_.
void RowClusters::count_rows() {
  ends_.clear();
  for (const RowPatch* patch : taken_) {
    int& cluster = cluster_of(*patch);
    if (cluster < 0) cluster = static_cast<int>(ends_.size()), ends_.push_back(0);
    ends_[at(cluster)] += at(patch->count);
  }
}

/// Turns the counts in ends_ into ends.
void RowClusters::copy_rows(const Row* rows, WorkerPool* pool) {
  std::size_t begin = 0;
  for (std::size_t& end : ends_) begin += std::exchange(end, begin);
  for (const RowPatch* patch : taken_) {
    std::size_t& end = ends_[at(cluster_of(*patch))];
    for (int i = patch->first; i < patch->first + patch->count; ++i, ++end) source_[end] = i;
  }
  if (ends_.empty()) return;
  for_ranges(pool, ends_.back(), [&](std::size_t first, std::size_t past) {
    for (std::size_t i = first; i < past; ++i) copies_[i] = rows[source_[i]];
  });
}

/// From the unsolved bodies of clusters with more rows. False: none of them has any.
bool RowClusters::take_ring(std::size_t most) {
  bool has_taken = false;
  for (const int body : unsolved_) {
    int& rings = rings_[at(body)];
    if (rings == 0 || ends_[at(cluster_[at(root_of(body))])] <= most) continue;
    --rings;
    has_taken = true;
  }
  return has_taken;
}

/// Each body of a cluster gets the most rings of one in it.
void RowClusters::share_rings() {
  most_rings_.assign(ends_.size(), 0);
  for (const int body : unsolved_) {
    int& most = most_rings_[at(cluster_[at(root_of(body))])];
    most = std::max(most, rings_[at(body)]);
  }
  for (const RowPatch* patch : taken_) {
    for (const int body : {patch->ia, patch->ib}) {
      if (body >= 0) rings_[at(body)] = std::max(rings_[at(body)], most_rings_[at(cluster_of(*patch))]);
    }
  }
}

bool RowClusters::find(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches, double residual,
                       int rings, std::size_t most, WorkerPool* pool) {
  find_unsolved(rows, newton, patches, residual, pool);
  for (const int body : unsolved_) rings_[at(body)] = rings;
  take_bodies();
  if (std::accumulate(ends_.begin(), ends_.end(), std::size_t{0}) > most) return false;
  copy_rows(rows, pool);
  return true;
}

void RowClusters::forget() { std::fill(rings_.begin(), rings_.end(), 0); }

bool RowClusters::find_growing(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches,
                               double residual, const Limits& most, WorkerPool* pool) {
  find_unsolved(rows, newton, patches, residual, pool);
  for (const int body : unsolved_) rings_[at(body)] = std::min(rings_[at(body)] + 1, kMostRings);
  for (;;) {
    take_bodies();
    const bool are_many = std::accumulate(ends_.begin(), ends_.end(), std::size_t{0}) > most.all;
    const bool is_one_large =
        std::any_of(ends_.begin(), ends_.end(), [&](std::size_t count) { return count > most.each; });
    if (!are_many && !is_one_large) break;
    if (!take_ring(are_many ? 0 : most.each)) return false;
  }
  share_rings();
  copy_rows(rows, pool);
  return true;
}

}  // namespace snug::physics::internal
