// PositionCorrection: displacements that close the position errors of rigid contacts with the least kinetic measure.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/world.hpp"

namespace snug::physics::internal {

struct Contact;

/// docs/theory/contact.md, section 5. Gauss-Seidel over the normals of an island; from sweep to sweep only those are
/// visited of which a body has moved: mostly a small part. Never allocates after construction.
class PositionCorrection {
 public:
  /// `room`: memory for as many rows, with nothing in it that is needed while run() works.
  PositionCorrection(std::size_t bodies, std::size_t rows, std::shared_ptr<Row[]> room);

  /// Adds to `shift`, 6 numbers per active body in whitened coordinates, zero at first. `is_infeasible`: the overlaps
  /// cannot all be mended, and more than the first sweeps only push them to and fro.
  void run(const StepSettings& settings, const Row* first, const Row* end, const Contact* contacts, const double* u,
           bool is_infeasible, double* shift) noexcept;

 private:
  /// The normal axis of a rigid contact.
  struct alignas(16) Normal {
    double a[6], b[6];  ///< zero of a body that does not move
    double W;
    double wanted;  ///< m, displacement
    double lambda;  ///< of the displacement, in units of impulses
    bool is_bounce;
  };
  /// Normals behind each other with the same bodies.
  struct Run {
    int a, b;  ///< active bodies, or -1
    std::size_t first, end;
  };
  struct Sweep {
    bool is_bounce_pulled;
    double relaxation;  ///< of the step to each normal's wanted displacement
    double least;       ///< m, of a change after which the neighbours are visited again
  };

  /// Returns the largest displacement wanted, m.
  double find_errors(const StepSettings& settings, const Row* first, const Row* end, const Contact* contacts,
                     const double* u);
  /// Returns the largest change, m.
  double sweep(const Sweep& sweep, double* shift);
  double visit(const Run& run, const Sweep& sweep, double* shift);
  void take_moved();

  static_assert(sizeof(Normal) <= sizeof(Row) && alignof(Normal) <= alignof(Row));

  std::shared_ptr<Row[]> room_;
  Normal* normals_;  ///< in room_
  std::size_t count_ = 0;
  std::vector<Run> runs_;
  std::vector<std::size_t> visited_;  ///< runs
  std::vector<char> has_moved_;       ///< of each active body, and one more that never does
};

}  // namespace snug::physics::internal
