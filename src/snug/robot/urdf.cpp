// load_urdf: a serial arm from a URDF, strictly, every complaint with file, line and element.
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/robot/internal/inertia.hpp"
#include "snug/robot/internal/urdf.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::robot {
namespace internal {

std::string Element::where() const { return source_->name + ":" + std::to_string(node_->GetLineNum()); }

void Element::fail(const std::string& got, const std::string& expected) const {
  throw InputError(where(), path_, got, expected);
}

std::vector<Element> Element::children(const char* tag) const {
  std::vector<Element> found;
  for (const auto* e = node_->FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag)) {
    const char* name = e->Attribute("name");
    const std::string part = name == nullptr ? std::string(e->Name()) : std::string(e->Name()) + " '" + name + "'";
    found.emplace_back(e, *source_, path_.empty() ? part : path_ + "/" + part);
  }
  return found;
}

std::vector<Element> Element::children() const { return children(nullptr); }

Element Element::child(const char* tag) const {
  const std::vector<Element> found = children(tag);
  if (found.empty()) fail("no <" + std::string(tag) + ">", "one <" + std::string(tag) + ">");
  if (found.size() > 1) found[1].fail("a second <" + std::string(tag) + ">", "one");
  return found.front();
}

void Element::check_tags(const std::vector<std::string>& known) const {
  for (const Element& e : children()) {
    if (std::find(known.begin(), known.end(), e.tag()) != known.end()) continue;
    const std::string_view nearest = find_nearest(e.tag(), known);
    if (!nearest.empty()) e.fail("<" + e.tag() + ">", "<" + std::string(nearest) + ">");
  }
}

std::string Element::text(const char* key) const {
  const char* value = node_->Attribute(key);
  if (value == nullptr || *value == '\0') fail("no attribute '" + std::string(key) + "'", "one");
  const std::string_view what = key;
  const bool is_name = what == "name" || what == "link";
  // &#xd800; and the like are no characters, but the parser takes them.
  if (is_name ? !is_printable(value) : !is_utf8(value))
    fail(std::string(key) + "=\"" + value + "\"", "printable characters");
  return value;
}

std::vector<double> Element::numbers(const char* key, std::size_t count) const {
  const std::string written = text(key);
  const auto refuse = [&] {
    fail(std::string(key) + "=\"" + written + "\"",
         count == 1 ? "a finite number" : std::to_string(count) + " finite numbers");
  };
  std::vector<double> values;
  std::istringstream words(written);
  for (std::string word; words >> word;) {
    double value = 0.0;
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    // Beyond 1e12 nothing of an arm lies; a slip there would lose all digits elsewhere.
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= 1e12)) refuse();
    values.push_back(value);
  }
  if (values.size() != count) refuse();
  return values;
}

double Element::number(const char* key) const { return numbers(key, 1).front(); }

double Element::number_or(const char* key, double fallback) const {
  return has_attribute(key) ? number(key) : fallback;
}

Vector3 Element::vector3_or(const char* key, const Vector3& fallback) const {
  if (!has_attribute(key)) return fallback;
  const std::vector<double> v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

Matrix3 rpy_rotation(const Vector3& rpy) {
  const double sr = std::sin(rpy.x()), cr = std::cos(rpy.x());
  const double sp = std::sin(rpy.y()), cp = std::cos(rpy.y());
  const double sy = std::sin(rpy.z()), cy = std::cos(rpy.z());
  Matrix3 R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

double assumed_speed(const Element& joint) { return joint.text("type") == "prismatic" ? kAssumedSlide : kAssumedSpeed; }

Pose read_origin(const Element& element) {
  const std::vector<Element> origins = element.children("origin");
  if (origins.empty()) return {};
  if (origins.size() > 1) origins[1].fail("a second <origin>", "one");
  return {rpy_rotation(origins[0].vector3_or("rpy", Vector3::Zero())), origins[0].vector3_or("xyz", Vector3::Zero())};
}

namespace {

constexpr std::size_t kMostLinks = 1000;

/// In the elements, not in comments: expanded files tell there what they were made of.
bool has_macros(const tinyxml2::XMLElement& element) {
  if (std::string_view(element.Name()).starts_with("xacro:")) return true;
  for (const auto* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
    if (has_macros(*e)) return true;
  return false;
}

/// A <joint> as written.
struct RawJoint {
  Element element;
  std::string name;
  std::string type;
  std::string parent;
  std::string child;
};

/// Everything of the file by name, before a tree is made of it.
struct RawRobot {
  std::vector<Element> links;
  std::map<std::string, std::size_t> link_index;
  std::vector<RawJoint> joints;
};

/// Mass, centre and inertia of a link in its frame; all zero without <inertial>. The tensor of a link that never moves
/// has no influence: it is not looked at, and zero (public files have many that no body could have).
SpatialInertia read_inertial(const Element& link, bool moves) {
  SpatialInertia result{0.0, Vector3::Zero(), Matrix3::Zero()};
  if (!link.has("inertial")) return result;
  const Element inertial = link.child("inertial");
  inertial.check_tags({"origin", "mass", "inertia"});
  const Pose X_LI = read_origin(inertial);
  const Element mass = inertial.child("mass");
  result.mass = mass.number("value");
  if (!(result.mass >= 0.0)) mass.fail("value=\"" + mass.text("value") + "\"", "a mass in kg >= 0");
  result.com = X_LI.p;
  if (!moves) return result;
  const Element tensor = inertial.child("inertia");
  const double xy = tensor.number_or("ixy", 0.0), xz = tensor.number_or("ixz", 0.0), yz = tensor.number_or("iyz", 0.0);
  const double xx = tensor.number("ixx"), yy = tensor.number("iyy"), zz = tensor.number("izz");
  Matrix3 M_I;
  M_I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const Vector3 moments = symmetric_eigenpairs(M_I).values;
  // The triangle inequality holds for any mass distribution; published tensors are rounded to about 1e-5 kg m^2. A
  // tensor of rank one (bare frames have some) has two moments that are zero but for the rounding of this computation.
  if (moments(0) < -1e-12 * moments(2) || moments(0) + moments(1) < moments(2) * (1.0 - 1e-2) - 2e-5)
    tensor.fail("an inertia that no distribution of mass has",
                "principal moments >= 0, none above the sum of the rest");
  result.inertia = X_LI.R * M_I * X_LI.R.transpose();
  return result;
}

RawRobot read_raw(const Element& robot) {
  robot.check_tags({"link", "joint", "material", "transmission", "gazebo", "ros2_control", "sensor", "mujoco"});
  RawRobot raw;
  for (const Element& link : robot.children("link")) {
    link.check_tags({"inertial", "visual", "collision", "contact", "self_collision_checking", "origin"});
    if (!raw.link_index.emplace(link.text("name"), raw.links.size()).second)
      link.fail("a second link of this name", "each name once");
    raw.links.push_back(link);
  }
  if (raw.links.empty()) robot.fail("no <link>", "at least one");
  if (raw.links.size() > kMostLinks)
    robot.fail(std::to_string(raw.links.size()) + " links", "at most " + std::to_string(kMostLinks));
  std::map<std::string, std::string> parent_joint;
  std::vector<std::string> names;
  for (const auto& [name, index] : raw.link_index) names.push_back(name);
  const std::vector<std::string> types = {"revolute", "continuous", "prismatic", "fixed", "planar", "floating"};
  std::map<std::string, bool> seen;
  for (const Element& joint : robot.children("joint")) {
    joint.check_tags(
        {"origin", "parent", "child", "axis", "limit", "dynamics", "calibration", "mimic", "safety_controller"});
    RawJoint entry{joint, joint.text("name"), joint.text("type"), joint.child("parent").text("link"),
                   joint.child("child").text("link")};
    if (!seen.emplace(entry.name, true).second) joint.fail("a second joint of this name", "each name once");
    if (std::find(types.begin(), types.end(), entry.type) == types.end())
      joint.fail("type=\"" + entry.type + "\"", "revolute, continuous, prismatic or fixed");
    for (const auto& [key, value] :
         {std::pair<const char*, std::string>{"parent", entry.parent}, {"child", entry.child}}) {
      if (raw.link_index.contains(value)) continue;
      const std::string_view nearest = find_nearest(value, names);
      joint.child(key).fail("link '" + value + "', which is not there",
                            nearest.empty() ? "the name of a link" : "'" + std::string(nearest) + "' perhaps");
    }
    if (!parent_joint.emplace(entry.child, entry.name).second)
      joint.fail(
          "link '" + entry.child + "' as child of a second joint ('" + parent_joint[entry.child] + "' is the first)",
          "a tree: every link is the child of one joint at most");
    raw.joints.push_back(entry);
  }
  return raw;
}

/// Unit, in the joint's frame.
Vector3 read_axis(const RawJoint& raw) {
  if (!raw.element.has("axis")) return Vector3::UnitX();  // the default of the format
  const Vector3 axis = raw.element.child("axis").vector3_or("xyz", Vector3::UnitX());
  const double length = axis.norm();
  if (!(length > 1e-6)) raw.element.child("axis").fail("an axis of length 0", "a direction");
  return axis / length;
}

Joint read_moving_joint(const RawJoint& raw) {
  Joint joint;
  joint.name = raw.name;
  joint.kind = raw.type == "prismatic" ? JointKind::Prismatic : JointKind::Revolute;
  joint.axis = read_axis(raw);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (raw.type == "continuous" && !raw.element.has("limit")) {  // find_assumptions says so
    joint.max_speed = assumed_speed(raw.element);
    joint.max_effort = joint.upper = kInfinity;
    joint.lower = -kInfinity;
    return joint;
  }
  const Element limit = raw.element.child("limit");
  joint.max_speed = limit.number("velocity");
  joint.max_effort = limit.number("effort");
  if (!(joint.max_speed >= 0.0 && joint.max_effort >= 0.0))
    limit.fail("velocity " + limit.text("velocity") + ", effort " + limit.text("effort"),
               "velocity and effort >= 0 (0: not known)");
  if (joint.max_effort == 0.0) joint.max_effort = kInfinity;                 // nobody knew it: find_unknown_efforts
  if (joint.max_speed == 0.0) joint.max_speed = assumed_speed(raw.element);  // nor that: find_assumptions
  joint.lower = raw.type == "continuous" ? -kInfinity : limit.number("lower");
  joint.upper = raw.type == "continuous" ? kInfinity : limit.number("upper");
  if (!(joint.lower < joint.upper))
    limit.fail("lower " + limit.text("lower") + ", upper " + limit.text("upper"), "lower < upper");
  return joint;
}

/// Builds the model by walking the tree from its root.
class Assembler {
 public:
  Assembler(const Element& robot, const RawRobot& raw, const std::string& tool_frame)
      : robot_(robot), raw_(raw), tool_frame_(tool_frame) {}

  ArmModel assemble() {
    mark_path_to_tool();
    arm_.segments.assign(1, SpatialInertia{0.0, Vector3::Zero(), Matrix3::Zero()});
    add_link(root(), -1, 0, Pose{});
    sum_segments();
    if (arm_.followers.empty()) arm_.order.clear();
    for (std::size_t k = 0; k < arm_.followers.size(); ++k) join(arm_.followers[k], *raw_followers_[k]);
    return arm_;
  }

 private:
  /// The one link that is nobody's child.
  const std::string& root() const {
    const std::string* found = nullptr;
    for (const Element& link : raw_.links) {
      const auto is_child = [&](const RawJoint& j) { return j.child == link.text("name"); };
      if (std::any_of(raw_.joints.begin(), raw_.joints.end(), is_child)) continue;
      if (found != nullptr)
        link.fail("a second link that is no joint's child ('" + *found + "' is the first)", "one root");
      found = &raw_.link_index.find(link.text("name"))->first;
    }
    if (found == nullptr) robot_.fail("joints that go round in a circle", "a tree with one root link");
    return *found;
  }

  void mark_path_to_tool() {
    if (!raw_.link_index.contains(tool_frame_)) {
      std::vector<std::string> names;
      for (const auto& [name, index] : raw_.link_index) names.push_back(name);
      const std::string_view nearest = find_nearest(tool_frame_, names);
      robot_.fail("no link '" + tool_frame_ + "', which is to be the tool frame",
                  nearest.empty() ? "a link of that name" : "such a link; nearest is '" + std::string(nearest) + "'");
    }
    for (std::string link = tool_frame_;;) {
      on_path_[link] = true;
      const auto up =
          std::find_if(raw_.joints.begin(), raw_.joints.end(), [&](const RawJoint& j) { return j.child == link; });
      if (up == raw_.joints.end()) break;
      if (on_path_.contains(up->parent))
        up->element.fail("joints that go round in a circle", "a tree with one root link");
      link = up->parent;
    }
  }

  void add_link(const std::string& name, int parent, int segment, const Pose& X_SL) {
    const Element& element = raw_.links[raw_.link_index.at(name)];
    Link link;
    link.name = name;
    link.parent = parent;
    link.segment = segment;
    link.X_SL = X_SL;
    link.inertia = read_inertial(element, segment > 0);
    link.shapes = read_shapes(element);
    if (name == tool_frame_) {
      arm_.tool_link = static_cast<int>(arm_.links.size());
      arm_.X_SE = X_SL;
    }
    const int index = static_cast<int>(arm_.links.size());
    arm_.links.push_back(link);
    for (const RawJoint& joint : raw_.joints)
      if (joint.parent == name) add_joint(joint, index, segment, X_SL);
  }

  void add_joint(const RawJoint& raw, int parent, int segment, const Pose& X_SL) {
    const Pose X_SJ = X_SL * read_origin(raw.element);
    if (raw.type == "fixed") {
      add_link(raw.child, parent, segment, X_SJ);
      return;
    }
    if (!on_path_.contains(raw.child)) {
      add_link(raw.child, parent, segment, X_SJ * frozen_pose(raw));
      return;
    }
    if (raw.type == "planar" || raw.type == "floating")
      raw.element.fail("type=\"" + raw.type + "\" between the root and the tool frame '" + tool_frame_ + "'",
                       "revolute, continuous, prismatic or fixed");
    const Coupling coupling = find_coupling(raw);
    const bool is_led = coupling.leader != &raw;
    if (is_led && (coupling.ratio == 0.0 || !moves(*coupling.leader))) {
      add_link(raw.child, parent, segment, X_SJ * frozen_pose(raw));
      return;
    }
    if (is_led ? arm_.followers.size() == kMaxMoving - kMaxJoints : arm_.joint_count() == kMaxJoints)
      raw.element.fail("a moving joint more than " + std::to_string(is_led ? kMaxMoving - kMaxJoints : kMaxJoints),
                       is_led ? "no more that mimic others" : "no more than that");
    Joint joint = read_moving_joint(raw);
    joint.X_SJ = X_SJ;
    if (is_led) {
      arm_.order.push_back(-1 - static_cast<int>(arm_.followers.size()));
      arm_.followers.push_back({joint, 0, coupling.ratio, coupling.offset});
      raw_followers_.push_back(&raw);
    } else {
      arm_.order.push_back(arm_.joint_count());
      arm_.joints.push_back(joint);
    }
    arm_.segments.push_back({0.0, Vector3::Zero(), Matrix3::Zero()});
    add_link(raw.child, parent, arm_.last_segment(), Pose{});
  }

  [[nodiscard]] bool moves(const RawJoint& raw) const { return on_path_.contains(raw.child) && raw.type != "fixed"; }

  /// What leads a joint in the end, through others that mimic: itself where it moves by itself. Joints off the path
  /// that mimic each other in a circle are led by the one at which the circle closes.
  struct Coupling {
    const RawJoint* leader;
    double ratio = 1.0, offset = 0.0;
  };
  [[nodiscard]] Coupling find_coupling(const RawJoint& raw) const {
    Coupling coupling{&raw};
    std::set<const RawJoint*> passed;
    while (coupling.leader->element.has("mimic") && passed.insert(coupling.leader).second) {
      const Element mimic = coupling.leader->element.child("mimic");
      const std::string name = mimic.text("joint");
      const auto found = std::ranges::find(raw_.joints, name, &RawJoint::name);
      if (found == raw_.joints.end()) mimic.fail("joint '" + name + "', which is not there", "the name of a joint");
      if (passed.contains(&*found) && moves(raw))
        mimic.fail("joints that mimic each other in a circle", "one of them that moves by itself");
      coupling.offset += coupling.ratio * mimic.number_or("offset", 0.0);
      coupling.ratio *= mimic.number_or("multiplier", 1.0);
      coupling.leader = &*found;
    }
    return coupling;
  }

  /// The leader moves no farther and no faster than the limits of what follows it allow.
  void join(Follower& follower, const RawJoint& raw) {
    follower.leader = find_joint(arm_, find_coupling(raw).leader->name);
    Joint& leader = arm_.joints[static_cast<std::size_t>(follower.leader)];
    const auto [low, high] = std::minmax({(follower.joint.lower - follower.offset) / follower.ratio,
                                          (follower.joint.upper - follower.offset) / follower.ratio});
    leader.lower = std::max(leader.lower, low);
    leader.upper = std::min(leader.upper, high);
    leader.max_speed = std::min(leader.max_speed, follower.joint.max_speed / std::abs(follower.ratio));
    if (!(leader.lower < leader.upper))
      raw.element.fail("limits that leave '" + leader.name + "', which it mimics, no range", "limits that overlap");
  }

  /// Where a joint stands that does not move: at 0, or at the limit nearest to it; one that mimics, where it stands
  /// with what leads it (a joint that moves: at 0).
  double frozen_value(const RawJoint& joint) const {
    const Coupling coupling = find_coupling(joint);
    return coupling.ratio * (moves(*coupling.leader) ? 0.0 : rest_value(*coupling.leader)) + coupling.offset;
  }

  static double rest_value(const RawJoint& raw) {
    if (raw.type == "continuous" || raw.type == "fixed" || !raw.element.has("limit")) return 0.0;
    const Element limit = raw.element.child("limit");
    const double lower = limit.number_or("lower", 0.0), upper = limit.number_or("upper", 0.0);
    return lower <= upper ? std::clamp(0.0, lower, upper) : 0.0;
  }

  Pose frozen_pose(const RawJoint& raw) const {
    Pose X_JC;  // what the joint adds
    if (raw.type == "planar" || raw.type == "floating") return X_JC;
    const Vector3 axis = read_axis(raw);
    const double value = frozen_value(raw);
    if (raw.type == "prismatic")
      X_JC.p = value * axis;
    else
      X_JC.R = exp_rotation(value * axis);
    return X_JC;
  }

  void sum_segments() {
    for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
      SpatialInertia& sum = arm_.segments[i];
      for (const Link& link : arm_.links) {
        if (link.segment != static_cast<int>(i)) continue;
        add_inertia(link.inertia, link.X_SL, sum);
      }
    }
  }

 private:
  const Element& robot_;
  const RawRobot& raw_;
  const std::string& tool_frame_;
  std::map<std::string, bool> on_path_;
  std::vector<const RawJoint*> raw_followers_;
  ArmModel arm_;
};

}  // namespace

}  // namespace internal

ArmModel parse_urdf(const std::string& text, const std::string& name, const std::string& tool_frame,
                    const std::filesystem::path& folder) {
  check_utf8(text, name);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(name + ":" + std::to_string(std::max(1, document.ErrorLineNum())), "", document.ErrorName(),
                     "XML that can be parsed");
  const internal::UrdfSource source{name, folder};
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr) throw InputError(name + ":1", "", "no element", "<robot>");
  const internal::Element robot(root, source, "robot");
  if (robot.tag() != "robot")
    robot.fail("<" + robot.tag() + ">", robot.tag() == "sdf" ? "<robot>: this is SDF, not URDF" : "<robot>");
  if (internal::has_macros(*root)) robot.fail("xacro macros", "an expanded URDF: xacro FILE.xacro > FILE.urdf");
  internal::Element top(root, source, "");
  ArmModel arm = internal::Assembler(robot, internal::read_raw(top), tool_frame).assemble();
  if (robot.has_attribute("name")) arm.name = robot.text("name");
  if (arm.joints.empty()) robot.fail("no moving joint between the root and the tool frame", "at least one");
  return arm;
}

ArmModel load_urdf(const std::filesystem::path& path, const std::string& tool_frame) {
  return parse_urdf(read_file(path, "a URDF", internal::kLargestUrdf), path.string(), tool_frame, path.parent_path());
}

}  // namespace snug::robot
