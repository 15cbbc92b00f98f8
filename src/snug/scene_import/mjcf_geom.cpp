// read_geom: shape, mass and surface of a geom of MJCF.
#include <algorithm>
#include <cmath>
#include <set>

#include "snug/core/text.hpp"
#include "snug/scene_import/internal/mjcf.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr double kWater = 1000.0;  // kg/m^3, MuJoCo's default
/// What is read, said by a remark of its own, or only how it looks.
const std::set<std::string> kGeomAttributes = {
    "name",     "class", "type",     "contype",    "conaffinity", "condim",       "group",  "priority", "size",
    "material", "rgba",  "friction", "mass",       "density",     "shellinertia", "solmix", "solref",   "solimp",
    "margin",   "gap",   "fromto",   "pos",        "quat",        "axisangle",    "xyaxes", "zaxis",    "euler",
    "hfield",   "mesh",  "fitscale", "fluidshape", "fluidcoef",   "user"};

class GeomReader {
 public:
  GeomReader(const Node& node, const Attributes& attributes, const MjcfCompiler& compiler, MjcfMeshes& meshes,
             RemarkList& remarks)
      : node_(node), attributes_(attributes), compiler_(compiler), meshes_(meshes), remarks_(remarks) {}

  std::optional<MjcfGeom> read() {
    MjcfGeom geom{{}, {}, {}, {}, true, true, false};
    if (!read_shape(geom)) return std::nullopt;
    read_mass(geom);
    read_surface(geom.surface);
    const int type = whole("contype", 1), affinity = whole("conaffinity", 1);
    geom.touches = type != 0 || affinity != 0;
    if (geom.touches && ((type & 1) == 0 || (affinity & 1) == 0))
      remark("contype, conaffinity: touches everything here");
    const int group = whole("group", 0);
    for (const auto& [key, value] : attributes_)
      if (!kGeomAttributes.contains(key)) remark(printable(key, 40) + ": left out");
    geom.counts = group >= compiler_.first_group && group <= compiler_.last_group;
    return geom;
  }

 private:
  void remark(const std::string& what) const { remarks_.add(node_.file().name, node_.line(), "geom, " + what); }
  [[nodiscard]] const std::string* find(const char* key) const { return find_attribute(attributes_, key); }
  [[nodiscard]] int whole(const char* key, int fallback) const {
    const std::string* text = find(key);
    return text == nullptr ? fallback : node_.whole(*text, key);
  }

  bool read_shape(MjcfGeom& geom) {
    const std::string type = find("type") != nullptr ? *find("type") : "sphere";
    geom.X_BG = read_pose(node_, attributes_, compiler_);
    if (find("mesh") != nullptr && type != "sdf") {
      if (type != "mesh") remark("type " + printable(type, 20) + " fitted to a mesh: taken as the mesh itself");
      const Solid* solid = meshes_.find(*find("mesh"), node_);
      if (solid == nullptr) {
        remark("of a built-in mesh: left out");
        return false;
      }
      geom.solid = *solid;
      return true;
    }
    if (type == "hfield" || type == "sdf" || type == "mesh") {
      remark(type + ": left out");
      return false;
    }
    const std::string* text = find("size");
    size_ = text == nullptr ? std::vector<double>() : node_.numbers(*text, "size", 0, 3);
    if (find("fromto") != nullptr) read_ends(type, geom.X_BG);
    if (type == "plane") {
      geom.solid = make_plane(size_.empty() ? 0.0 : size_[0], size_.size() < 2 ? 0.0 : size_[1]);
      geom.X_BG.p -= geom.X_BG.R * Vector3(0.0, 0.0, 0.5 * kPlaneThickness);
      geom.is_plane = true;
    } else if (type == "sphere") {
      geom.solid = make_solid(geometry::Capsule{0.0, size(0)});
    } else if (type == "capsule") {
      geom.solid = make_solid(geometry::Capsule{size(1), size(0)});
    } else if (type == "cylinder") {
      geom.solid = make_solid(geometry::Cylinder{size(1), size(0)});
    } else if (type == "box") {
      geom.solid = make_solid(geometry::Box{Vector3(size(0), size(1), size(2))});
    } else if (type == "ellipsoid") {
      geom.solid = make_ellipsoid({size(0), size(1), size(2)});
      remark("ellipsoid: touches with a hull of 64 corners on it");
    } else {
      node_.fail("type \"" + type + "\"", "plane, sphere, capsule, ellipsoid, cylinder, box, mesh, hfield or sdf");
    }
    return true;
  }

  [[nodiscard]] double size(std::size_t k) const {
    if (k >= size_.size()) node_.fail(std::to_string(size_.size()) + " sizes", "as many as the type has");
    if (!(size_[k] > 0.0 && size_[k] <= kLargestSize))
      node_.fail("a size of " + std::to_string(size_[k]), "metres, > 0");
    return size_[k];
  }

  /// fromto: from one end to the other, along z.
  void read_ends(const std::string& type, Pose& X_BG) {
    if (type != "capsule" && type != "cylinder" && type != "box" && type != "ellipsoid")
      node_.fail("fromto of a " + type, "a capsule, cylinder, box or ellipsoid");
    const std::vector<double> v = node_.numbers(*find("fromto"), "fromto", 6, 6);
    const Vector3 from(v[0], v[1], v[2]), to(v[3], v[4], v[5]);
    if (!((to - from).norm() > 1e-9)) node_.fail("ends of fromto at one place", "two places");
    if (size_.empty()) node_.fail("no size", "a radius");
    // MuJoCo's z points from the second end to the first.
    X_BG = {rotation_of_z(from - to), 0.5 * (from + to)};
    const double half = 0.5 * (to - from).norm();
    size_ = type == "box" || type == "ellipsoid" ? std::vector<double>{size_[0], size_[0], half}
                                                 : std::vector<double>{size_[0], half};
  }

  void read_mass(MjcfGeom& geom) const {
    const std::string* mass = find("mass");
    const std::string* density = find("density");
    const double unit = geom.solid.unit.mass;
    double factor = density == nullptr ? kWater : node_.number(*density, "density");
    if (mass != nullptr) {
      const double value = node_.number(*mass, "mass");
      if (value < 0.0) node_.fail("mass \"" + *mass + "\"", "kg, >= 0");
      factor = unit > 0.0 ? value / unit : 0.0;
    }
    if (factor < 0.0) node_.fail("a negative density", "kg/m^3, >= 0");
    if (find("shellinertia") != nullptr && *find("shellinertia") == "true") remark("shellinertia: taken as solid");
    geom.inertia = moved(scaled(geom.solid.unit, factor), geom.X_BG);
  }

  void read_surface(Surface& surface) const {
    surface.dimensions = whole("condim", 3);
    surface.priority = whole("priority", 0);
    if (const std::string* text = find("friction")) {
      const std::vector<double> v = node_.numbers(*text, "friction", 1, 3);
      surface.friction = v[0];
      surface.torsional = v.size() > 1 ? v[1] : 0.005;
      surface.rolling = v.size() > 2 ? v[2] : 0.0001;
      for (const double value : v)
        if (value < 0.0) node_.fail("friction \"" + *text + "\"", "coefficients >= 0");
    } else {
      surface.torsional = 0.005;
      surface.rolling = 0.0001;
    }
    for (const char* key : {"solref", "solimp", "margin", "gap"})
      if (find(key) != nullptr) remark("solref, solimp, margin, gap: left out, contacts are rigid here");
    for (const char* key : {"fluidshape", "fluidcoef"})
      if (find(key) != nullptr) remark(std::string(key) + ": left out");
  }

  const Node& node_;
  const Attributes& attributes_;
  const MjcfCompiler& compiler_;
  MjcfMeshes& meshes_;
  RemarkList& remarks_;
  std::vector<double> size_;
};

}  // namespace

std::optional<MjcfGeom> read_geom(const Node& node, const Attributes& attributes, const MjcfCompiler& compiler,
                                  MjcfMeshes& meshes, RemarkList& remarks) {
  return GeomReader(node, attributes, compiler, meshes, remarks).read();
}

}  // namespace snug::scene_import::internal
