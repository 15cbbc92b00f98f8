// picture: one instant of a recording as PNG, or many for a video, drawn without a screen.
#include "apps/snug/command_line/verbs.hpp"

#include <unistd.h>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/picture.hpp"
#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {
namespace {

struct PictureOptions {
  std::string recording;
  std::string output;          ///< one picture; empty: a video
  std::optional<double> time;  ///< s; absent: the end
  std::string video;           ///< folder for numbered pictures; empty: one picture
  replay::VideoTimes video_times;
  std::string size = "1280x800";  ///< px
  replay::PictureView view;
  std::optional<std::string> urdf;  ///< of the robot in it; absent: looked for
};

/// Drawn first at `time`, s.
replay::Studio make_studio(const PictureOptions& options, const replay::PictureView& view,
                           record::RecordingReader& reader, double time) {
  const report::PageRecording recording = encode_recording(reader, options.recording, {}, options.urdf);
  return {report::assemble_page(viewer_page(), {&recording, 1}), view, time};
}

void draw_video(const PictureOptions& options, const replay::PictureView& view, record::RecordingReader& reader) {
  const std::vector<double> instants = replay::video_instants(reader.times(), options.video_times);
  make_folder("--video", options.video);
  const replay::VideoFolder folder(options.video);
  replay::Studio studio = make_studio(options, view, reader, options.video_times.from.value_or(reader.times().back()));
  const bool is_watched = ::isatty(STDERR_FILENO) == 1;
  folder.draw(studio, instants, is_interrupted, [&](std::size_t done) {
    if (is_watched) std::fprintf(stderr, "\r%zu of %zu pictures", done, instants.size());
  });
  std::fprintf(stderr, "%s%s: %zu pictures\n", is_watched ? "\r" : "", options.video.c_str(), instants.size());
}

void check_picture_words(const PictureOptions& options) {
  const bool is_video = !options.video.empty();
  if (is_video == !options.output.empty()) {
    throw InputError("command line", "-o, --video", is_video ? "both" : "none of them",
                     "-o FILE.png for one picture, or --video DIR for many");
  }
  if (is_video && options.time) throw InputError("command line", "--time", "with --video", "--from and --to");
  if (!is_video && (options.video_times.from || options.video_times.to)) {
    throw InputError("command line", "--from, --to", "without --video", "--time for one picture");
  }
}

int run_picture(const PictureOptions& options) {
  check_picture_words(options);
  replay::PictureView view = options.view;
  view.size = replay::parse_picture_size(options.size);
  replay::expect_picture_parts("--show", view.show);
  replay::expect_picture_parts("--hide", view.hide);
  std::optional<OutputFile> output;
  NamedFiles inputs = {{"the recording", options.recording}};
  add_file(inputs, "--urdf", options.urdf);
  if (!options.output.empty()) output = reserve(inputs, options.output);
  record::RecordingReader reader(options.recording);
  expect_recorded(reader, options.recording, options.time);
  catch_interrupts();
  try {
    if (!options.video.empty()) {
      draw_video(options, view, reader);
    } else {
      const double time = options.time.value_or(reader.times().back());
      const std::string picture = make_studio(options, view, reader, time).take_picture();
      write_file(std::move(*output), picture);
      std::fprintf(stderr, "%s: %dx%d at %.3f s, camera %s\n", options.output.c_str(), view.size.width,
                   view.size.height, time, view.camera.c_str());
    }
  } catch (const replay::BrowserError& error) {
    std::fprintf(stderr, "snug: failed: %s\n", error.what());
    return kRunFailed;
  }
  return kSuccess;
}

constexpr const char* kPictureExamples = R"(Examples:
  snug picture run.h5 -o end.png --camera top
  snug picture run.h5 --time 12.3 --size 1920x1080 --show frames,wrenches -o pick.png
  snug picture run.h5 --video frames --fps 25 --from 10 --to 20
  ffmpeg -framerate 25 -i frames/frame-%06d.png -pix_fmt yuv420p run.mp4      # makes a film of the last)";

// Pictures a second, and times as fast as it was.
constexpr double kSlowest = 1e-3;
constexpr double kFastest = 1000.0;

}  // namespace

void add_picture(CLI::App& app, Action& action) {
  const Verb verb(app, action, "picture",
                  "draw an instant of a recording as PNG, or the frames of a video; needs chromium", kPictureExamples);
  PictureOptions& options = verb.runs(run_picture);
  verb.option("recording", options.recording, "FILE.h5", "recording to draw").required();
  verb.option("-o,--output", options.output, "FILE.png", "the picture to write");
  verb.option("--time", options.time, "SECONDS", "instant (default: the end)", finite());
  verb.option("--video", options.video, "DIR",
              "write the frames of a video instead: frame-000000.png ... in this new or empty folder");
  verb.option("--fps", options.video_times.fps, "N", "pictures per second of the video", within(kSlowest, kFastest));
  verb.option("--speed", options.video_times.speed, "FACTOR", "recorded seconds per second of the video",
              within(kSlowest, kFastest));
  verb.option("--from", options.video_times.from, "SECONDS", "start of the video (default: the first frame)", finite());
  verb.option("--to", options.video_times.to, "SECONDS", "end of the video (default: the last frame)", finite());
  verb.option("--size", options.size, "WxH", "in pixels");
  verb.option("--camera", options.view.camera, "NAME", "cell, top, side (both of the container) or tool",
              one_of({"cell", "top", "side", "tool"}));
  verb.option("--theme", options.view.theme, "NAME", "light or dark", one_of({"light", "dark"}));
  verb.option("--show", options.view.show, "A,B",
              "parts to draw: names, contacts, forces, wrenches, ghost, frames, trace, xray, robot, walls, shadows");
  verb.option("--hide", options.view.hide, "A,B", "parts to leave out");
  add_urdf(verb, options.urdf);
}

}  // namespace snug::app
