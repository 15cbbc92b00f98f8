// Another container: a scenario whose target is another of its containers, a box of other sizes, or a pallet.
#pragma once

#include <string>

#include "snug/model/scenario.hpp"

namespace snug::model {

/// The scenario with another target, and a text that says so. `words` name one of its containers, or are inner sizes in
/// mm, "LxWxH": then the target becomes an open box of that inside. Its floor, its middle, the thickness of its walls
/// and its material stay; the longer of L and W lies along the longer side of the target that was there. Boxes that do
/// not fit into it are no error. Throws InputError for words that are neither, sizes beyond 10 mm .. 10 m, and where
/// something else stands in the way or over it.
[[nodiscard]] Scenario with_container(const Scenario& scenario, const std::string& words);

/// The same for a pallet, "LxW" or "LxWxH" in mm: a slab without walls, its upper face where the floor was, on which
/// boxes may stand H high (without H: as deep as the target was).
[[nodiscard]] Scenario with_pallet(const Scenario& scenario, const std::string& words);

}  // namespace snug::model
