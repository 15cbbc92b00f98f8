// read_mjcf: bodies of a scene of MuJoCo.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/model/mass_properties.hpp"
#include "snug/scene_import/internal/mjcf.hpp"
#include "snug/scene_import/internal/readers.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr int kDeepestBody = 200;
const std::set<std::string> kBodyAttributes = {"name",   "childclass", "mocap", "pos",      "quat", "axisangle",
                                               "xyaxes", "zaxis",      "euler", "gravcomp", "user", "sleep"};
/// Elements that say how things look, and memory: of no weight here, and in every scene.
const std::set<std::string> kLooks = {"visual", "statistic", "size", "custom"};

class MjcfReader {
 public:
  MjcfReader(const Node& root, XmlFiles& files) : root_(root), files_(files) {}

  RawScene read() {
    scene_.name = root_.attribute("model", "scene");
    const std::vector<Node> sections = expanded(root_);
    for (const Node& section : sections) {
      if (section.tag() == "compiler") read_compiler(section);
      if (section.tag() == "option") read_option(section);
      if (section.tag() == "default") defaults_.read(section);
    }
    for (const Node& section : sections) {
      if (section.tag() != "asset") continue;
      for (const Node& asset : expanded(section)) {
        if (asset.tag() == "mesh") meshes_.read(asset, compiler_, defaults_, scene_.remarks);
        if (asset.tag() == "hfield" || asset.tag() == "model" || asset.tag() == "skin") leave_out(asset);
      }
    }
    for (const Node& section : sections) {
      const std::string tag = section.tag();
      if (tag == "worldbody") {
        read_children(section, Place{world(section), Pose{}, Pose{}, section.attribute("childclass"), "", 0}, nullptr);
      } else if (tag == "deformable" || tag == "contact" || tag == "equality" || tag == "tendon" || tag == "actuator" ||
                 tag == "sensor" || tag == "keyframe" || tag == "extension") {
        for (const Node& one : expanded(section)) leave_out(one);
      } else if (tag != "compiler" && tag != "option" && tag != "default" && tag != "asset" && !kLooks.contains(tag)) {
        leave_out(section);
      }
    }
    scale_masses();
    return std::move(scene_);
  }

 private:
  /// Where elements are read: whose they are, and their frame in it.
  struct Place {
    std::size_t owner;  ///< body of the scene
    Pose X_OB;          ///< the MJCF body in the owner
    Pose X_BF;          ///< <frame> in the MJCF body
    std::string child_class;
    std::string suffix;  ///< of names, in <replicate>
    int depth;
  };
  /// What a MJCF body says of its inertia, in the frame of the owner.
  struct BodyParts {
    std::vector<SpatialInertia> geoms;
    std::optional<SpatialInertia> inertial;
  };

  void leave_out(const Node& node) { scene_.remarks.add(node.file().name, node.line(), node.tag() + ": left out"); }
  void remark(const Node& node, const std::string& what) { scene_.remarks.add(node.file().name, node.line(), what); }

  /// Children, with those of included files in place of <include>. MuJoCo takes each file once.
  std::vector<Node> expanded(const Node& node, int depth = 0) {
    std::vector<Node> all;
    for (const Node& child : node.children()) {
      if (child.tag() != "include") {
        all.push_back(child);
        continue;
      }
      if (++things_ > kMostThings) child.fail("too many elements", "fewer");
      const std::string name = child.attribute("file");
      if (name.empty()) child.fail("no file", "the file to include");
      std::filesystem::path path = root_.file().folder / name;
      std::error_code error;
      if (!std::filesystem::exists(path, error)) path = child.file().folder / name;
      if (!std::filesystem::exists(path, error))
        child.fail("file \"" + name + "\", which is not there", "a file beside the scene");
      const auto [known, is_new] = included_.emplace(std::filesystem::weakly_canonical(path, error).string(), nullptr);
      // The sections of a file are asked for several times: for the compiler, for the world.
      if (is_new) {
        known->second = &files_.load(path);
        includer_[known->first] = child.element();
      } else if (includer_[known->first] != child.element()) {
        child.fail("file \"" + name + "\" a second time", "each file once, as MuJoCo has it");
      }
      if (depth > kDeepestBody) child.fail("files that include each other", "an end");
      for (const Node& one : expanded(XmlFiles::root_of(*known->second), depth + 1)) all.push_back(one);
    }
    return all;
  }

  void read_compiler(const Node& node) {
    const auto text = [&](const char* key) { return node.attribute(key); };
    if (node.has("angle")) {
      if (text("angle") != "degree" && text("angle") != "radian")
        node.fail("angle \"" + text("angle") + "\"", "degree or radian");
      compiler_.uses_degrees = text("angle") == "degree";
    }
    if (node.has("eulerseq")) {
      compiler_.euler_order = text("eulerseq");
      const bool is_order =
          compiler_.euler_order.size() == 3 && compiler_.euler_order.find_first_not_of("xyzXYZ") == std::string::npos;
      if (!is_order) node.fail("eulerseq \"" + compiler_.euler_order + "\"", "three of xyzXYZ");
    }
    if (text("coordinate") == "global") node.fail("coordinate \"global\"", "local: MuJoCo 2.3.3 converts it");
    if (node.has("assetdir")) compiler_.mesh_folder = text("assetdir");
    if (node.has("meshdir")) compiler_.mesh_folder = text("meshdir");
    if (node.has("strippath")) compiler_.strips_paths = node.yes_or_no(text("strippath"), "strippath");
    if (node.has("inertiafromgeom")) {
      compiler_.inertia_from_geoms.reset();
      if (text("inertiafromgeom") != "auto")
        compiler_.inertia_from_geoms = node.yes_or_no(text("inertiafromgeom"), "inertiafromgeom");
    }
    if (node.has("inertiagrouprange")) {
      const std::vector<double> range = node.numbers(text("inertiagrouprange"), "inertiagrouprange", 2, 2);
      compiler_.first_group = static_cast<int>(std::clamp(range[0], 0.0, 5.0));
      compiler_.last_group = static_cast<int>(std::clamp(range[1], 0.0, 5.0));
    }
    if (node.has("boundmass")) compiler_.least_mass = node.number(text("boundmass"), "boundmass");
    if (node.has("boundinertia")) compiler_.least_inertia = node.number(text("boundinertia"), "boundinertia");
    if (node.has("settotalmass")) compiler_.total_mass = node.number(text("settotalmass"), "settotalmass");
    if (node.has("balanceinertia")) compiler_.balances = node.yes_or_no(text("balanceinertia"), "balanceinertia");
  }

  void read_option(const Node& node) {
    if (node.has("gravity")) scene_.gravity = node.vector(node.attribute("gravity"), "gravity");
    if (node.has("timestep")) scene_.time_step = node.number(node.attribute("timestep"), "timestep");
    for (const char* key : {"wind", "density", "viscosity", "magnetic"}) {
      if (!node.has(key)) continue;
      const std::vector<double> v = node.numbers(node.attribute(key), key, 1, 3);
      if (std::string_view(key) != "magnetic" && std::any_of(v.begin(), v.end(), [](double x) { return x != 0.0; }))
        remark(node, std::string("option ") + key + ": left out");
    }
    for (const Node& flag : node.children()) {
      if (flag.tag() != "flag") continue;
      for (const char* key : {"contact", "gravity", "constraint"}) {
        if (flag.attribute(key) != "disable") continue;
        if (std::string_view(key) == "gravity") scene_.gravity = Vector3::Zero();
        if (std::string_view(key) != "gravity") remark(flag, std::string("flag ") + key + "=\"disable\": left out");
      }
    }
  }

  std::size_t world(const Node& node) {
    RawBody body;
    body.name = "world";
    body.is_static = true;
    body.file = node.file().name;
    body.line = node.line();
    scene_.bodies.push_back(body);
    return scene_.bodies.size() - 1;
  }

  void count(const Node& node) {
    if (++things_ > kMostThings) node.fail(fmt::format("more than {} bodies and shapes", kMostThings), "fewer");
  }

  void read_children(const Node& node, const Place& place, BodyParts* parts) {
    if (place.depth > kDeepestBody) node.fail("bodies more than 200 deep", "fewer");
    for (const Node& child : expanded(node)) {
      count(child);
      const std::string tag = child.tag();
      if (tag == "geom") {
        read_one_geom(child, place, parts);
      } else if (tag == "body") {
        read_body(child, place);
      } else if (tag == "frame") {
        Place inner = deeper(child, place);
        inner.X_BF = place.X_BF * read_pose(child, own_attributes(child), compiler_);
        read_children(child, inner, parts);
      } else if (tag == "replicate") {
        replicate(child, place, parts);
      } else if (tag == "inertial") {
        if (parts != nullptr) parts->inertial = read_inertial(child, place.X_OB * place.X_BF);
      } else if (tag == "joint") {
        const std::string type = child.attribute("type", "hinge");
        if (type != "free") remark(child, "joint (" + printable(type, 20) + "): held where it is");
      } else if (tag != "freejoint" && tag != "site" && tag != "light" && tag != "camera") {
        leave_out(child);
      }
    }
  }

  static Attributes own_attributes(const Node& node) {
    Attributes attributes;
    for (const auto* one = node.element()->FirstAttribute(); one != nullptr; one = one->Next())
      attributes[one->Name()] = node.attribute(one->Name());
    return attributes;
  }

  Place deeper(const Node& node, const Place& place) const {
    Place inner = place;
    ++inner.depth;
    if (!node.has("childclass")) return inner;
    inner.child_class = node.attribute("childclass");
    if (!defaults_.has_class(inner.child_class)) node.fail("childclass '" + inner.child_class + "'", "a default class");
    return inner;
  }

  void replicate(const Node& node, const Place& place, BodyParts* parts) {
    const int copies = node.whole(node.attribute("count"), "count");
    if (copies < 1 || copies > static_cast<int>(kMostThings)) node.fail(fmt::format("count {}", copies), "1 to 20000");
    const Vector3 offset = node.has("offset") ? node.vector(node.attribute("offset"), "offset") : Vector3::Zero();
    Vector3 euler = node.has("euler") ? node.vector(node.attribute("euler"), "euler") : Vector3::Zero();
    for (double& angle : euler) angle = compiler_.radians(angle);
    const Pose step{euler_rotation(euler, compiler_.euler_order), offset};
    const std::size_t digits = std::to_string(copies - 1).size();
    Pose X;
    for (int i = 0; i < copies; ++i) {
      Place inner = deeper(node, place);
      X.R = euler_rotation(i * euler, compiler_.euler_order);
      inner.X_BF = place.X_BF * X;
      inner.suffix = fmt::format("{}{:0{}}", node.attribute("sep"), i, digits) + place.suffix;
      read_children(node, inner, parts);
      X = X * step;
    }
  }

  void read_one_geom(const Node& node, const Place& place, BodyParts* parts) {
    const Attributes attributes = defaults_.attributes_of(node, place.child_class);
    const std::optional<MjcfGeom> geom = read_geom(node, attributes, compiler_, meshes_, scene_.remarks);
    if (!geom) return;
    const Pose X_OF = place.X_OB * place.X_BF;
    RawBody& owner = scene_.bodies[place.owner];
    if (geom->is_plane && !owner.is_static) node.fail("a plane of a body that moves", "planes of the world");
    if (parts != nullptr && geom->counts) parts->geoms.push_back(moved(geom->inertia, X_OF));
    if (geom->touches) owner.shapes.push_back({{geom->solid.shape, X_OF * geom->X_BG}, geom->surface});
  }

  [[nodiscard]] SpatialInertia read_inertial(const Node& node, const Pose& X_OB) const {
    const Pose X_BI = read_pose(node, own_attributes(node), compiler_);
    if (!node.has("mass")) node.fail("no mass", "kg");
    SpatialInertia inertia{node.number(node.attribute("mass"), "mass"), Vector3::Zero(), Matrix3::Zero()};
    if (inertia.mass < 0.0) node.fail("a negative mass", "kg");
    if (node.has("fullinertia")) {
      const std::vector<double> v = node.numbers(node.attribute("fullinertia"), "fullinertia", 6, 6);
      inertia.inertia << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
    } else if (node.has("diaginertia")) {
      inertia.inertia.diagonal() = node.vector(node.attribute("diaginertia"), "diaginertia");
    }
    return moved(inertia, X_OB * X_BI);
  }

  [[nodiscard]] bool is_free(const Node& body) {
    for (const Node& child : expanded(body)) {
      if (child.tag() == "freejoint") return true;
      if (child.tag() == "joint" && child.attribute("type") == "free") return true;
      if (child.tag() == "frame" && is_free(child)) return true;
    }
    return false;
  }

  void read_body(const Node& node, const Place& place) {
    Place inner = deeper(node, place);
    const Pose X_BP = place.X_BF * read_pose(node, own_attributes(node), compiler_);  // in the body around it
    const bool moves_by_itself = is_free(node);
    const bool of_world = scene_.bodies[place.owner].is_static;
    if (moves_by_itself && place.depth > 0 && !of_world)
      node.fail("a free joint inside a body that moves", "one at the top");
    if (node.attribute("mocap") == "true") remark(node, "body, mocap: stands where it is");
    inner.X_BF = {};
    if (of_world) {
      RawBody body;
      body.name = node.attribute("name", "body") + place.suffix;
      body.is_static = !moves_by_itself;
      body.X_WB = scene_.bodies[place.owner].X_WB * place.X_OB * X_BP;
      body.file = node.file().name;
      body.line = node.line();
      scene_.bodies.push_back(body);
      inner.owner = scene_.bodies.size() - 1;
      inner.X_OB = {};
    } else {
      inner.X_OB = place.X_OB * X_BP;
    }
    for (const auto& [key, value] : own_attributes(node))
      if (!kBodyAttributes.contains(key)) remark(node, "body, " + printable(key, 40) + ": left out");
    if (node.has("gravcomp") && node.number(node.attribute("gravcomp"), "gravcomp") != 0.0)
      remark(node, "body, gravcomp: left out");
    BodyParts parts;
    read_children(node, inner, &parts);
    SpatialInertia own = inertia_of(parts, node);
    all_mass_ += own.mass;
    RawBody& owner = scene_.bodies[inner.owner];
    if (!owner.is_static) owner.inertia = model::sum_inertias({owner.inertia, own});
  }

  [[nodiscard]] SpatialInertia inertia_of(const BodyParts& parts, const Node& node) {
    const bool from_geoms = compiler_.inertia_from_geoms.value_or(!parts.inertial.has_value());
    SpatialInertia own = from_geoms ? model::sum_inertias(parts.geoms)
                                    : parts.inertial.value_or(SpatialInertia{0.0, Vector3::Zero(), Matrix3::Zero()});
    own.mass = std::max(own.mass, compiler_.least_mass);
    if (!(compiler_.least_inertia > 0.0) && !compiler_.balances) return own;
    const Eigen::SelfAdjointEigenSolver<Matrix3> solver(own.inertia);
    Vector3 moments = solver.eigenvalues().cwiseMax(compiler_.least_inertia);
    if (compiler_.balances && moments[2] > moments[0] + moments[1]) {
      moments = Vector3::Constant(moments.mean());
      remark(node, "body, inertia: balanced, as balanceinertia asks for");
    }
    own.inertia = solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
    return own;
  }

  void scale_masses() {
    if (!(compiler_.total_mass > 0.0) || !(all_mass_ > 0.0)) return;
    for (RawBody& body : scene_.bodies) body.inertia = scaled(body.inertia, compiler_.total_mass / all_mass_);
  }

  Node root_;
  XmlFiles& files_;
  RawScene scene_;
  MjcfCompiler compiler_;
  MjcfDefaults defaults_;
  MjcfMeshes meshes_;
  std::map<std::string, const XmlFile*> included_;
  std::map<std::string, const tinyxml2::XMLElement*> includer_;
  std::size_t things_ = 0;
  double all_mass_ = 0.0;
};

}  // namespace

RawScene read_mjcf(const Node& root, XmlFiles& files) { return MjcfReader(root, files).read(); }

}  // namespace snug::scene_import::internal
