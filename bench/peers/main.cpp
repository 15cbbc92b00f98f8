// bench_peers: the scenes in every engine at hand, as a table or as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "peers/measure.hpp"
#include "peers/tosses.hpp"

namespace {

using snug::peers::Engine;
using snug::peers::Result;

struct Candidate {
  std::string name;
  std::function<std::unique_ptr<Engine>()> make;
  std::filesystem::path needs{};  ///< a package that may be absent
  bool is_slow = false;           ///< milliseconds a step: measured only where it is asked for
};

const std::filesystem::path kPackages = SNUG_PEER_PACKAGES;

/// An engine of Python's package index. `module`: the folder of the package.
Candidate from_wheel(const std::string& name, const std::string& worker, const std::string& module,
                     std::vector<std::string> options) {
  std::vector<std::string> command{(kPackages / "bin/python").string(),
                                   std::string(SNUG_PEER_WORKERS "/") + worker + "_worker.py"};
  command.insert(command.end(), options.begin(), options.end());
  return {name, [command] { return snug::peers::make_process(command); }, kPackages / "modules" / module};
}

/// Jolt of npm's package index.
Candidate from_npm(const std::string& name, const std::vector<std::string>& options) {
  std::vector<std::string> command{"node", SNUG_PEER_WORKERS "/jolt_worker.mjs", (kPackages / "npm").string()};
  command.insert(command.end(), options.begin(), options.end());
  return {name, [command] { return snug::peers::make_process(command); }, kPackages / "npm/node_modules/jolt-physics"};
}

Candidate slow(Candidate candidate) {
  candidate.is_slow = true;
  return candidate;
}

/// The settings are those of bench/README.md; a new engine is one line here.
std::vector<Candidate> candidates() {
  using namespace snug::peers;
  const std::vector<std::string> stiff{"--cone", "elliptic", "--impratio", "10",  "--solref",
                                       "0.004",  "--solimp", "0.95",       "0.99"};
  return {
      {"snug", [] { return make_snug({}); }},
      {"snug-face", [] { return make_snug({.bears_on_faces = true}); }},
      {"bullet-si50", [] { return make_bullet({.iterations = 50, .use_two_friction_directions = true}); }},
      {"bullet-si10", [] { return make_bullet({}); }},
      {"mujoco-elliptic-stiff", [] { return make_mujoco(kMujocoStiff); }},
      {"mujoco-pyramid", [] { return make_mujoco({}); }},
      from_wheel("mujoco4-elliptic-stiff", "mujoco", "mujoco", stiff),
      from_wheel("mujoco4-pyramid", "mujoco", "mujoco", {}),
      from_wheel("rapier", "rapier", "rapier3d", {}),
      from_wheel("rapier-50", "rapier", "rapier3d", {"--iterations", "50"}),
      from_npm("jolt", {}),
      from_npm("jolt-50-10", {"--steps", "50", "10", "--slop", "1e-4"}),
      slow(from_wheel("drake-hydroelastic", "drake", "pydrake", {})),
      slow(from_wheel("newton-kamino", "newton", "newton", {})),
  };
}

constexpr const char* kUsage =
    R"(usage: bench_peers [--json] [--engine NAME]... [--scene NAME]...
       bench_peers --tosses FILE.csv [--evaluations N] [--starts N] [--json] [--engine NAME]...
Runs scenes in the engines named (default: s1 to s8, tower and wall in all that are installed but Drake and Newton) and
prints the figures that bench/README.md explains. More scenes: pile100, pile300, pile1000 (to 1.4 s), heap100, heap300,
heap1000 (to 4 s).
  bench_peers --scene s1 --engine bullet-si50
  bench_peers --scene pile300 --engine snug --engine bullet-si50
  bench_peers --json > peers.json
  bench_peers --tosses tosses.csv --evaluations 150   (real cube tosses, each engine tuned alike)
)";

struct Options {
  bool is_json = false;
  std::vector<std::string> engines, scenes;
  snug::peers::TossOptions tosses;  ///< no file: the scenes
};

bool is_wanted(const std::vector<std::string>& wanted, const std::string& name) {
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

const std::vector<std::string> kScenes{"s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "tower", "wall"};
/// Only where they are asked for: they take long.
const std::vector<std::string> kPiles{"pile100", "pile300", "pile1000", "heap100", "heap300", "heap1000"};

/// The problem with the arguments, empty if there is none.
std::string parse(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--json") {
      options.is_json = true;
    } else if ((word == "--engine" || word == "--scene") && i + 1 < argc) {
      (word == "--engine" ? options.engines : options.scenes).emplace_back(argv[++i]);
    } else if (word == "--tosses" && i + 1 < argc) {
      options.tosses.file = argv[++i];
    } else if (word == "--evaluations" && i + 1 < argc) {
      options.tosses.evaluations = std::atoi(argv[++i]);
      if (options.tosses.evaluations < 1) return fmt::format("--evaluations '{}': expected a number above 0", argv[i]);
    } else if (word == "--starts" && i + 1 < argc) {
      options.tosses.starts = std::atoi(argv[++i]);
      if (options.tosses.starts < 1) return fmt::format("--starts '{}': expected a number above 0", argv[i]);
    } else {
      return fmt::format("unknown or incomplete argument '{}'", word);
    }
  }
  std::vector<std::string> engines;
  for (const Candidate& candidate : candidates()) engines.push_back(candidate.name);
  for (const std::string& name : options.engines) {
    if (!is_wanted(engines, name)) return fmt::format("unknown engine '{}'; known: {}", name, fmt::join(engines, ", "));
  }
  for (const std::string& name : options.scenes) {
    if (is_wanted(kScenes, name) || is_wanted(kPiles, name)) continue;
    return fmt::format("unknown scene '{}'; known: {}, {}", name, fmt::join(kScenes, ", "), fmt::join(kPiles, ", "));
  }
  return {};
}

struct Row {
  std::string unit;
  std::map<std::string, double> values;  // by engine
};

struct Table {
  std::vector<std::string> engines, names;  // in the order of measuring
  std::map<std::string, Row> rows;
};

void add(Table& table, const std::string& engine, const Result& result) {
  if (table.rows.count(result.name) == 0) table.names.push_back(result.name);
  Row& row = table.rows[result.name];
  row.unit = result.unit;
  row.values[engine] = result.value;
}

Table run_all(const Options& options) {
  Table table;
  for (const Candidate& candidate : candidates()) {
    if (!is_wanted(options.engines, candidate.name)) continue;
    if (candidate.is_slow && options.engines.empty()) continue;
    if (!candidate.needs.empty() && !std::filesystem::exists(candidate.needs)) {
      fmt::print(stderr, "{} skipped: not installed (scripts/install-peers.sh)\n", candidate.name);
      continue;
    }
    table.engines.push_back(candidate.name);
    if (!options.tosses.file.empty()) {
      fmt::print(stderr, "{} tosses\n", candidate.name);
      for (const Result& result : measure_tosses(candidate.make, options.tosses)) add(table, candidate.name, result);
      continue;
    }
    for (const std::string& scene : options.scenes.empty() ? kScenes : options.scenes) {
      fmt::print(stderr, "{} {}\n", candidate.name, scene);
      const std::unique_ptr<Engine> engine = candidate.make();
      for (const Result& result : measure(*engine, scene)) add(table, candidate.name, result);
    }
  }
  return table;
}

void print_json(const Table& table) {
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (const std::string& engine : table.engines) {
    for (const std::string& name : table.names) {
      const Row& row = table.rows.at(name);
      const auto value = row.values.find(engine);
      if (value == row.values.end()) continue;
      nlohmann::ordered_json entry{{"engine", engine}, {"name", name}, {"value", nullptr}, {"unit", row.unit}};
      if (std::isfinite(value->second)) entry["value"] = value->second;
      results.push_back(entry);
    }
  }
  fmt::print("{}\n", nlohmann::ordered_json{{"results", results}}.dump(2));
}

/// Times of one run relative to the first engine: what can be compared across machines.
void print_ratios(const Table& table, const std::string& name) {
  const Row& row = table.rows.at(name);
  fmt::print("{:<32}{:>6}", "  relative to the first", "");
  for (const std::string& engine : table.engines) {
    const auto value = row.values.find(engine), first = row.values.find(table.engines.front());
    const bool is_known = value != row.values.end() && first != row.values.end();
    fmt::print("{:>24}", is_known ? fmt::format("{:.3g}", value->second / first->second) : "-");
  }
  fmt::print("\n");
}

void print_table(const Table& table) {
  fmt::print("{:<32}{:>6}", "", "unit");
  for (const std::string& engine : table.engines) fmt::print("{:>24}", engine);
  fmt::print("\n");
  for (const std::string& name : table.names) {
    const Row& row = table.rows.at(name);
    fmt::print("{:<32}{:>6}", name, row.unit);
    for (const std::string& engine : table.engines) fmt::print("{:>24.4g}", row.values.at(engine));
    fmt::print("\n");
    if (row.unit == "us") print_ratios(table, name);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (argc == 2 && std::string(argv[1]) == "--help") {
    fmt::print("{}", kUsage);
    return 0;
  }
  if (const std::string problem = parse(argc, argv, options); !problem.empty()) {
    fmt::print(stderr, "bench_peers: {}\n{}", problem, kUsage);
    return 2;
  }
  try {
    const Table table = run_all(options);
    options.is_json ? print_json(table) : print_table(table);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_peers: {}\n", error.what());
    return 1;
  }
  return 0;
}
