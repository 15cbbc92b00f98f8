// Pictures: instants of a recording as PNG, drawn by the page that holds it, in a browser without a screen.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/descriptor.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/replay/browser.hpp"

namespace snug::replay {

struct PictureSize {
  int width = 0, height = 0;  ///< px
};
/// "1280x800". Throws InputError for what is none, and for less than 16 or more than 8192 pixels.
[[nodiscard]] PictureSize parse_picture_size(const std::string& words);
/// Of a list with commas. Throws InputError with the option for a part that the page does not draw.
void expect_picture_parts(const char* option, const std::string& list);

/// How the page draws.
struct PictureView {
  PictureSize size;
  std::string camera = "cell", theme = "light";
  std::string show, hide;  ///< parts of the drawing, separated by commas
};

/// A page with a recording in it, in a browser, as it is drawn for pictures.
class Studio {
 public:
  /// `page`: HTML; `time`: s, of the first instant. Throws BrowserError where it does not draw within a minute, and
  /// InputError where there is no browser.
  Studio(std::string_view page, const PictureView& view, double time);
  void show(double time);
  /// PNG.
  [[nodiscard]] std::string take_picture() { return browser_.take_picture(); }

 private:
  void wait_until_drawn();

  TemporaryFolder folder_{"snug-picture"};
  Browser browser_;
};

/// Of a video.
struct VideoTimes {
  std::optional<double> from = {}, to = {};  ///< s; absent: first and last frame
  double fps = 25.0;                         ///< pictures a second
  double speed = 1.0;                        ///< recorded seconds a second
};
/// Instants of its pictures, within the times of a recording (not empty). Throws InputError where there are none or too
/// many.
[[nodiscard]] std::vector<double> video_instants(const std::vector<double>& recorded, const VideoTimes& video);

/// A folder for the pictures of a video: empty, and kept from a second one as long as this lives.
class VideoFolder {
 public:
  /// Throws InputError for a folder with something in it, and one that another run is writing to.
  explicit VideoFolder(const std::filesystem::path& path);
  /// Writes frame-000000.png and so on; `tell` is told of each. Throws BrowserError where `is_interrupted`.
  void draw(Studio& studio, const std::vector<double>& instants, const std::function<bool()>& is_interrupted,
            const std::function<void(std::size_t done)>& tell) const;

 private:
  std::filesystem::path path_;
  Descriptor lock_;
};

}  // namespace snug::replay
