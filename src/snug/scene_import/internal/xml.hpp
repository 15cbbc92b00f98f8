// Elements of the files of a scene, with file and line, and the numbers in them.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::scene_import::internal {

inline constexpr std::size_t kLargestScene = std::size_t{16} << 20U;
/// Of bodies, shapes, frames: a scene with more is none that is simulated here.
inline constexpr std::size_t kMostThings = 20'000;

struct XmlFile {
  std::string name;  ///< for messages
  std::filesystem::path folder;
  tinyxml2::XMLDocument document;
};

/// An element, which the file that it is in outlives.
class Node {
 public:
  Node(const tinyxml2::XMLElement* element, const XmlFile* file) : element_(element), file_(file) {}

  [[nodiscard]] std::string tag() const { return element_->Name(); }
  [[nodiscard]] const XmlFile& file() const { return *file_; }
  [[nodiscard]] int line() const { return element_->GetLineNum(); }
  [[nodiscard]] const tinyxml2::XMLElement* element() const { return element_; }
  /// The tag and the name, for people.
  [[nodiscard]] std::string title() const;
  [[noreturn]] void fail(const std::string& got, const std::string& expected) const;

  [[nodiscard]] bool has(const char* key) const { return element_->Attribute(key) != nullptr; }
  /// In UTF-8, or the fallback.
  [[nodiscard]] std::string attribute(const char* key, const std::string& fallback = "") const;
  /// Text within the element, trimmed; empty without.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::vector<Node> children() const;
  /// The first child with this tag.
  [[nodiscard]] std::optional<Node> child(const char* tag) const;
  /// The text of the first child with this tag, or the fallback.
  [[nodiscard]] std::string child_text(const char* tag, const std::string& fallback = "") const;

  /// `least` to `most` finite numbers of a text that stands at `key`.
  [[nodiscard]] std::vector<double> numbers(const std::string& text, const std::string& key, std::size_t least,
                                            std::size_t most) const;
  [[nodiscard]] double number(const std::string& text, const std::string& key) const;
  [[nodiscard]] Vector3 vector(const std::string& text, const std::string& key) const;
  /// A whole number within +-1e6.
  [[nodiscard]] int whole(const std::string& text, const std::string& key) const;
  [[nodiscard]] bool yes_or_no(const std::string& text, const std::string& key) const;

 private:
  const tinyxml2::XMLElement* element_;
  const XmlFile* file_;
};

/// The files of a scene: they live as long as this.
class XmlFiles {
 public:
  /// Throws InputError for what is no XML.
  const XmlFile& parse(const std::string& text, const std::string& name, const std::filesystem::path& folder);
  const XmlFile& load(const std::filesystem::path& path);
  /// The root element. Throws InputError for a file without one.
  [[nodiscard]] static Node root_of(const XmlFile& file);

 private:
  std::vector<std::unique_ptr<XmlFile>> files_;
  std::size_t bytes_ = 0;
};

/// R of three turns by `angles` [rad], one after the other, about the axes that `order` names: "xyz" about the axes as
/// turned, "XYZ" about the fixed ones.
[[nodiscard]] Matrix3 euler_rotation(const Vector3& angles, std::string_view order);
/// Turns z into `direction`, by the shortest arc.
[[nodiscard]] Matrix3 rotation_of_z(const Vector3& direction);
/// About fixed axes: x first, then y, then z.
[[nodiscard]] Matrix3 rpy_rotation(const Vector3& rpy);

}  // namespace snug::scene_import::internal
