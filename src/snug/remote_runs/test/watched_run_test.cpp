// A cell of another program as a run that is watched, and as a camera's scene.
#include "snug/remote_runs/watched_run.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/served_cell/server.hpp"

namespace snug::remote_runs {
namespace {

const model::Scenario& short_scenario() {
  static const model::Scenario one = cell::with_fixed_arrivals(model::test::shortened(3), "1");
  return one;
}

/// A cell that is served in a thread of its own.
class Served {
 public:
  Served()
      : simulation_(short_scenario(), "1", {motion::LaggedTracking{}, cup::CupMode::Phases, "ur10"}),
        simulator_(simulation_, {}),
        server_(simulator_, settings()) {
    thread_ = std::thread([this] { server_.run(); });
  }
  ~Served() { stop(); }
  void stop() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
    simulator_.end("the server was stopped");
  }
  [[nodiscard]] std::string endpoint() const { return server_.endpoint(); }

 private:
  static served_cell::ServerSettings settings() {
    static int count = 0;
    served_cell::ServerSettings settings;
    settings.endpoint = "ipc://" + (std::filesystem::temp_directory_path() /
                                    ("snug_watched_" + std::to_string(::getpid()) + "_" + std::to_string(++count)))
                                       .string();
    return settings;
  }
  cell::Simulation simulation_;
  served_cell::Simulator simulator_;
  served_cell::Server server_;
  std::thread thread_;
};

TEST(WatchedRun, ShowsWhatStandsStillOnceAndSaysThatItIsOver) {
  Served served;
  remote_plant::WatchedCell cell(short_scenario(), "1", served.endpoint(), 20.0);
  runs::RunCapture capture;
  std::vector<std::string> ends;
  WatchedRun watch(cell, capture, "1.2", [&](const std::string& why) { ends.push_back(why); });
  watch.stop();
  EXPECT_EQ(watch.run(), "");
  EXPECT_EQ(capture.recording.frames.size(), 1U);
  EXPECT_EQ(capture.recording.header.version, "1.2");
  EXPECT_EQ(capture.recording.header.sequence, "1");
  EXPECT_EQ(ends, std::vector<std::string>{""});
}

TEST(WatchedRun, EndsWithAReasonWhenTheCellIsGone) {
  Served served;
  remote_plant::WatchedCell cell(short_scenario(), "1", served.endpoint(), 0.2);
  runs::RunCapture capture;
  std::vector<std::string> ends;
  WatchedRun watch(cell, capture, "1.2", [&](const std::string& why) { ends.push_back(why); });
  served.stop();
  const std::string trouble = watch.run();
  EXPECT_NE(trouble, "");
  EXPECT_EQ(ends, std::vector<std::string>{trouble});
}

TEST(WatchedScene, HasTheRobotUnlessItIsLeftOut) {
  Served served;
  const remote_plant::WatchedCell cell(short_scenario(), "1", served.endpoint(), 20.0);
  const auto has_robot = [](const camera::Scene& scene) {
    return std::ranges::any_of(scene.names, [](const std::string& name) { return name.find("forearm") != name.npos; });
  };
  EXPECT_TRUE(has_robot(watched_scene(cell, "it")));
  EXPECT_FALSE(has_robot(scene_without_robot(cell)));
}

}  // namespace
}  // namespace snug::remote_runs
