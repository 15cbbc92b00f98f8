// PackedSweeps: sweeps over the rows of a large group, those of sixteen pairs of bodies side by side.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "snug/core/bounded_vector.hpp"
#include "snug/core/worker_pool.hpp"
#include "snug/physics/internal/body_halves.hpp"
#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/internal/lane_sweep.hpp"

namespace snug::physics::internal {

struct RowPatch;

/// The rows of a group in single precision, in blocks of sixteen patches that share no body: those of two halves whose
/// bodies do not meet, which two threads sweep side by side, then the seam between them. Velocities are changes since
/// the sweeps began, so rounding is small beside what is sought; what comes out is to be measured in double precision.
/// Blocks, their order and the bytes that come out do not depend on the processor, nor on the number of threads. Never
/// allocates after construction.
class PackedSweeps {
 public:
  struct Effort {
    int sweeps = 0;           ///< at most
    double momentum = 0.0;    ///< at most
    double wanted = 0.0;      ///< m/s, residual
    double few = 0.0;         ///< fraction of the rows that may miss `wanted` when sweeps end
    int most_width = kLanes;  ///< lanes of the vectors, where the processor has as many
    int calm = 0;             ///< the last of the sweeps, with little momentum
  };

  PackedSweeps(std::size_t bodies, std::size_t rows);

  /// Takes in the rows of a group; they stay until the next call. `centres`: of each active body, m, W, to go in
  /// halves; nullptr: as one. `pool`: threads to use, or nullptr. False: too many share a body to go side by side.
  [[nodiscard]] bool pack(const Row* rows, std::span<const RowPatch> patches, std::span<const int> bodies,
                          const Vector3* centres = nullptr, WorkerPool* pool = nullptr);
  /// Forward sweeps with Nesterov's momentum from the impulses of the packed rows and their velocities u. Leaves the
  /// impulses in the rows. Returns the number of sweeps.
  int run(Row* rows, const double* u, const Effort& effort, WorkerPool* pool = nullptr);
  /// Adds to u what the last run has changed of the velocities of `bodies`, those that were packed.
  void add_change(std::span<const int> bodies, double* u) const;

 private:
  static constexpr int kHalf = kLanes / 2;
  static constexpr int kNumbers = 8;
  using Numbers = std::array<float, kNumbers>;

  /// Rows of a patch in one lane of one block.
  struct Chunk {
    std::int32_t row = 0, count = 0, block = 0, lane = 0;
    bool has_own_axes = false;  ///< its rows have axes of their own
  };
  /// Patches that share no body, before two such are joined to a block.
  struct HalfBlock {
    std::int32_t a[kHalf] = {}, b[kHalf] = {};  ///< places of the bodies
    std::int32_t count = 0, lanes = 0;
    std::int32_t joined = -1;  ///< twice its block, and 1 in the second half of this
    bool has_own_axes = false;

    [[nodiscard]] bool has(std::int32_t body) const;
    [[nodiscard]] bool is_like(std::int32_t rows, bool own_axes) const;
  };
  /// What is swept on one thread: its blocks, and the places of its bodies.
  struct Part {
    explicit Part(std::size_t rows);

    void clear();
    void add_chunk(Chunk chunk, int a, int b);
    void join_half_blocks();

    BoundedVector<HalfBlock> half_blocks;
    BoundedVector<std::int32_t> open;  ///< half blocks with room for more
    BoundedVector<Chunk> chunks;
    BoundedVector<LaneBlock> blocks;
    std::size_t first_place = 0, end_place = 0;
  };
  [[nodiscard]] BodyHalves::Part part_of(int body) const { return is_cut_ ? halves_.of(body) : BodyHalves::First; }
  [[nodiscard]] BodyHalves::Part part_of(const RowPatch& patch) const;
  void cut(std::span<const RowPatch> patches, std::span<const int> bodies, const Vector3* centres);
  void place_bodies(std::span<const int> bodies);
  void add_patches(BodyHalves::Part part, const Row* rows, std::span<const RowPatch> patches);
  void fill(const Row* rows, WorkerPool* pool);
  void fill_linear(const Row* first, const Chunk& chunk, LaneBlock& block);
  void begin(const Row* rows, const double* u, WorkerPool* pool);
  void take_momentum(const Part& part, float momentum);
  template <class Job>
  void each_part(WorkerPool* pool, const Job& job);
  template <class Visit>
  void each_chunk(WorkerPool* pool, const Visit& visit);
  template <class Visit>
  void each_row(WorkerPool* pool, const Visit& visit);

  BodyHalves halves_;
  bool is_cut_ = false;
  std::array<Part, 3> parts_;              ///< two halves, of which the second may be empty; the seam
  std::vector<std::int32_t> place_;        ///< of each active body, from 1 on
  BoundedVector<Numbers> velocities_;      ///< of each place; the last two numbers are none
  BoundedVector<Numbers> old_velocities_;  ///< before the last sweep
  BoundedVector<LanePoints> points_;
  BoundedVector<LaneLinear> linear_;
  int row_count_ = 0;
};

}  // namespace snug::physics::internal
