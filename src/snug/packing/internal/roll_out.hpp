// Roll-outs: what becomes of a layout when the items to come are placed by the policy.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/packing/internal/layout.hpp"
#include "snug/packing/internal/policy.hpp"

namespace snug::packing::internal {

/// What may come: a kind with weight 0 does not.
struct Prospect {
  std::vector<Piece> kinds;
  std::vector<double> weights;
  bool comes_once = false;  ///< a kind that was drawn is not drawn again
};

using Future = std::vector<int>;  ///< indices of kinds, in the order in which they come

/// Enough items to fill `volume` m^3; fewer where no more are left.
[[nodiscard]] Future draw_future(const Prospect& prospect, double volume, Rng& rng);

/// Scratch of one thread.
struct RollOutWork {
  CandidatePoseList list;
  std::optional<Layout> layout;  ///< of the present roll-out: keeps its memory from one to the next
  std::int64_t looked_at = 0;    ///< places, in all roll-outs: the unit in which effort is counted
};

/// The pose of least cost; false when there is none.
[[nodiscard]] bool choose(const Layout& layout, const Policy& policy, const Piece& piece, RollOutWork& work,
                          CandidatePose& best);

/// Volume in m^3 that gets in before more items than `skips` did not fit.
[[nodiscard]] double roll_out(const Layout& layout, const Policy& policy, const Prospect& prospect,
                              const Future& future, int skips, RollOutWork& work);

/// Roll-outs of many futures from one layout: steps with which futures begin alike are taken once, and their places
/// counted each time. Each roll-out keeps one more step, so that steps are kept where futures come by again.
class RollOutTree {
 public:
  /// Steps that are kept, 4 kB each. On demonstrator orders (five random ones, packing_bench, 2026-11) decisions took
  /// 0.74 of the time of roll-outs that share nothing, 0.75 with 5000, 0.80 where every step of 3000 is kept; 0.66 with
  /// trees that last for a race.
  static constexpr std::size_t kMostSteps = 1000;

  explicit RollOutTree(Layout start, std::size_t most_steps = kMostSteps);

  /// As roll_out() from the start, to the last bit; `work` counts all of its places. Policy, prospect and skips are
  /// those of the first.
  [[nodiscard]] double roll_out(const Policy& policy, const Prospect& prospect, const Future& future, int skips,
                                RollOutWork& work);

 private:
  struct Step {
    Layout layout;  ///< after it
    bool is_placed = false;
    std::int64_t looked_at = 0;                     ///< places, to choose it
    std::vector<std::pair<int, std::size_t>> next;  ///< kind that came then, and the index of its step
  };
  /// What comes of a kind after a step; its index.
  std::size_t add(std::size_t before, int kind, const Policy& policy, const Piece& piece, RollOutWork& work);

  std::vector<Step> steps_;  ///< the first is the start
  std::size_t most_steps_;
};

struct RaceSettings {
  std::uint64_t seed = 1;
  int threads = 1;
  std::int64_t effort = 0;  ///< places to be looked at, about
  int first_futures = 8;    ///< of every entrant, whatever the effort
  int skips = 0;            ///< items that may be skipped in a roll-out before it ends
  double doubt = 1.0;       ///< times the sqrt(2 ln m) standard errors that are taken off a gain
  /// Too short for doubt to leave any gain: a gain counts as much as is expected of it after it was seen.
  bool is_short = false;
};

struct Standing {
  int entrant = 0;
  double mean = 0.0;  ///< m^3 that got in on average
  int roll_outs = 0;
  double gain = 0.0;          ///< m^3 more than the first entrant, on average over the futures that both met
  double gain_squares = 0.0;  ///< m^6, sum of squares of these
  double sure = 0.0;          ///< m^3, in the end: what counts of the gain, less what it costs more
};

/// Successive halving: all entrants meet the same futures, the worse half drops out, the rest meets more of them.
/// `charges`: m^3 that are taken off an entrant's mean before it is compared, one each; empty: nothing is.
/// The first entrant is what the policy would do; it meets all futures, and another one comes before it only by a gain
/// beyond what the luckiest of the m entrants of the last heat has by chance: no reason to leave the policy. In a short
/// race it comes before it by what is expected of its gain, where all gains have the mean and the variance of those of
/// the first heat. Best first, of equals the cheapest, then the one that comes first; same result at any number of
/// threads.
[[nodiscard]] std::vector<Standing> race(std::span<const Layout> entrants, const Policy& policy,
                                         const Prospect& prospect, double free_volume, const RaceSettings& settings,
                                         std::int64_t* roll_outs, const std::vector<double>& charges = {});

struct PolicyChoice {
  std::size_t policy = 0;  ///< index
  std::int64_t looked_at = 0;
  int roll_outs = 0;
};

/// Which of the policies places more of what may come when it goes on from `layout` with `piece`, on a few futures that
/// all of them meet; the first of equals.
[[nodiscard]] PolicyChoice choose_policy(const Layout& layout, const Piece& piece, const std::vector<Policy>& policies,
                                         const Prospect& prospect, double free_volume, const RaceSettings& settings);

}  // namespace snug::packing::internal
