// picture: what may be said after the verb.
#include "apps/snug/picture/picture.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

constexpr const char* kPictureExamples = R"(Examples:
  snug picture run.h5 -o end.png --camera top
  snug picture run.h5 --time 12.3 --size 1920x1080 --show frames,wrenches -o pick.png
  snug picture run.h5 --video frames --fps 25 --from 10 --to 20
  ffmpeg -framerate 25 -i frames/frame-%06d.png -pix_fmt yuv420p run.mp4      # makes a film of the last)";

// Pictures a second, and times as fast as it was.
constexpr double kSlowest = 1e-3;
constexpr double kFastest = 1000.0;

void read_size(const std::string& text, PictureOptions& options) {
  char rest = '\0';
  const int found = std::sscanf(text.c_str(), "%dx%d%c", &options.width, &options.height, &rest);
  const auto is_fine = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
  if (found == 2 && is_fine(options.width) && is_fine(options.height)) return;
  throw InputError("command line", "--size", text, "WIDTHxHEIGHT in pixels, each from 16 to 8192, such as 1280x800");
}

void check(const PictureOptions& options) {
  const bool is_video = !options.video.empty();
  if (is_video == !options.output.empty()) {
    throw InputError("command line", "-o, --video", is_video ? "both" : "none of them",
                     "-o FILE.png for one picture, or --video DIR for many");
  }
  if (is_video && options.time) throw InputError("command line", "--time", "with --video", "--from and --to");
  if (!is_video && (options.from || options.to)) {
    throw InputError("command line", "--from, --to", "without --video", "--time for one picture");
  }
}

}  // namespace

void add_picture(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("picture", "draw an instant of a recording as PNG, or the frames of a video; needs chromium");
  const auto options = std::make_shared<PictureOptions>();
  const auto size = std::make_shared<std::string>("1280x800");
  verb.add_option("recording", options->recording, "what to draw")->required()->type_name("FILE.h5");
  verb.add_option("-o,--output", options->output, "the picture to write")->type_name("FILE.png");
  verb.add_option("--time", options->time, "of the instant; without it the end")->check(finite())->type_name("SECONDS");
  verb.add_option("--video", options->video, "instead of one picture: frame-000000.png ... in this new or empty folder")
      ->type_name("DIR");
  verb.add_option("--fps", options->fps, "pictures a second of the video")
      ->check(within(kSlowest, kFastest))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--speed", options->speed, "of the video, recorded seconds a second")
      ->check(within(kSlowest, kFastest))
      ->type_name("FACTOR")
      ->capture_default_str();
  verb.add_option("--from", options->from, "where the video begins; without it the first frame")
      ->check(finite())
      ->type_name("SECONDS");
  verb.add_option("--to", options->to, "where the video ends; without it the last frame")
      ->check(finite())
      ->type_name("SECONDS");
  verb.add_option("--size", *size, "in pixels")->type_name("WxH")->capture_default_str();
  verb.add_option("--camera", options->camera, "cell, top, side (both of the container) or tool")
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--theme", options->theme, "light or dark")->type_name("NAME")->capture_default_str();
  verb.add_option("--show", options->show,
                  "parts to draw: names, contacts, forces, wrenches, ghost, frames, trace, xray, robot, walls, shadows")
      ->type_name("A,B");
  verb.add_option("--hide", options->hide, "parts to leave out")->type_name("A,B");
  verb.add_option("--urdf", options->urdf, "how the robot in it looks (default: the file that its scenario names)")
      ->type_name("FILE.urdf");
  verb.footer(kPictureExamples);
  verb.callback([options, size, &action] {
    action = [options, size] {
      read_size(*size, *options);
      check(*options);
      return run_picture(*options);
    };
  });
}

}  // namespace snug::app
