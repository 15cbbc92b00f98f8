// packing_bench: counts and filling degrees of the agents, without executing anything.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/packing/agent.hpp"
#include "snug/packing/bench/streams.hpp"

namespace {

using namespace snug;
using namespace snug::packing;

struct Options {
  std::string agent = "contact-aware";
  int random = 0;
  double noise = 0.0;
  int seeds = 1;
  int first = 1;
  int skips = 0;
  PackingSettings settings;
  DecisionRun run;
  std::string stream;  ///< family of draw_stream, or a file of orders; empty: the demonstrator's boxes
  int count = 5;       ///< streams
};

struct Outcome {
  int boxes = 0;
  int rearranged = 0;
  double percent = 0.0;
  double seconds = 0.0;
  double slowest = 0.0;
};

Outcome pack(const model::Scenario& scenario, const std::vector<Item>& items, const Options& options) {
  const auto agent =
      make_agent(options.agent, {options.settings, make_future_model(scenario), items, {}, {}, options.run});
  ContainerState state = make_container_state(*model::find_container(scenario, scenario.target));
  state.skips_left = options.skips;
  Rng rng = Rng(options.run.seed).split("noise");
  Outcome outcome;
  for (const Item& item : items) {
    const auto start = std::chrono::steady_clock::now();
    const auto decision = agent->decide(state, item);
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    outcome.seconds += took;
    outcome.slowest = std::max(outcome.slowest, took);
    if (!decision) {
      if (state.skips_left-- <= 0) break;
      state.skipped.push_back(item.id);
      continue;
    }
    const bool anew = !decision->candidates.front().rearranged.empty();
    outcome.rearranged += anew ? 1 : 0;
    state = with_candidate(state, item, decision->candidates.front());
    if (!anew) {
      const double y = rng.normal(), x = rng.normal();
      state.boxes.back().X_TP.p.head<2>() += options.noise * Eigen::Vector2d(x, y);
    }
  }
  outcome.boxes = static_cast<int>(state.boxes.size());
  outcome.percent = filling_percent(state);
  outcome.seconds /= std::max(1, outcome.boxes);
  return outcome;
}

std::vector<Item> random_sequence(const model::Scenario& scenario, int seed) {
  Rng rng = Rng(static_cast<std::uint64_t>(seed)).split("random sequence");
  std::vector<model::Parcel> left = scenario.parcels;
  std::vector<Item> items;
  while (!left.empty()) {
    const int i = rng.index(static_cast<int>(left.size()));
    model::Item item;
    item.parcel = left[static_cast<std::size_t>(i)].id;
    items.push_back(make_item(scenario, item));
    left.erase(left.begin() + i);
  }
  return items;
}

/// Percent filled at the first box without a place that may not be skipped.
double pack_stream(const bench::Stream& stream, const Options& options) {
  AgentInput input{stream.settings, stream.future, stream.items, {}, {}, options.run};
  const bool is_greedy = bench::is_greedy(options.agent);
  const auto agent = is_greedy ? nullptr : make_agent(options.agent, std::move(input));
  ContainerState state = stream.container;
  state.skips_left = options.skips;
  for (const Item& item : stream.items) {
    std::optional<Candidate> best;
    if (is_greedy) {
      best = bench::place_greedily(options.agent, stream, state, item);
    } else if (auto decision = agent->decide(state, item)) {
      best = decision->candidates.front();
    }
    if (best) {
      state = with_candidate(std::move(state), item, *best);
    } else {
      if (state.skips_left-- <= 0) break;
      state.skipped.push_back(item.id);
    }
  }
  return filling_percent(state);
}

std::vector<bench::Stream> streams_of(const Options& options) {
  if (options.stream.ends_with(".json") || options.stream.ends_with(".csv")) return bench::load_streams(options.stream);
  std::vector<bench::Stream> streams;
  for (int i = 0; i < options.count; ++i) {
    const Rng rng = Rng(static_cast<std::uint64_t>(options.first + i)).split("stream " + options.stream);
    if (auto stream = bench::draw_stream(options.stream, rng)) streams.push_back(std::move(*stream));
  }
  return streams;
}

int pack_streams(const Options& options) {
  const std::vector<bench::Stream> streams = streams_of(options);
  if (streams.empty()) {
    std::fprintf(stderr, "no family '%s'\n", options.stream.c_str());
    return 2;
  }
  double sum = 0.0, squares = 0.0;
  for (const bench::Stream& stream : streams) {
    const double percent = pack_stream(stream, options);
    std::printf("%.1f ", percent);
    std::fflush(stdout);
    sum += percent;
    squares += percent * percent;
  }
  const auto n = static_cast<double>(streams.size());
  const double mean = sum / n;
  std::printf(" %s %s: mean %.2f sd %.2f n %d\n", options.stream.c_str(), options.agent.c_str(), mean,
              std::sqrt(std::max(0.0, squares / n - mean * mean)), static_cast<int>(streams.size()));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view key = argv[i];
    const char* value = argv[i + 1];
    if (key == "--agent") o.agent = value;
    if (key == "--random") o.random = std::atoi(value);
    if (key == "--noise") o.noise = std::atof(value);
    if (key == "--seeds") o.seeds = std::atoi(value);
    if (key == "--seed") o.run.seed = static_cast<std::uint64_t>(std::atoll(value));
    if (key == "--time") o.run.time = std::atof(value);
    if (key == "--threads") o.run.threads = std::atoi(value);
    if (key == "--planned-interference") o.settings.planned_interference = std::atof(value);
    if (key == "--first") o.first = std::atoi(value);
    if (key == "--stream") o.stream = value;
    if (key == "--count") o.count = std::atoi(value);
    if (key == "--skips") o.skips = std::atoi(value);
    if (key == "--last-interference") {
      o.settings.last_interference = std::atof(value);
      o.run.tries_places = true;
    }
  }
  if (!o.stream.empty()) return pack_streams(o);
  const model::Scenario scenario = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  for (int s = 0; s < o.seeds; ++s, ++o.run.seed) {
    double sum = 0.0, slowest = 0.0, mean_time = 0.0;
    int count = 0;
    const int runs = o.random > 0 ? o.random : static_cast<int>(scenario.sequences.size());
    for (int i = 0; i < runs; ++i) {
      const std::vector<Item> items = o.random > 0
                                          ? random_sequence(scenario, i + o.first)
                                          : make_items(scenario, scenario.sequences[static_cast<std::size_t>(i)]);
      const Outcome r = pack(scenario, items, o);
      std::printf("%d/%.1f ", r.boxes, r.percent);
      std::fflush(stdout);
      sum += r.percent;
      mean_time += r.seconds;
      slowest = std::max(slowest, r.slowest);
      ++count;
    }
    std::printf(" mean %.2f  time %.3f slowest %.3f\n", sum / count, mean_time / count, slowest);
  }
}
