// Places of a cell as text: JSON for programs, a table for people.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "snug/model/pose_edit.hpp"
#include "snug/runs/cell_place.hpp"

namespace snug::runs {
namespace {

using PlaceJson = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;

PlaceJson placed_json(const Pose& X_W) {
  return {{"position", {X_W.p.x(), X_W.p.y(), X_W.p.z()}}, {"yaw_deg", model::yaw_about_vertical(X_W.R) / kDegree}};
}

PlaceJson place_json(const PlacedCell& place) {
  return {{"robot", placed_json(place.X_WB)},
          {"aligner", placed_json(place.X_WA)},
          {"start", placed_json(place.X_WE_start)},
          {"posture", place.posture},
          {"reached", place.reached},
          {"missing", place.missing},
          {"margin", place.margin},
          {"travel", place.travel}};
}

std::string describe(const Pose& X_W) {
  return fmt::format("{:>6.3f} {:>6.3f} {:>6.3f} {:>7.1f}", X_W.p.x(), X_W.p.y(), X_W.p.z(),
                     model::yaw_about_vertical(X_W.R) / kDegree);
}

std::string row_of(const char* name, const PlacedCell& place, int asked) {
  return fmt::format("{:<8}{}  {}  {:>4} of {:<4} {:>7.0f} {:>7.0f}  {}\n", name, describe(place.X_WB),
                     describe(place.X_WA), place.reached, asked, 1e3 * place.margin, 1e3 * place.travel, place.missing);
}

}  // namespace

std::string format_json(const PlaceSearch& search) {
  PlaceJson json = {{"robot", search.robot},       {"container", search.container},
                    {"asked", search.asked},       {"tried", search.tried},
                    {"reach", search.reach},       {"before", place_json(search.before)},
                    {"places", PlaceJson::array()}};
  for (const PlacedCell& place : search.places) json["places"].push_back(place_json(place));
  return json.dump(-1, ' ', false, PlaceJson::error_handler_t::replace) + "\n";
}

std::string format_table(const PlaceSearch& search) {
  std::string text = fmt::format(
      "{} and {}: {} poses are needed, {} places were weighed; the tool reaches {:.2f} m from the first axis\n\n"
      "        base x      y      z     yaw  aligner x   y      z     yaw  reached       margin  travel  "
      "first that is not\n                            m, degrees                  m, degrees                     mm    "
      "  mm\n",
      search.robot, search.container, search.asked, search.tried, search.reach);
  text += row_of("as it is", search.before, search.asked);
  int number = 0;
  for (const PlacedCell& place : search.places)
    text += row_of(fmt::format("{}", ++number).c_str(), place, search.asked);
  if (search.places.empty()) text += "no place from which the arm reaches pick and container: it is too short\n";
  return text;
}

}  // namespace snug::runs
