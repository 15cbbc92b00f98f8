// RowClusters: marks bodies ring by ring, groups them by union-find, copies their rows.
#include "snug/physics/internal/row_clusters.hpp"

#include <algorithm>
#include <utility>

#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RowClusters::RowClusters(std::size_t bodies, std::size_t rows)
    : bearings_(new Bearing[rows]),
      ring_(bodies, -1),
      parent_(bodies),
      cluster_(bodies),
      copies_(new Row[rows]),
      source_(new int[rows]) {
  ends_.reserve(bodies);
  bearing_.reserve(rows);
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

/// Patches that bear or are unsolved; the bodies of the unsolved make ring 0.
void RowClusters::mark_unsolved(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches,
                                double residual, WorkerPool* pool) {
  for_ranges(pool, patches.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) bearings_[i] = bearing_of(patches[i], rows, newton, residual);
  });
  for (const RowPatch& patch : patches) {
    for (const int body : {patch.ia, patch.ib}) {
      if (body >= 0) ring_[at(body)] = -1, parent_[at(body)] = body, cluster_[at(body)] = -1;
    }
  }
  bearing_.clear();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (bearings_[i] == Bearing::None) continue;
    bearing_.push_back(&patches[i]);
    if (bearings_[i] == Bearing::Solved) continue;
    for (const int body : {patches[i].ia, patches[i].ib}) {
      if (body >= 0) ring_[at(body)] = 0;
    }
  }
}

void RowClusters::add_ring(int ring) {
  for (const RowPatch* patch : bearing_) {
    const int a = patch->ia, b = patch->ib;
    if (a < 0 || b < 0) continue;
    if (ring_[at(a)] == ring - 1 && ring_[at(b)] < 0) ring_[at(b)] = ring;
    if (ring_[at(b)] == ring - 1 && ring_[at(a)] < 0) ring_[at(a)] = ring;
  }
}

/// Patches between bodies of rings stay; such bodies get one root. Returns the number of their rows.
std::size_t RowClusters::join() {
  const auto has_body = [&](int body) { return body < 0 || ring_[at(body)] >= 0; };
  std::erase_if(bearing_, [&](const RowPatch* patch) { return !has_body(patch->ia) || !has_body(patch->ib); });
  std::size_t count = 0;
  for (const RowPatch* patch : bearing_) {
    count += at(patch->count);
    if (patch->ia < 0 || patch->ib < 0) continue;
    const int a = root_of(patch->ia), b = root_of(patch->ib);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }
  return count;
}

int& RowClusters::cluster_of(const RowPatch& patch) { return cluster_[at(root_of(std::max(patch.ia, patch.ib)))]; }

/// Of each cluster, in ends_.
void RowClusters::count_rows() {
  ends_.clear();
  for (const RowPatch* patch : bearing_) {
    int& cluster = cluster_of(*patch);
    if (cluster < 0) cluster = static_cast<int>(ends_.size()), ends_.push_back(0);
    ends_[at(cluster)] += at(patch->count);
  }
}

/// Turns the counts in ends_ into ends.
void RowClusters::copy_rows(const Row* rows, WorkerPool* pool) {
  std::size_t begin = 0;
  for (std::size_t& end : ends_) begin += std::exchange(end, begin);
  for (const RowPatch* patch : bearing_) {
    std::size_t& end = ends_[at(cluster_of(*patch))];
    for (int i = patch->first; i < patch->first + patch->count; ++i, ++end) source_[end] = i;
  }
  if (ends_.empty()) return;
  for_ranges(pool, ends_.back(), [&](std::size_t first, std::size_t past) {
    for (std::size_t i = first; i < past; ++i) copies_[i] = rows[source_[i]];
  });
}

bool RowClusters::find(const Row* rows, const NewtonRow* newton, std::span<const RowPatch> patches, double residual,
                       int rings, const Limits& most, WorkerPool* pool) {
  mark_unsolved(rows, newton, patches, residual, pool);
  for (int ring = 1; ring <= rings; ++ring) add_ring(ring);
  const RowPatch& last = patches.back();
  if (static_cast<double>(join()) > most.all * (last.first + last.count)) return false;
  count_rows();
  if (std::any_of(ends_.begin(), ends_.end(), [&](std::size_t count) { return count > most.each; })) return false;
  copy_rows(rows, pool);
  return true;
}

}  // namespace snug::physics::internal
