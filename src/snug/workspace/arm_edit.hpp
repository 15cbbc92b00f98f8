// ArmEdit: an arm's URDF as a file of the folder, its meshes beside it, and the cell that it is put into.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace snug::workspace {

/// What a form shows of an arm.
struct ArmFacts {
  std::string name;  ///< of the robot, as the file says
  std::vector<std::string>
      links;  ///< that can carry the tool: those behind the most moving joints, the likeliest first
  std::vector<std::string> meshes;  ///< as the file names them
  bool operator==(const ArmFacts&) const = default;
};
/// Throws InputError with file and line for what is no URDF, without looking at anything but the text.
[[nodiscard]] ArmFacts read_arm_facts(const std::string& text, const std::string& name);

/// The text, as it is where it can be, with every mesh named by its file alone, without folder or package: nothing
/// outside the folder is read. `has`: whether a file of that name is in the folder. Throws InputError with what is
/// missing.
[[nodiscard]] std::string take_in_urdf(const std::string& text, const std::string& name,
                                       const std::function<bool(const std::string&)>& has);

/// The cell's text with the arm of `file`, which the text calls `urdf`, its tool carried by the link `tool`; empty: the
/// first of ArmFacts::links. Unless that link is E, the scenario's gripper is mounted on it, as long as it is
/// (`tool_pose`). The arm stands where the one before stood, else on the bench of W; its posture is kept where it has
/// as many joints, else the middle of the joints. Throws InputError where the arm cannot be loaded, or the text cannot
/// take it.
[[nodiscard]] std::string put_arm(const std::string& text, const std::string& name, const std::string& urdf,
                                  const std::string& tool, const std::filesystem::path& file);

/// A block of the top level of YAML, its key and what is indented below, replaced by `block`; at the end where there is
/// none. Throws InputError where the text is no block mapping.
[[nodiscard]] std::string replace_block(const std::string& text, const std::string& name, const std::string& key,
                                        const std::string& block);
/// The lines of a block; empty: there is none.
[[nodiscard]] std::string find_block(const std::string& text, const std::string& key);

}  // namespace snug::workspace
