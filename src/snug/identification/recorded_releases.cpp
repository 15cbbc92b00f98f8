// RecordedRelease: from CSV, and when its lip opened.
#include "snug/identification/recorded_releases.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/table.hpp"

namespace snug::identification {
namespace {

constexpr std::size_t kFewestHeights = 20;  // 56 ms at 360 Hz: a release takes 90 to 105 (docs/decisions/0067)
constexpr double kLongestDrop = 0.5;        // m, within the record: a free fall of 0.3 s

void check_recorded_release(const RecordedRelease& release) {
  if (release.times.size() < kFewestHeights)
    throw InputError(release.where, "", std::to_string(release.times.size()) + " samples in this recording",
                     std::to_string(kFewestHeights) + " or more");
  const auto [low, high] = std::ranges::minmax(release.box);
  if (!(high - low < kLongestDrop))
    throw InputError(release.where, "B_z_m", "a box that moves by " + std::to_string(high - low) + " m",
                     "heights in metres, of the tenths of a second after the release");
  if (!(release.gripper.front() > release.box.front()))
    throw InputError(release.where, "E_z_m", "a gripper below the box", "a box that hangs under a vertical cup");
}

/// Where the gap, from its value at the start, first exceeds `level`; the number of samples if it never does.
std::size_t first_gap_above(const std::vector<double>& gap, double level) {
  return static_cast<std::size_t>(std::ranges::find_if(gap, [level](double g) { return g > level; }) - gap.begin());
}

}  // namespace

std::vector<RecordedRelease> parse_recorded_releases(const std::string& text, const std::string& name) {
  const Table table = parse_table(text, name, {"mass_kg", "rep", "t_s", "E_z_m", "B_z_m"}, {"S_z_m"});
  const bool has_lip = table.columns.size() > 5;
  std::vector<RecordedRelease> releases;
  double rep = 0.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::vector<double>& row = table.rows[i];
    for (std::size_t column = 0; column < row.size(); ++column)
      if (!std::isfinite(row[column]))
        throw InputError(table.where(i), table.columns[column], "no finite number", "a finite number");
    if (!(row[0] > 0.0)) throw InputError(table.where(i), "mass_kg", std::to_string(row[0]), "a number above 0");
    if (releases.empty() || releases.back().mass != row[0] || rep != row[1]) {
      if (!releases.empty()) check_recorded_release(releases.back());
      releases.emplace_back();
      releases.back().where = table.where(i);
      releases.back().mass = row[0];
      rep = row[1];
    }
    RecordedRelease& release = releases.back();
    if (!release.times.empty() && !(row[2] > release.times.back()))
      throw InputError(table.where(i), "t_s", std::to_string(row[2]) + " after " + std::to_string(release.times.back()),
                       "time that runs forward within one mass and rep");
    release.times.push_back(row[2]);
    release.gripper.push_back(row[3]);
    release.box.push_back(row[4]);
    if (has_lip) release.lip.push_back(row[5]);
  }
  if (releases.empty()) throw InputError(name, "", "no rows", "one row for each sample of a release");
  check_recorded_release(releases.back());
  return releases;
}

std::vector<RecordedRelease> load_recorded_releases(const std::filesystem::path& path) {
  return parse_recorded_releases(read_file(path, "recorded releases (CSV)"), path.string());
}

double find_recorded_opening(const RecordedRelease& release) {
  constexpr double kLeft = 0.006, kFar = 0.016;  // m: the smoothing of the source has passed, the box is still near
  constexpr double kStretched = 0.015;           // s before the gap grows: the foam's stretch
  if (release.lip.empty()) return -1.0;
  std::vector<double> gap;
  for (std::size_t i = 0; i < release.lip.size(); ++i)
    gap.push_back((release.lip[i] - release.box[i]) - (release.lip[0] - release.box[0]));
  const std::size_t from = first_gap_above(gap, kLeft), to = first_gap_above(gap, kFar);
  if (to >= gap.size() || to < from + 2) return -1.0;
  double t = 0.0, g = 0.0, tt = 0.0, tg = 0.0;
  const double n = static_cast<double>(to - from);
  for (std::size_t i = from; i < to; ++i) t += release.times[i] / n, g += gap[i] / n;
  for (std::size_t i = from; i < to; ++i) {
    tt += (release.times[i] - t) * (release.times[i] - t);
    tg += (release.times[i] - t) * (gap[i] - g);
  }
  const double rate = tg / tt, first = t - g / rate;
  double stretch = 0.0, count = 0.0;
  for (std::size_t i = 0; i < gap.size(); ++i) {
    if (release.times[i] < first - kStretched || release.times[i] > first - 0.5 * kStretched) continue;
    stretch += gap[i];
    count += 1.0;
  }
  return count > 0.0 ? t - (g - stretch / count) / rate : first;
}

}  // namespace snug::identification
