// MoveItExport: bodies as collision objects, the held one attached, joints as the state of the robot.
#include "snug/replay/moveit_export.hpp"

#include <fmt/format.h>

#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/replay/internal/body_colours.hpp"
#include "snug/replay/internal/instant.hpp"
#include "snug/replay/internal/mcap_messages.hpp"
#include "snug/replay/internal/recorded_scenario.hpp"
#include "snug/replay/internal/robot_frames.hpp"

namespace snug::replay {
namespace {

using record::PoseSample;

/// Name of the body that the gripper is.
constexpr const char* kGripperBody = "tool";

// Kinds of shape_msgs/SolidPrimitive.
constexpr int kBoxPrimitive = 1, kSpherePrimitive = 2, kCylinderPrimitive = 3;

/// A number that every reader of YAML takes for one with a fraction: "1e-05" and "1" are none to some.
std::string real(double value) {
  std::string text = fmt::format("{}", value);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  return text;
}

/// Quotes and escapes of JSON are those of YAML.
std::string quoted_name(const std::string& text) { return internal::to_text(internal::Json(text)); }

std::string point_text(const Vector3& p) {
  return fmt::format("{{x: {}, y: {}, z: {}}}", real(p.x()), real(p.y()), real(p.z()));
}

std::string pose_text(const PoseSample& X) {
  const Quaternion q = X.quat.normalized();
  return fmt::format("{{position: {}, orientation: {{x: {}, y: {}, z: {}, w: {}}}}}", point_text(X.p), real(q.x()),
                     real(q.y()), real(q.z()), real(q.w()));
}

/// The shapes of a body as lists of a CollisionObject.
class ObjectShapes {
 public:
  explicit ObjectShapes(const record::BodyInfo& body) {
    for (const record::ShapeInfo& shape : body.shapes) add(shape);
  }

  [[nodiscard]] bool is_empty() const { return primitives_.empty() && meshes_.empty(); }

  /// Four lists, each line behind `indent`.
  [[nodiscard]] std::string text(const std::string& indent) const {
    return list("primitives", primitives_, indent) + list("primitive_poses", primitive_poses_, indent) +
           list("meshes", meshes_, indent) + list("mesh_poses", mesh_poses_, indent);
  }

 private:
  using Lines = std::vector<std::string>;

  static std::string list(const char* key, const Lines& lines, const std::string& indent) {
    if (lines.empty()) return "";
    std::string text = fmt::format("{}{}:\n", indent, key);
    for (const std::string& line : lines) text += fmt::format("{}  - {}\n", indent, line);
    return text;
  }

  void add_primitive(int type, std::initializer_list<double> dimensions, const PoseSample& X_BG) {
    std::string sizes;
    for (const double size : dimensions) sizes += (sizes.empty() ? "" : ", ") + real(size);
    primitives_.push_back(fmt::format("{{type: {}, dimensions: [{}]}}", type, sizes));
    primitive_poses_.push_back(pose_text(X_BG));
  }

  /// A capsule without length is a sphere.
  void add_capsule_primitives(const record::ShapeInfo& shape) {
    if (shape.half_length == 0.0) return add_primitive(kSpherePrimitive, {shape.radius}, shape.X_BG);
    add_primitive(kCylinderPrimitive, {2.0 * shape.half_length, shape.radius}, shape.X_BG);
    for (const double end : {-shape.half_length, shape.half_length}) {
      const Vector3 p = shape.X_BG.p + shape.X_BG.quat.normalized() * Vector3(0.0, 0.0, end);
      add_primitive(kSpherePrimitive, {shape.radius}, {p, shape.X_BG.quat});
    }
  }

  void add(const record::ShapeInfo& shape) {
    switch (shape.kind) {
      case record::ShapeKind::Box:
        add_primitive(kBoxPrimitive, {2.0 * shape.half.x(), 2.0 * shape.half.y(), 2.0 * shape.half.z()}, shape.X_BG);
        break;
      case record::ShapeKind::Capsule:
        add_capsule_primitives(shape);
        break;
      case record::ShapeKind::Cylinder:
        add_primitive(kCylinderPrimitive, {2.0 * shape.half_length, shape.radius}, shape.X_BG);
        break;
      case record::ShapeKind::Hull:
        add_hull(shape);
        break;
    }
  }

  void add_hull(const record::ShapeInfo& shape) {
    const auto hull = geometry::make_convex_hull(shape.vertices);
    if (!hull) return;
    std::string triangles, vertices;
    for (const std::vector<int>& face : hull->faces) {
      for (std::size_t i = 2; i < face.size(); ++i) {
        triangles += fmt::format("{}{{vertex_indices: [{}, {}, {}]}}", triangles.empty() ? "" : ", ", face[0],
                                 face[i - 1], face[i]);
      }
    }
    for (const Vector3& vertex : hull->vertices) vertices += (vertices.empty() ? "" : ", ") + point_text(vertex);
    meshes_.push_back(fmt::format("{{triangles: [{}], vertices: [{}]}}", triangles, vertices));
    mesh_poses_.push_back(pose_text(shape.X_BG));
  }

  Lines primitives_, primitive_poses_, meshes_, mesh_poses_;
};

class MoveItScene {
 public:
  MoveItScene(const record::RecordingHeader& header, const record::Frame& frame, const RobotDescription& robot)
      : header_(header), frame_(frame) {
    for (const internal::LinkFrame& link : internal::RobotFrames(header, robot.urdf, frame).still()) {
      if (link.parent != internal::kWorldFrame) continue;
      frame_id_ = link.child;
      X_RW_ = link.X_PC.pose().inverse();
    }
    if (const auto scenario = internal::scenario_of(header); scenario && scenario->robot && !header.joints.empty())
      flange_ = scenario->robot->flange_frame;
  }

  std::string text(const std::string& name, MoveItTotals& totals) const {
    std::string objects, attached, colors;
    for (std::size_t i = 0; i < header_.bodies.size(); ++i) {
      const record::BodyInfo& body = header_.bodies[i];
      if (!frame_.bodies[i].present || body.name.starts_with("robot/") || ObjectShapes(body).is_empty()) continue;
      if (is_attached(i)) {
        attached += attached_text(i);
        totals.attached.push_back(body.name);
      } else if (body.name != kGripperBody) {
        objects += object_text(i, "    ");
        ++totals.objects;
      } else {
        continue;
      }
      colors += color_text(body);
    }
    totals.frame = frame_id_;
    std::string text =
        fmt::format("# moveit_msgs/PlanningScene, a difference to the scene that is there; m. {}, {} s\n",
                    quoted_name(name), real(frame_.time));
    text += fmt::format("name: {}\nrobot_state:\n{}", quoted_name(name), joints_text());
    if (!attached.empty()) text += "  attached_collision_objects:\n" + attached;
    text += "  is_diff: true\n";
    if (!colors.empty()) text += "object_colors:\n" + colors;
    text += objects.empty() ? "world: {collision_objects: []}\n" : "world:\n  collision_objects:\n" + objects;
    return text + "is_diff: true\n";
  }

 private:
  /// The gripper, and what the cup holds. Without a robot there is no link to attach it to: the box is then one of the
  /// world's, and the gripper is left out.
  [[nodiscard]] bool is_attached(std::size_t body) const {
    return !flange_.empty() &&
           (frame_.cup.attached_body == static_cast<int>(body) || header_.bodies[body].name == kGripperBody);
  }

  [[nodiscard]] std::string object_text(std::size_t i, const std::string& indent) const {
    const PoseSample X_RB(X_RW_ * frame_.bodies[i].X_WB.pose());
    const std::string in = indent + "  ";
    return fmt::format("{}- id: {}\n{}header: {{frame_id: {}}}\n{}pose: {}\n{}{}operation: 0\n", indent,
                       quoted_name(header_.bodies[i].name), in, quoted_name(frame_id_), in, pose_text(X_RB),
                       ObjectShapes(header_.bodies[i]).text(in), in);
  }

  [[nodiscard]] std::string color_text(const record::BodyInfo& body) const {
    const auto c = internal::body_colour(body, body.name == header_.container.name);
    return fmt::format("  - {{id: {}, color: {{r: {}, g: {}, b: {}, a: {}}}}}\n", quoted_name(body.name), real(c[0]),
                       real(c[1]), real(c[2]), real(c[3]));
  }

  [[nodiscard]] std::string joints_text() const {
    if (header_.joints.empty()) return "";
    std::string names, positions;
    for (std::size_t i = 0; i < header_.joints.size(); ++i) {
      names += (i > 0 ? ", " : "") + quoted_name(header_.joints[i]);
      positions += (i > 0 ? ", " : "") + real(frame_.joints[i].position);
    }
    return fmt::format("  joint_state:\n    name: [{}]\n    position: [{}]\n", names, positions);
  }

  [[nodiscard]] std::string attached_text(std::size_t body) const {
    std::string object = object_text(body, "        ");
    object.replace(object.find('-'), 1, " ");  // no item of a list
    return fmt::format(
        "    - link_name: {}\n      object:\n{}      touch_links: [{}]\n"
        "      weight: {}\n",
        quoted_name(flange_), object, quoted_name(flange_), real(header_.bodies[body].mass));
  }

  const record::RecordingHeader& header_;
  const record::Frame& frame_;
  std::string frame_id_ = "world";  ///< called as W is without a robot
  Pose X_RW_;                       ///< root link of the robot
  std::string flange_;
};

}  // namespace

MoveItTotals export_moveit_scene(record::RecordingReader& reader, const std::string& name,
                                 const std::optional<double>& time, OutputFile file, const RobotDescription& robot) {
  if (reader.times().empty()) throw InputError(name, "", "a recording without frames", "at least one frame");
  record::Frame frame;
  reader.read_frame(internal::nearest_frame(reader.times(), time), frame);
  MoveItTotals totals;
  totals.time = frame.time;
  write_file(std::move(file), MoveItScene(reader.header(), frame, robot).text(name, totals));
  return totals;
}

std::string to_text(const MoveItTotals& totals) {
  return fmt::format("{} collision objects at {:.3f} s, in frame {}{}{}", totals.objects, totals.time, totals.frame,
                     totals.attached.empty() ? "" : ", attached: ", fmt::join(totals.attached, ", "));
}

}  // namespace snug::replay
