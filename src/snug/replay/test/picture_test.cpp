// Pictures: sizes, parts, instants and folders, without a browser.
#include "snug/replay/picture.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "snug/core/input_error.hpp"

namespace snug::replay {
namespace {

TEST(PictureSize, IsTwoNumbersWithinWhatBrowsersDraw) {
  EXPECT_EQ(parse_picture_size("640x480").width, 640);
  EXPECT_EQ(parse_picture_size("640x480").height, 480);
  for (const char* words : {"640", "640x", "x480", "640x480x1", "15x480", "640x8193", "-640x480", ""})
    EXPECT_THROW((void)parse_picture_size(words), InputError) << words;
}

TEST(PictureParts, AreThoseThatThePageDraws) {
  EXPECT_NO_THROW(expect_picture_parts("--show", "names,shadows"));
  EXPECT_NO_THROW(expect_picture_parts("--show", ""));
  EXPECT_THROW(expect_picture_parts("--show", "names,shade"), InputError);
}

TEST(VideoInstants, GoFromTheFirstToTheLastPictureAtTheSpeed) {
  const std::vector<double> recorded = {1.0, 1.5, 3.0};
  EXPECT_EQ(video_instants(recorded, {.fps = 2.0}), (std::vector<double>{1.0, 1.5, 2.0, 2.5, 3.0}));
  EXPECT_EQ(video_instants(recorded, {.from = 1.5, .to = 2.5, .fps = 2.0, .speed = 2.0}),
            (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(video_instants(recorded, {.from = -5.0, .to = 9.0, .fps = 1.0}).size(), 3U) << "no more than was recorded";
  EXPECT_THROW((void)video_instants(recorded, {.from = 3.5}), InputError);
  EXPECT_THROW((void)video_instants(recorded, {.fps = 1e6}), InputError) << "more than a disk holds";
}

TEST(VideoFolder, IsEmptyAndHasOneWriter) {
  const TemporaryFolder folder("snug-video");
  const std::filesystem::path path = folder.path() / "frames";
  std::filesystem::create_directory(path);
  {
    const VideoFolder one(path);
    EXPECT_THROW(VideoFolder{path}, InputError) << "another run is writing to it";
  }
  EXPECT_NO_THROW(VideoFolder{path}) << "no more";
  std::ofstream(path / "old.png") << "x";
  EXPECT_THROW(VideoFolder{path}, InputError);
}

}  // namespace
}  // namespace snug::replay
