// import_scene: which format it is, and what became of the scene.
#include "snug/scene_import/import_scene.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/model/scenario.hpp"
#include "snug/scene_import/internal/readers.hpp"

namespace snug::scene_import {
namespace internal {

void RemarkList::add(const std::string& file, int line, const std::string& what) {
  const auto [found, is_new] = at_.emplace(std::pair(file, what), remarks_.size());
  if (is_new) remarks_.push_back({file, {}, what});
  std::vector<int>& lines = remarks_[found->second].lines;
  if (lines.empty() || lines.back() != line) lines.push_back(line);
}

}  // namespace internal

namespace {

constexpr std::size_t kMostLinesShown = 20;
/// Text and values that a scenario may have (docs/scenario.md).
constexpr std::size_t kLargestScenario = std::size_t{4} << 20U;

Imported finish(internal::RawScene scene, const std::string& name) {
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(), [](const auto& body) { return !body.shapes.empty(); }))
    throw InputError(name, "", "a scene without a body that touches anything", "geoms of bodies, collisions of links");
  Imported imported;
  imported.yaml = internal::format_scenario(scene, std::filesystem::path(name).filename().string());
  imported.remarks = scene.remarks.list();
  for (Remark& remark : imported.remarks) {
    std::sort(remark.lines.begin(), remark.lines.end());
    remark.lines.erase(std::unique(remark.lines.begin(), remark.lines.end()), remark.lines.end());
  }
  for (const internal::RawBody& body : scene.bodies)
    ++(body.is_static ? imported.static_bodies : imported.dynamic_bodies);
  if (imported.yaml.size() > kLargestScenario) {
    imported.refusal = fmt::format("{} MB of text, more than the 4 MB of a scenario", imported.yaml.size() >> 20U);
    return imported;
  }
  try {
    (void)model::parse_scenario(imported.yaml, "scenario");
  } catch (const InputError& error) {
    imported.refusal = error.what();
  }
  return imported;
}

Imported read_root(const internal::Node& root, internal::XmlFiles& files, const std::string& name) {
  if (root.tag() == "mujoco") return finish(internal::read_mjcf(root, files), name);
  if (root.tag() == "sdf" || root.tag() == "gazebo") return finish(internal::read_sdf(root, files), name);
  root.fail("<" + root.tag() + ">",
            root.tag() == "robot" ? "<mujoco> or <sdf>: a URDF is named by a scenario's robot" : "<mujoco> or <sdf>");
}

}  // namespace

std::string to_text(const Remark& remark) {
  std::string lines;
  for (std::size_t i = 0; i < std::min(remark.lines.size(), kMostLinesShown); ++i)
    lines += (i == 0 ? "" : ", ") + std::to_string(remark.lines[i]);
  if (remark.lines.size() > kMostLinesShown) lines += fmt::format(", ... ({} lines)", remark.lines.size());
  return fmt::format("{}:{}: {}", remark.file, lines, printable(remark.what, kLongestMessage / 2));
}

Imported import_scene(const std::filesystem::path& path) {
  internal::XmlFiles files;
  return read_root(internal::XmlFiles::root_of(files.load(path)), files, path.string());
}

Imported parse_scene(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  internal::XmlFiles files;
  return read_root(internal::XmlFiles::root_of(files.parse(text, name, folder)), files, name);
}

}  // namespace snug::scene_import
