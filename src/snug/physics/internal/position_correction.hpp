// PositionCorrection: displacements that close the position errors of rigid contacts with the least kinetic measure.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "snug/core/worker_pool.hpp"
#include "snug/physics/internal/body_halves.hpp"
#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/world.hpp"

namespace snug::physics::internal {

struct Contact;

/// docs/theory/contact.md, section 5. Gauss-Seidel over the normals of an island; from sweep to sweep only those are
/// visited of which a body has moved: mostly a small part. Islands of kSharedGroup rows or more go in halves, by any
/// number of threads. Never allocates after construction.
class PositionCorrection {
 public:
  /// `room`: memory for as many rows, with nothing in it that is needed while run() works.
  PositionCorrection(std::size_t bodies, std::size_t rows, std::shared_ptr<Row[]> room);

  /// Adds to `shift`, 6 numbers per active body in whitened coordinates, zero at first. `centres`: of each active body,
  /// m, W. `is_infeasible`: the overlaps cannot all be mended, and more than the first sweeps only push them to and
  /// fro. `pool`: threads to use, or nullptr.
  void run(const StepSettings& settings, const Row* first, const Row* end, const Contact* contacts, const double* u,
           const Vector3* centres, bool is_infeasible, double* shift, WorkerPool* pool) noexcept;

 private:
  /// The normal axis of a contact.
  struct alignas(16) Normal {
    double a[6], b[6];  ///< zero of a body that does not move
    double W;
    double wanted;  ///< m, displacement
    double lambda;  ///< of the displacement, in units of impulses
    int ia, ib;     ///< active bodies, or -1
    bool is_rigid;  ///< else none of the above counts
    bool is_bounce;
  };
  /// Normals behind each other with the same bodies.
  struct Run {
    int a, b;  ///< active bodies, or -1
    int first, end;
    bool is_wanted;  ///< one of them has an error to mend
  };
  /// Runs that are swept on one thread.
  struct Part {
    int first = 0, end = 0;
  };
  struct Sweep {
    int number;  ///< from 1 on
    bool is_bounce_pulled;
    double relaxation;  ///< of the step to each normal's wanted displacement
    double least;       ///< m, of a change after which the neighbours are visited again
  };

  /// Returns the displacement wanted, m.
  static double find_error(const StepSettings& settings, const Row& row, const Contact* contacts, const double* u,
                           Normal& normal);
  void list_runs(std::size_t normals);
  void divide(bool is_cut, const Vector3* centres);
  [[nodiscard]] bool is_to_visit(const Run& run, int sweep) const;
  /// Returns the largest change, m.
  double sweep(const Sweep& sweep, double* shift, WorkerPool* pool);
  double sweep(const Part& part, const Sweep& sweep, double* shift);
  double visit(const Run& run, const Sweep& sweep, double* shift);

  static_assert(sizeof(Normal) <= sizeof(Row) && alignof(Normal) <= alignof(Row));

  std::shared_ptr<Row[]> room_;
  Normal* normals_;            ///< in room_
  std::vector<Run> runs_;      ///< by part
  std::vector<Run> sorted_;    ///< while they are sorted
  std::vector<int> visited_;   ///< runs of each part, where these begin
  std::vector<int> moved_in_;  ///< of each active body: number of the last sweep that moved it
  std::vector<int> bodies_;    ///< of the island
  BodyHalves halves_;
  std::array<Part, 3> parts_;  ///< two halves, of which the second may be empty; the seam
};

}  // namespace snug::physics::internal
