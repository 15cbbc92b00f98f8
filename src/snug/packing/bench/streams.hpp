// Streams: lines of boxes as the literature on packing online draws them, and a greedy of one line to compare with.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/packing/agent.hpp"

namespace snug::packing::bench {

/// One line of boxes, the container it goes into and what an agent may know of it.
struct Stream {
  ContainerState container;
  std::vector<Item> items;
  FutureModel future;
  PackingSettings settings;
};

/// `family`: rs, rs-support (sides 1 to 5 of a 10^3 container, drawn independently), cut1, cut2 (the container cut into
/// sides 2 to 5; by height, by what stands on what), cartons (60 to 300 mm, 600x400x300), cartons-pallet (the same on a
/// slab of that size), pallet (orders of cartons of 300 to 600 mm, upright, on 1230x1030 mm, 1850 mm high). None: no
/// such family.
[[nodiscard]] std::optional<Stream> draw_stream(const std::string& family, Rng rng);
/// The orders of a file (CSV or BED-BPP JSON), each as a line that an agent knows as `pack --future order` does, in a
/// box of 1200x800x800 mm. Throws InputError.
[[nodiscard]] std::vector<Stream> load_streams(const std::filesystem::path& orders);

/// Greedy agents: contact (most of the surface touches boxes, floor and walls), lowest (upper face as low as can be),
/// and the policies of the roll-outs by themselves: mixed, grid, pallet, pallet-layers.
[[nodiscard]] bool is_greedy(const std::string& agent);
/// The place that such an agent takes.
[[nodiscard]] std::optional<Candidate> place_greedily(const std::string& agent, const Stream& stream,
                                                      const ContainerState& state, const Item& item);

}  // namespace snug::packing::bench
