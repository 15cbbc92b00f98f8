// Releases from JSON and CSV, and back to JSON.
#include "snug/identification/releases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/identification/internal/json_file.hpp"
#include "snug/identification/internal/measured_table.hpp"

namespace snug::identification {
namespace {

using internal::JsonValue;
using nlohmann::ordered_json;

constexpr std::size_t kFewestSamples = 20;  // 120 numbers against 12 of the start and 4 of damping

/// What every release must be, whatever it was read from; `where` tells the place of a sample.
template <class Where>
void check(const Release& release, const std::string& file, const Where& where) {
  if (release.times.size() < kFewestSamples)
    throw InputError(file, "", std::to_string(release.times.size()) + " samples",
                     std::to_string(kFewestSamples) + " or more");
  for (std::size_t i = 1; i < release.times.size(); ++i) {
    if (release.times[i] > release.times[i - 1]) continue;
    throw InputError(where(i), "t", std::to_string(release.times[i]) + " after " + std::to_string(release.times[i - 1]),
                     "time that runs forward");
  }
  for (std::size_t i = 0; i < release.X_ES.size(); ++i) {
    const Pose H = release.frames.X_ES2.inverse() * release.X_ES[i] * release.frames.X_SS1;
    if (!(H.p.norm() < 0.1))
      throw InputError(
          where(i), "",
          "a lip " + std::to_string(std::lround(1e3 * H.p.norm())) + " mm from where it rests without load",
          "metres, less than 0.1; do the cup's lengths belong to this file?");
  }
  const Matrix3& inertia = release.load_S.inertia;
  if (!(inertia.determinant() > 0.0 && inertia(0, 0) > 0.0 && inertia.topLeftCorner<2, 2>().determinant() > 0.0))
    throw InputError(file, "inertia", "a matrix that is not positive definite", "kg m^2 about the centre of mass");
}

void read_noise(const JsonValue& root, Release& release) {
  const char* key = root.has("noise") ? "noise" : "meas_noise";
  release.noise_is_given = root.has(key);
  if (!release.noise_is_given) return;
  const JsonValue noise = root.at(key);
  release.noise.position = noise.at("pos_m").not_negative();
  release.noise.rotation = noise.has("rot_rad") ? noise.at("rot_rad").not_negative()
                                                : noise.at("rot_deg").not_negative() * std::numbers::pi / 180.0;
}

Release read_case(const JsonValue& root, const JsonValue& entry, const std::string& name, const model::CupParams& cup) {
  entry.check_keys({"id",          "box",         "mass",     "Ic_S_axes", "com_S",        "K",          "D_S",
                    "D_at_S1",     "E_H_S2_o",    "S_H_S1_o", "W_R_E",     "W_q_E",        "dt",         "t0",
                    "t",           "E_o_S",       "E_q_S",    "twist_S",   "energy",       "E_o_S_meas", "E_q_S_meas",
                    "E_o_S_start", "E_q_S_start", "E_o_Seq",  "E_q_Seq",   "modes_hz_zeta"});
  Release release;
  release.name = name + (entry.has("id") ? " case " + entry.at("id").text() : "");
  release.load_S = {entry.at("mass").positive(), entry.at("com_S").vector3(), entry.at("Ic_S_axes").symmetric3()};
  release.R_WE = entry.has("W_q_E") ? entry.at("W_q_E").quaternion() : entry.at("W_R_E").rotation();
  release.frames = frames_of(cup);
  if (entry.has("E_H_S2_o")) release.frames.X_ES2.p = entry.at("E_H_S2_o").vector3();
  if (entry.has("S_H_S1_o")) release.frames.X_SS1.p = entry.at("S_H_S1_o").vector3();
  if (entry.has("K")) release.K = entry.at("K").symmetric6();
  if (root.has("gravity")) release.gravity_W.z() = -root.at("gravity").positive();
  read_noise(root, release);
  const bool is_measured = entry.has("E_o_S_meas");
  const std::vector<JsonValue> places = entry.at(is_measured ? "E_o_S_meas" : "E_o_S").entries();
  const JsonValue turn_list = entry.at(is_measured ? "E_q_S_meas" : "E_q_S");
  const std::vector<JsonValue> turns = turn_list.entries();
  if (turns.size() != places.size())
    turn_list.fail(std::to_string(turns.size()) + " rotations", std::to_string(places.size()) + ", one for each place");
  for (std::size_t i = 0; i < places.size(); ++i) release.X_ES.push_back({turns[i].quaternion(), places[i].vector3()});
  // A virtual record tells its exact poses too: the first is where the load was held.
  const char* start = entry.has("E_o_S_start") ? "_start" : is_measured && entry.has("E_o_S") ? "" : nullptr;
  if (start != nullptr) {
    const JsonValue place = entry.at(std::string("E_o_S") + start), turn = entry.at(std::string("E_q_S") + start);
    const bool is_list = *start == 0;
    release.X_ES_start = is_list ? Pose{turn.entries().front().quaternion(), place.entries().front().vector3()}
                                 : Pose{turn.quaternion(), place.vector3()};
  }
  if (entry.has("t")) {
    const JsonValue list = entry.at("t");
    for (const JsonValue& time : list.entries()) release.times.push_back(time.number());
    if (release.times.size() != places.size())
      list.fail(std::to_string(release.times.size()) + " times",
                std::to_string(places.size()) + ", one for each place");
  } else {
    const double dt = entry.at("dt").positive(), t0 = entry.has("t0") ? entry.at("t0").number() : 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) release.times.push_back(t0 + dt * static_cast<double>(i));
  }
  check(release, entry.where(), [&](std::size_t i) { return entry.where() + " sample " + std::to_string(i); });
  return release;
}

/// Columns that tell what hangs and how: the same in every row.
void require_constant(const Table& table, std::size_t first) {
  for (std::size_t row = 1; row < table.rows.size(); ++row) {
    for (std::size_t column = first; column < table.columns.size(); ++column) {
      if (table.rows[row][column] == table.rows[0][column]) continue;
      throw InputError(table.where(row), table.columns[column], "another value than in the first row",
                       "one payload and one orientation of the gripper for each file");
    }
  }
}

template <class Vector>
ordered_json list_of(const Vector& v) {
  ordered_json list = ordered_json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) list.push_back(v[i]);
  return list;
}

template <class Matrix>
ordered_json rows_of(const Matrix& A) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index i = 0; i < A.rows(); ++i) rows.push_back(list_of(A.row(i)));
  return rows;
}

}  // namespace

std::vector<Release> parse_releases_json(std::string_view text, const std::string& name, const model::CupParams& cup) {
  const nlohmann::json document = internal::parse_json(text, name);
  const JsonValue root(document, name);
  root.check_keys({"gravity", "noise", "meas_noise", "cases", "D_true"});
  std::vector<Release> releases;
  for (const JsonValue& entry : root.at("cases").entries()) releases.push_back(read_case(root, entry, name, cup));
  return releases;
}

std::vector<Release> parse_releases_csv(const std::string& text, const std::string& name, const model::CupParams& cup) {
  const Table table =
      parse_table(text, name, {"t",    "x",     "y",          "z",          "qw",         "qx",        "qy",  "qz",
                               "mass", "com_x", "com_y",      "com_z",      "ixx",        "iyy",       "izz", "ixy",
                               "ixz",  "iyz",   "gripper_qw", "gripper_qx", "gripper_qy", "gripper_qz"});
  constexpr std::size_t kLoad = 8, kInertia = 12, kGripper = 18;
  if (table.rows.empty()) throw InputError(name, "", "no rows", "one row for each sample");
  require_constant(table, kLoad);
  Release release;
  release.name = name;
  release.frames = frames_of(cup);
  const std::vector<double>& first = table.rows.front();
  if (!(first[kLoad] > 0.0)) throw InputError(table.where(0), "mass", std::to_string(first[kLoad]), "a number above 0");
  const double* I = first.data() + kInertia;
  release.load_S = {first[kLoad], internal::vector_at(table, 0, kLoad + 1),
                    (Matrix3() << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]).finished()};
  release.R_WE = internal::rotation_at(table, 0, kGripper);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    release.times.push_back(table.rows[row][0]);
    release.X_ES.push_back({internal::rotation_at(table, row, 4), internal::vector_at(table, row, 1)});
  }
  check(release, name, [&](std::size_t i) { return table.where(i); });
  return {release};
}

std::vector<Release> load_releases(const std::filesystem::path& path, const model::CupParams& cup) {
  const std::string text = read_file(path, "measurements (JSON or CSV)");
  if (path.extension() == ".json") return parse_releases_json(text, path.string(), cup);
  if (path.extension() == ".csv") return parse_releases_csv(text, path.string(), cup);
  throw InputError(path.string(), "", "a name that ends in '" + path.extension().string() + "'", ".json or .csv");
}

std::string format_releases(const std::vector<Release>& releases) {
  ordered_json document;
  document["gravity"] = -releases.front().gravity_W.z();
  document["noise"] = {{"pos_m", releases.front().noise.position}, {"rot_rad", releases.front().noise.rotation}};
  for (std::size_t k = 0; k < releases.size(); ++k) {
    const Release& release = releases[k];
    ordered_json entry;
    entry["id"] = k;
    entry["mass"] = release.load_S.mass;
    entry["com_S"] = list_of(release.load_S.com);
    entry["Ic_S_axes"] = rows_of(release.load_S.inertia);
    entry["W_R_E"] = rows_of(release.R_WE);
    entry["E_H_S2_o"] = list_of(release.frames.X_ES2.p);
    entry["S_H_S1_o"] = list_of(release.frames.X_SS1.p);
    if (release.K) entry["K"] = rows_of(*release.K);
    entry["t"] = release.times;
    entry["E_o_S"] = ordered_json::array();
    entry["E_q_S"] = ordered_json::array();
    for (const Pose& X_ES : release.X_ES) {
      const Quaternion quat(X_ES.R);
      entry["E_o_S"].push_back(list_of(X_ES.p));
      entry["E_q_S"].push_back({quat.w(), quat.x(), quat.y(), quat.z()});
    }
    document["cases"].push_back(entry);
  }
  return document.dump() + "\n";
}

}  // namespace snug::identification
