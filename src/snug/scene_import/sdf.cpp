// read_sdf: bodies of a world, or of a model, of Gazebo.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/model/mass_properties.hpp"
#include "snug/scene_import/internal/readers.hpp"
#include "snug/scene_import/internal/sdf.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr int kDeepestModel = 50;
constexpr double kWaterDensity = 1000.0;  // kg/m^3, SDF's default
/// Elements that say nothing of bodies, in every world.
const std::set<std::string> kScenery = {"scene", "gui",  "magnetic_field", "spherical_coordinates",
                                        "light", "road", "audio"};
/// Elements of models and links that are read elsewhere, or say nothing here.
const std::set<std::string> kRead = {"pose",
                                     "static",
                                     "inertial",
                                     "collision",
                                     "visual",
                                     "self_collide",
                                     "light",
                                     "allow_auto_disable",
                                     "placement_frame",
                                     "name",
                                     "uri",
                                     "must_be_base_link"};

/// Where names of a model are looked for.
struct Scope {
  std::string prefix;       ///< of names; empty: the world
  std::string model_frame;  ///< what poses are relative to when they do not say it
  bool is_static = false;
  int depth = 0;

  [[nodiscard]] std::string key(const std::string& name) const {
    if (name == "__model__") return model_frame;
    if (name == "world") return "";
    constexpr std::string_view kItself = "::__model__";
    if (name.ends_with(kItself)) return key(name.substr(0, name.size() - kItself.size()));
    return prefix.empty() ? name : prefix + "::" + name;
  }
};

struct SdfLink {
  std::string key;
  Scope scope;
  Node node;
};
struct SdfJoint {
  std::string parent, child, type;
  Node node;
};

class SdfReader {
 public:
  SdfReader(const Node& root, XmlFiles& files) : root_(root), files_(files) {}

  RawScene read() {
    scene_.combination = Combination::Smaller;
    scene_.time_step = 0.001;
    const std::optional<Node> world = root_.child("world");
    const Node& top = world ? *world : root_;
    scene_.name = top.attribute("name", "scene");
    for (const Node& child : top.children()) read_world_child(child);
    for (const Node& child : root_.children())
      if (world && child.element() != world->element())
        remark(child, child.tag() + " beside the first world: left out");
    make_bodies();
    return std::move(scene_);
  }

 private:
  void remark(const Node& node, const std::string& what) {
    scene_.remarks.add(node.file().name, node.line(), printable(what, 200));
  }
  void leave_out(const Node& node) { remark(node, node.tag() + ": left out"); }
  void count(const Node& node) {
    if (++things_ > kMostThings) node.fail(fmt::format("more than {} elements", kMostThings), "fewer");
  }

  void read_world_child(const Node& node) {
    const std::string tag = node.tag();
    if (tag == "gravity") {
      scene_.gravity = node.vector(node.text(), "gravity");
    } else if (tag == "physics") {
      if (const std::string step = node.child_text("max_step_size"); !step.empty())
        scene_.time_step = node.number(step, "max_step_size");
    } else {
      read_part(node, Scope{});
    }
  }

  /// Whatever may stand in a world and in a model.
  void read_part(const Node& node, const Scope& scope) {
    count(node);
    const std::string tag = node.tag();
    if (tag == "model") {
      read_model(node, node, scope);
    } else if (tag == "include") {
      read_include(node, scope);
    } else if (tag == "link") {
      read_link(node, scope);
    } else if (tag == "joint") {
      read_joint(node, scope);
    } else if (tag == "frame") {
      const std::string attached = node.attribute("attached_to", scope.prefix.empty() ? "world" : "__model__");
      add_frame(node, scope, scope.key(node.attribute("name")), scope.key(attached));
      attached_[scope.key(node.attribute("name"))] = scope.key(attached);
    } else if (tag == "enable_wind" || tag == "wind") {
      if (tag == "wind" && node.children().empty()) return;
      if (tag == "wind" || (node.text() != "false" && node.text() != "0")) leave_out(node);
    } else if (!kScenery.contains(tag) && !kRead.contains(tag)) {
      leave_out(node);
    }
  }

  void add_frame(const Node& node, const Scope& scope, const std::string& key, const std::string& otherwise) {
    const SdfPose pose = read_sdf_pose(node);
    frames_.add(key, pose.X, pose.relative_to ? scope.key(*pose.relative_to) : otherwise, node);
  }

  /// `outer`: the element that may say name, pose, static and placement_frame in the model's stead (<include>).
  void read_model(const Node& node, const Node& outer, const Scope& scope) {
    if (scope.depth > kDeepestModel) node.fail("models more than 50 deep", "fewer, and none that includes itself");
    const bool is_include = outer.element() != node.element();
    const std::string name = is_include ? outer.child_text("name", node.attribute("name")) : node.attribute("name");
    if (name.empty()) node.fail("no name", "a name");
    const bool merges = is_include && outer.has("merge") && outer.yes_or_no(outer.attribute("merge"), "merge");
    const std::string key = scope.key(merges ? "_merged__" + name + "__model__" : name);
    Scope inner{merges ? scope.prefix : key, key, scope.is_static, scope.depth + 1};
    for (const Node* from : {&node, &outer})
      if (const std::string text = from->child_text("static"); !text.empty())
        inner.is_static = inner.is_static || from->yes_or_no(text, "static");
    std::string placement = node.attribute("placement_frame");
    if (is_include && outer.child("placement_frame")) placement = outer.child_text("placement_frame");
    const SdfPose pose = read_sdf_pose(is_include && outer.child("pose") ? outer : node);
    frames_.add(key, pose.X, pose.relative_to ? scope.key(*pose.relative_to) : scope.model_frame, node,
                placement.empty() ? "" : inner.key(placement));
    const std::size_t before = links_.size();
    for (const Node& child : node.children()) read_part(child, inner);
    const std::string canonical = node.attribute("canonical_link");
    if (!canonical.empty())
      attached_[key] = inner.key(canonical);
    else if (links_.size() > before)
      attached_[key] = links_[before].key;
  }

  void read_include(const Node& node, const Scope& scope) {
    const std::string uri = node.child_text("uri");
    const auto path = find_uri(uri, node.file().folder);
    if (!path) {
      lacks_models_ = true;
      const bool is_remote = uri.find("://") != std::string::npos && !uri.starts_with("model://") &&
                             !uri.starts_with("package://") && !uri.starts_with("file://");
      remark(node, "include '" + uri +
                       (is_remote ? "', which would have to be downloaded: left out"
                                  : "', found neither beside the scene nor above it: left out"));
      return;
    }
    const std::filesystem::path file = model_file(*path);
    std::error_code error;
    const std::string whole = std::filesystem::weakly_canonical(file, error).string();
    const auto known = included_.find(whole);
    const XmlFile& xml = known != included_.end() ? *known->second : files_.load(file);
    included_[whole] = &xml;
    const Node root = XmlFiles::root_of(xml);
    const std::optional<Node> model =
        root.tag() == "sdf" || root.tag() == "gazebo" ? root.child("model") : std::nullopt;
    if (!model) {
      lacks_models_ = true;
      remark(node, "include '" + uri + "', a file without a model in SDF: left out");
      return;
    }
    read_model(*model, node, scope);
    for (const Node& child : node.children())
      if (child.tag() == "plugin" || child.tag() == "experimental") leave_out(child);
  }

  /// A folder of a model has the file that its model.config names.
  std::filesystem::path model_file(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) return path;
    if (std::filesystem::is_regular_file(path / "model.config", error)) {
      std::string name;
      for (const Node& child : XmlFiles::root_of(files_.load(path / "model.config")).children())
        if (child.tag() == "sdf" && !child.text().empty()) name = child.text();  // versions rise
      if (!name.empty()) return path / name;
    }
    return path / "model.sdf";
  }

  void read_link(const Node& node, const Scope& scope) {
    const std::string key = scope.key(node.attribute("name"));
    if (node.attribute("name").empty()) node.fail("no name", "a name");
    add_frame(node, scope, key, scope.model_frame);
    links_.push_back({key, scope, node});
    for (const Node& child : node.children()) {
      if (child.tag() == "gravity" || child.tag() == "kinematic") {
        if (child.yes_or_no(child.text(), child.tag()) != (child.tag() == "gravity")) leave_out(child);
      } else if (child.tag() == "enable_wind" || child.tag() == "velocity_decay") {
        if (child.text() != "false" && child.text() != "0" &&
            !(child.tag() == "velocity_decay" && child.children().empty()))
          leave_out(child);
      } else if (!kRead.contains(child.tag())) {
        leave_out(child);
      }
    }
  }

  void read_joint(const Node& node, const Scope& scope) {
    const std::string type = node.attribute("type");
    const std::string parent = node.child_text("parent"), child = node.child_text("child");
    if (parent.empty() || child.empty()) node.fail("no parent or no child", "both");
    add_frame(node, scope, scope.key(node.attribute("name")), scope.key(child));
    attached_[scope.key(node.attribute("name"))] = scope.key(child);
    joints_.push_back({scope.key(parent), scope.key(child), type, node});
    if (type != "fixed") remark(node, "joint (" + printable(type, 20) + "): held where it is");
    for (const Node& one : node.children())
      if (one.tag() == "sensor" || one.tag() == "plugin") leave_out(one);
  }

  /// The link that a name stands for, by its place; the number of links for the world; nothing for one that may be of
  /// a model that was left out.
  [[nodiscard]] std::optional<std::size_t> link_of(std::string key, const Node& node) const {
    for (std::size_t steps = 0; steps <= attached_.size(); ++steps) {
      if (key.empty()) return links_.size();
      const auto found =
          std::find_if(links_.begin(), links_.end(), [&](const SdfLink& link) { return link.key == key; });
      if (found != links_.end()) return static_cast<std::size_t>(found - links_.begin());
      const auto next = attached_.find(key);
      if (next == attached_.end()) break;
      key = next->second;
    }
    if (lacks_models_) return std::nullopt;
    std::vector<std::string> names;
    for (const SdfLink& link : links_) names.push_back(link.key);
    const std::string_view nearest = find_nearest(key, names);
    node.fail("'" + key + "', which is no link", nearest.empty() ? "a link" : "'" + std::string(nearest) + "'");
  }

  void make_bodies() {
    std::vector<std::size_t> leader(links_.size() + 1);
    std::iota(leader.begin(), leader.end(), 0U);
    const auto lead = [&](std::size_t i) {
      while (leader[i] != i) i = leader[i];
      return i;
    };
    const std::size_t world = links_.size();
    const auto join = [&](std::size_t a, std::size_t b) {
      const std::size_t one = lead(a), other = lead(b);
      // The world leads what it holds; else the first link does.
      if (one == lead(world) || (other != lead(world) && one < other))
        leader[other] = one;
      else
        leader[one] = other;
    };
    for (std::size_t i = 0; i < links_.size(); ++i)
      if (links_[i].scope.is_static) join(world, i);
    for (const SdfJoint& joint : joints_) {
      const auto parent = link_of(joint.parent, joint.node), child = link_of(joint.child, joint.node);
      if (parent && child)
        join(*parent, *child);
      else
        remark(joint.node, "joint to a link of a model that was left out: left out");
    }
    std::map<std::size_t, std::size_t> bodies;  // of leaders
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const SdfLink& link = links_[i];
      const bool is_static = lead(i) == lead(world);
      const Pose X_WL = frames_.in_world(link.key, link.node);
      const auto known = is_static ? bodies.end() : bodies.find(lead(i));
      const std::size_t at = known == bodies.end() ? scene_.bodies.size() : known->second;
      if (known == bodies.end()) {
        RawBody body;
        body.name = name_of(link);
        body.is_static = is_static;
        body.X_WB = X_WL;
        body.file = link.node.file().name;
        body.line = link.node.line();
        scene_.bodies.push_back(std::move(body));
        if (!is_static) bodies[lead(i)] = at;
      }
      add_link(link, X_WL, scene_.bodies[at]);
    }
  }

  /// "crate" of a model with one link, else "crate/lid".
  [[nodiscard]] std::string name_of(const SdfLink& link) const {
    const auto same = std::count_if(links_.begin(), links_.end(),
                                    [&](const SdfLink& one) { return one.scope.prefix == link.scope.prefix; });
    std::string name = same == 1 && !link.scope.prefix.empty() ? link.scope.prefix : link.key;
    for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::")) name.replace(at, 2, "/");
    return name;
  }

  void add_link(const SdfLink& link, const Pose& X_WL, RawBody& body) {
    const Pose X_BL = body.X_WB.inverse() * X_WL;
    const auto given = body.is_static ? std::optional(SpatialInertia{}) : read_sdf_inertial(link.node, scene_.remarks);
    std::vector<SpatialInertia> parts;
    for (const Node& collision : link.node.children()) {
      if (collision.tag() != "collision") continue;
      count(collision);
      const std::optional<SdfShape> shape = read_sdf_geometry(collision, scene_.remarks);
      if (!shape) continue;
      if (shape->is_plane && !body.is_static) collision.fail("a plane of a body that moves", "planes of static models");
      const SdfPose pose = read_sdf_pose(collision);
      const Pose X_LC = pose.relative_to
                            ? X_WL.inverse() * frames_.in_world(link.scope.key(*pose.relative_to), collision) * pose.X
                            : pose.X;
      const Pose X_BG = X_BL * X_LC * shape->X_CG;
      body.shapes.push_back({{shape->solid.shape, X_BG}, read_sdf_surface(collision, scene_.remarks)});
      if (!given) parts.push_back(moved(scaled(shape->solid.unit, density_of(collision, link.node)), X_BG));
    }
    if (body.is_static) return;
    body.inertia = model::sum_inertias({body.inertia, given ? moved(*given, X_BL) : model::sum_inertias(parts)});
  }

  [[nodiscard]] static double density_of(const Node& collision, const Node& link) {
    std::string text = collision.child_text("density");
    const std::optional<Node> inertial = link.child("inertial");
    if (text.empty() && inertial) text = inertial->child_text("density");
    const double density = text.empty() ? kWaterDensity : collision.number(text, "density");
    if (!(density > 0.0)) collision.fail("density " + text, "kg/m^3, > 0");
    return density;
  }

  Node root_;
  XmlFiles& files_;
  RawScene scene_;
  SdfFrames frames_;
  std::vector<SdfLink> links_;
  std::vector<SdfJoint> joints_;
  std::map<std::string, std::string> attached_;
  std::map<std::string, const XmlFile*> included_;
  std::size_t things_ = 0;
  bool lacks_models_ = false;  ///< some were left out
};

}  // namespace

RawScene read_sdf(const Node& root, XmlFiles& files) { return SdfReader(root, files).read(); }

}  // namespace snug::scene_import::internal
