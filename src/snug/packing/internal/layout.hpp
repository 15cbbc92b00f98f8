// Layout: exact boxes in a container as integers, and every corner into which the next one can be lowered.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "snug/packing/internal/block_table.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::packing::internal {

/// Lengths are integers in tenths of a millimetre: sums are exact and equal on every machine. Origin: the corner of the
/// inner floor where Tx and Ty are smallest.
inline constexpr int kTicksPerMillimetre = 10;
inline constexpr double kTicksPerMetre = 10000.0;

/// An upright box that stands in the container.
struct Block {
  int x1 = 0, y1 = 0, z1 = 0, x2 = 0, y2 = 0, z2 = 0;
  int mass = 0;              ///< g
  int capacity = kNoLimit;   ///< g that may rest on it
  bool is_obstacle = false;  ///< nothing rests on it
  static constexpr int kNoLimit = 1 << 30;
  bool operator==(const Block&) const = default;
};

/// One way in which a piece can stand.
struct PieceOrientation {
  int width = 0, depth = 0, height = 0;  ///< along Tx, Ty, Tz
  int com_x = 0, com_y = 0;              ///< from the middle
  int tag = 0;                           ///< the caller's, for example an index of orientations
  bool operator==(const PieceOrientation&) const = default;
};

struct Piece {
  std::vector<PieceOrientation> orientations;
  int mass = 0;                    ///< g
  int capacity = Block::kNoLimit;  ///< g that may rest on it
  double volume = 0.0;             ///< m^3, as measured
  bool operator==(const Piece&) const = default;
};

struct Rules {
  int size_x = 0, size_y = 0, size_z = 0;
  int margin = 0;            ///< kept to boxes and walls
  double min_support = 0.6;  ///< part of the lower face
  int com_margin = 50;
  int level_slack = 30;  ///< tops that differ by less carry a box together
  int min_side = 0;      ///< narrower spaces are of no use
  int min_height = 0;
  bool has_walls = true;  ///< false: a pallet; of every block it is kept what it stands on
  bool operator==(const Rules&) const = default;
};

/// A piece lowered at a place. Margins are not part of it.
struct CandidatePose {
  int x = 0, y = 0, z = 0;
  int orientation = 0;   ///< index
  double support = 0.0;  ///< part of the lower face
  bool operator==(const CandidatePose&) const = default;
};

/// What one block rests on, and what rests on that: its own weight and what it carries. Loads go down to the blocks
/// below in proportion to the areas that they share; one that stands on a single block passes all of it straight down.
struct Bearing {
  static constexpr std::size_t kMost = 4;  ///< blocks below that are kept, those with most of the area
  Rectangle face;                          ///< around what it shares with the blocks below; on the floor its own face
  double mass = 0.0;                       ///< g
  Vector3 first_moment = Vector3::Zero();  ///< g times ticks
  std::array<int, kMost> below{};          ///< indices
  std::array<double, kMost> part{};        ///< of the load that each of them takes
  std::array<Vector3, kMost> at{};         ///< middles of what is shared with each, ticks
  std::size_t count = 0;                   ///< of them; 0 on the floor
};

enum class Refusal { None, Outside, Height, Support, Balance, Load };

/// Candidate poses found, each once, with the memory that finding them takes.
class CandidatePoseList {
 public:
  std::vector<CandidatePose> poses;
  void clear();
  /// False when this place has been seen since clear().
  bool is_new(int orientation, int x, int y);

 private:
  std::vector<std::uint64_t> table_ = std::vector<std::uint64_t>(512, 0);  ///< open addressing; size a power of two
  std::size_t used_ = 0;
  std::uint64_t round_ = 1;

  bool insert(std::uint64_t key);
};

class Layout {
 public:
  explicit Layout(const Rules& rules);

  void add(const Block& block);
  /// The block that a piece becomes at a pose.
  [[nodiscard]] static Block block_at(const Piece& piece, const CandidatePose& pose);

  /// Lowers a piece in an orientation at (x, y) until it rests. Fills the pose also when it is refused for what comes
  /// after Height.
  [[nodiscard]] Refusal settle(const Piece& piece, int orientation, int x, int y, CandidatePose& pose) const;

  /// Corners into which the piece can be lowered, each once, in a fixed order; returns how many were looked at.
  /// `worst` tells how far the best of the refused ones came.
  int find_poses(const Piece& piece, CandidatePoseList& list, Refusal* worst = nullptr) const;

  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  [[nodiscard]] const BlockTable& table() const { return table_; }
  [[nodiscard]] const Rules& rules() const { return rules_; }
  /// Mean height under the top of each block that is filled or lost and not under a block below it, ticks; parallel to
  /// blocks(): what a footprint covers of each, added up, is what is filled under it.
  [[nodiscard]] const std::vector<double>& columns() const { return columns_; }
  /// Level acceleration as a part of g, along -x, +x, -y, +y, from which a block, put there, or something below it
  /// would tip if nothing beside it held it: the least of lever over height of all faces through which its weight goes
  /// down. For layouts without walls.
  [[nodiscard]] std::array<double, 4> tipping_of(const Block& block) const;

  /// ticks^2 that stay free, once a block is put there, of the tops that it rests on. For layouts without walls.
  [[nodiscard]] std::int64_t left_exposed(const Block& block) const;

 private:
  struct Space {
    int level = 0;
    Rectangle area;
    bool supported = false;
  };

  void split_spaces(const Rectangle& hole, int top);
  void open_level(int level);
  void cut(std::vector<Rectangle>& areas, const Rectangle& hole);
  [[nodiscard]] bool is_supported(int level, const Rectangle& area) const;
  [[nodiscard]] bool is_balanced(const Rectangle& face, int base, int com_x, int com_y) const;
  [[nodiscard]] bool carries(const Rectangle& face, int base, int mass) const;
  [[nodiscard]] bool rests_on_obstacle(const Rectangle& face, int base) const;
  void add_load(std::size_t upper, double mass);
  [[nodiscard]] bool bears_at(const Block& below, int base) const;
  [[nodiscard]] Bearing bearing_of(const Block& block) const;
  /// Calls visit(index, mass, place) for every block on which a part of a load rests that goes through `bearing`.
  template <class Visit>
  void go_down(const Bearing& bearing, double mass, const Vector3& place, const Visit& visit) const;

  Rules rules_;
  std::vector<Block> blocks_;
  BlockTable table_;  ///< the same by coordinate
  std::vector<double> columns_;
  std::vector<double> loads_;          ///< g on each block; kept only when a block has a limit
  std::vector<Bearing> bearings_;      ///< of each block; kept only without walls
  std::vector<std::int64_t> exposed_;  ///< ticks^2 of its top on which nothing rests; kept only without walls
  bool has_limits_ = false;
  bool has_obstacles_ = false;
  std::vector<Space> spaces_;
  std::vector<int> levels_;
  struct {
    std::vector<Space> spaces;
    std::vector<Rectangle> areas, fresh;
  } spare_;  ///< memory of add(); empty between calls
};

}  // namespace snug::packing::internal
