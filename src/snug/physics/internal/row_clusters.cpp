// RowClusters: marks bodies ring by ring, groups them by union-find, copies their rows.
#include "snug/physics/internal/row_clusters.hpp"

#include <algorithm>
#include <utility>

#include "snug/physics/internal/contact_newton.hpp"

namespace snug::physics::internal {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RowClusters::RowClusters(std::size_t bodies, std::size_t rows)
    : ring_(bodies, -1), parent_(bodies), cluster_(bodies), copies_(new Row[rows]), source_(new int[rows]) {
  ends_.reserve(bodies);
}

std::span<Row> RowClusters::operator[](std::size_t cluster) {
  const std::size_t begin = cluster > 0 ? ends_[cluster - 1] : 0;
  return {copies_.get() + begin, ends_[cluster] - begin};
}

void RowClusters::put_back(Row* rows) const {
  for (std::size_t i = 0; i < ends_.back(); ++i) std::copy_n(copies_[i].lambda, 3, rows[source_[i]].lambda);
}

bool RowClusters::has_body(int body) const { return body < 0 || ring_[at(body)] >= 0; }

int RowClusters::root_of(int body) {
  while (parent_[at(body)] != body) {
    int& up = parent_[at(body)];
    body = up = parent_[at(up)];
  }
  return body;
}

void RowClusters::mark_unsolved(const Row* rows, const NewtonRow* newton, std::span<const NewtonPatch> patches,
                                double residual) {
  for (const NewtonPatch& patch : patches) {
    for (const int body : {rows[patch.first].ia, rows[patch.first].ib}) {
      if (body >= 0) ring_[at(body)] = -1, parent_[at(body)] = body, cluster_[at(body)] = -1;
    }
  }
  for (const NewtonPatch& patch : patches) {
    const NewtonRow* first = newton + patch.first;
    if (std::none_of(first, first + patch.count, [&](const NewtonRow& row) { return row.residual > residual; }))
      continue;
    for (const int body : {rows[patch.first].ia, rows[patch.first].ib}) {
      if (body >= 0) ring_[at(body)] = 0;
    }
  }
}

void RowClusters::add_ring(const Row* rows, std::span<const NewtonPatch> patches, int ring) {
  for (const NewtonPatch& patch : patches) {
    const int a = rows[patch.first].ia, b = rows[patch.first].ib;
    if (a < 0 || b < 0) continue;
    if (ring_[at(a)] == ring - 1 && ring_[at(b)] < 0) ring_[at(b)] = ring;
    if (ring_[at(b)] == ring - 1 && ring_[at(a)] < 0) ring_[at(a)] = ring;
  }
}

/// Bodies that share a row of a cluster get one root. Returns the number of such rows.
std::size_t RowClusters::join(const Row* rows, std::span<const NewtonPatch> patches) {
  std::size_t count = 0;
  for (const NewtonPatch& patch : patches) {
    const Row& row = rows[patch.first];
    if (!has_row(row)) continue;
    count += at(patch.count);
    if (row.ia < 0 || row.ib < 0) continue;
    const int a = root_of(row.ia), b = root_of(row.ib);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }
  return count;
}

void RowClusters::copy_rows(const Row* rows, std::span<const NewtonPatch> patches) {
  const auto root_of_row = [&](const Row& row) { return at(root_of(std::max(row.ia, row.ib))); };
  ends_.clear();
  for (const NewtonPatch& patch : patches) {  // counts first
    const Row& row = rows[patch.first];
    if (!has_row(row)) continue;
    int& cluster = cluster_[root_of_row(row)];
    if (cluster < 0) cluster = static_cast<int>(ends_.size()), ends_.push_back(0);
    ends_[at(cluster)] += at(patch.count);
  }
  std::size_t begin = 0;
  for (std::size_t& end : ends_) begin += std::exchange(end, begin);
  for (const NewtonPatch& patch : patches) {
    if (!has_row(rows[patch.first])) continue;
    std::size_t& end = ends_[at(cluster_[root_of_row(rows[patch.first])])];
    for (int i = patch.first; i < patch.first + patch.count; ++i, ++end) copies_[end] = rows[i], source_[end] = i;
  }
}

bool RowClusters::find(const Row* rows, const NewtonRow* newton, std::span<const NewtonPatch> patches, double residual,
                       int rings) {
  mark_unsolved(rows, newton, patches, residual);
  for (int ring = 1; ring <= rings; ++ring) add_ring(rows, patches, ring);
  const NewtonPatch& last = patches.back();
  if (2 * join(rows, patches) > at(last.first + last.count)) return false;
  copy_rows(rows, patches);
  return true;
}

}  // namespace snug::physics::internal
