// LiveSimulation: a run in a thread of its own, for those who watch it; and runs one after the other, shown while
// somebody can.
#include "snug/serve/live_simulation.hpp"

#include <spawn.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/runs/result_json.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace snug::serve {

std::string describe_watched(const runs::RunResult& result) {
  auto json = nlohmann::ordered_json::parse(runs::format_result(result));
  json.erase("wall_s");
  json.erase("real_time_factor");
  return json.dump(2) + "\n";
}

LiveSimulation::LiveSimulation(model::Scenario scenario, runs::RunOptions options, LiveRun& live)
    : live_(live), scenario_(std::move(scenario)), options_(std::move(options)) {
  options_.observer = &live;
  options_.describe = describe_watched;
}

void LiveSimulation::start(std::function<void()> on_trouble) {
  thread_ = std::thread([this, on_trouble = std::move(on_trouble)] {
    try {
      result_ = runs::run(scenario_, options_);
      live_.finish(describe_watched(*result_), result_->failure.text, result_->is_interrupted);
    } catch (const std::exception& error) {
      trouble_ = std::current_exception();
      live_.finish("", error.what());
      on_trouble();
    }
  });
}

const runs::RunResult& LiveSimulation::result() {
  join();
  if (trouble_) std::rethrow_exception(trouble_);
  return *result_;
}

void LiveSimulation::join() {
  live_.stop();
  if (thread_.joinable()) thread_.join();
}

void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open", word = address;
  char* words[] = {program.data(), word.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program.c_str(), nullptr, nullptr, words, environ) == 0) {
    std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  }
}

}  // namespace snug::serve
