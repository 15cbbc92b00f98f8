// camera: what may be said after the verb.
#include "apps/snug/camera/camera.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"

namespace snug::app {
namespace {

constexpr const char* kCameraExamples = R"(What is written goes by the ending of FILE:
  .png  depth, 16-bit grey in steps of 0.1 mm; beside it FILE-intensity.png, FILE-labels.png and FILE-truth.json
  .ply  points in the world with intensity, row, column and label; beside it FILE-truth.json
  .h5   depth, intensity, and the truth: depth, labels, poses
The truth is what nobody measures: poses and labels of the bodies, and where the camera really is. docs/camera.md has the errors.
Examples:
  snug camera run.h5 --time 20 -o frame.png
  snug camera run.h5 --time 20 --camera tote --seed 3 --shot 2 -o frame.h5
  snug camera run.h5 --scenario scenarios/box-demonstrator.yaml -o frame.ply   # with the cameras of another scenario
With --click ADDRESS, and a scenario instead of a recording, the cell is one that `snug serve` serves now: the camera of a simulated cell, as a
program of its own (docs/camera.md).)";

}  // namespace

void add_camera(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("camera", "what a depth camera of the cell sees at an instant of a recording, or now");
  const auto options = std::make_shared<CameraOptions>();
  verb.add_option("recording", options->recording, "of a run; with --click the scenario that is served")
      ->required()
      ->type_name("FILE.h5|SCENARIO.yaml");
  verb.add_option("-o,--output", options->output, "the frame to write: .png, .ply or .h5")
      ->required()
      ->type_name("FILE");
  CLI::Option* time = verb.add_option("--time", options->time, "of the instant; without it the end")
                          ->check(finite())
                          ->type_name("SECONDS");
  CLI::Option* click = verb.add_option("--click", options->click,
                                       "look at the cell that is served at this address, beside its controller")
                           ->type_name("ADDRESS")
                           ->excludes(time);
  verb.add_option("--sequence", options->sequence, "of a served cell; without it the first")
      ->type_name("NAME")
      ->needs(click);
  add_scenario_changes(verb, options->changes);
  verb.add_option("--keys", options->keys, "keys by which this program is known there (`snug keys`)")
      ->type_name("DIR")
      ->needs(click);
  verb.add_option("--timeout", options->patience, "how long to wait for an answer from there")
      ->check(within(0.01, 1e5))
      ->type_name("SECONDS")
      ->needs(click)
      ->capture_default_str();
  verb.add_flag("--without-robot", options->without_robot, "of a served cell: the robot is out of the view")
      ->needs(click);
  verb.add_option("--camera", options->camera, "name in the scenario; without it the first")->type_name("NAME");
  verb.add_option("--scenario", options->scenario, "with the camera, where the recording's own has none")
      ->type_name("FILE.yaml")
      ->excludes(click);
  verb.add_option("--seed", options->seed, "of the errors that stay with a camera; without it the recording's")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option("--shot", options->shot, "number of the frame: its noise")
      ->check(whole(0))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--threads", options->threads, "at work; the frame does not depend on it")
      ->check(whole(1, kMostThreads))
      ->type_name("N")
      ->capture_default_str();
  verb.add_flag("--exact", options->exact, "without errors");
  verb.add_flag("--json", options->json, "what was seen of each body, as one JSON object on stdout");
  verb.footer(kCameraExamples);
  verb.callback([options, &action] { action = [options] { return run_camera(*options); }; });
}

}  // namespace snug::app
