// Cup and Arm: the law of the suction cup, and the kinematics of a robot's arm.
#include <fmt/format.h>

#include "core.hpp"
#include "handles.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/potential_law.hpp"
#include "snug/cup/statics.hpp"
#include "snug/identification/payload_file.hpp"
#include "snug/robot/inverse.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::python {
namespace {

struct Cup {
  explicit Cup(const ScenarioHandle& scenario) : params((*scenario)->cup), K(cup::as_matrix(params.stiffness)) {}
  model::CupParams params;
  Matrix6 K;

  [[nodiscard]] cup::LawResponse respond(const Pose& H) const { return cup::spring_response(H, K, params.law); }

  [[nodiscard]] py::dict settle(double mass, const Array& com, const Array& tool, const Array& gravity) const {
    cup::HeldLoad load;
    load.mass = mass;
    load.p_SScm = as_vector3(com, "com");
    load.R_WE = as_pose(tool, "tool").R;
    load.stiffness = K;
    load.law = params.law;
    load.X_ES2.p = Vector3(0.0, 0.0, params.hold_length - params.centre_from_lip);
    load.X_SS1.p = Vector3(0.0, 0.0, -params.centre_from_lip);
    load.gravity_W = as_vector3(gravity, "gravity");
    const cup::SettleResult result = cup::settle(load);
    py::dict dict;
    dict["status"] = cup::name_of(result.status);
    dict["lip"] = as_array(result.X_ES);
    dict["is_stable"] = result.is_stable;
    dict["residual"] = result.residual;
    dict["load_fraction"] = result.load_fraction;
    dict["bend"] = result.bend;
    return dict;
  }

  [[nodiscard]] py::object payload(const Array& times, const Array& gripper, const Array& wrenches,
                                   bool rigid_lip) const {
    const auto count = static_cast<std::size_t>(times.size());
    const auto expect = [&](const Array& array, const char* what, py::ssize_t width) {
      if (array.ndim() != 2 || array.shape(0) != times.size() || array.shape(1) != width)
        throw InputError("argument", what, "another shape", fmt::format("({}, {}), a row for each time", count, width));
    };
    expect(gripper, "gripper", 7);
    expect(wrenches, "wrenches", 6);
    std::vector<identification::PayloadSample> lift(count);
    for (std::size_t i = 0; i < count; ++i) {
      lift[i].time = times.data()[i];
      lift[i].X_WE = as_pose(Array(7, gripper.data() + 7 * i), "gripper");
      lift[i].wrench_E = Eigen::Map<const Vector6>(wrenches.data() + 6 * i);
    }
    identification::check_lift(lift, "argument");
    identification::PayloadSettings settings;
    settings.K = K;
    settings.frames = identification::frames_of(params);
    if (rigid_lip) lift = identification::with_rigid_lip(std::move(lift), settings.frames);
    identification::PayloadEstimator estimator(settings);
    for (const identification::PayloadSample& sample : lift) estimator.add(sample);
    return from_json(identification::format_payload_json(estimator.estimate()));
  }
};

struct Arm {
  explicit Arm(robot::ArmModel model) : inverse(model), arm(std::move(model)) {}
  robot::InverseKinematics inverse;
  robot::ArmModel arm;

  [[nodiscard]] robot::JointVector joints_of(const Array& q, const char* what) const {
    if (q.ndim() != 1 || q.size() != arm.joint_count())
      throw InputError("argument", what, std::to_string(q.size()) + " numbers", std::to_string(arm.joint_count()));
    robot::JointVector joints(arm.joint_count());
    for (int i = 0; i < arm.joint_count(); ++i) {
      joints[i] = q.data()[i];
      if (!std::isfinite(joints[i]))
        throw InputError("argument", what, "a number that is not finite", "finite numbers");
    }
    return joints;
  }
  [[nodiscard]] Array jacobian(const Array& q) const {
    const robot::Jacobian J = robot::tool_jacobian(arm, robot::forward(arm, joints_of(q, "q")));
    Array array({static_cast<py::ssize_t>(6), static_cast<py::ssize_t>(J.cols())});
    for (Eigen::Index r = 0; r < 6; ++r) {
      for (Eigen::Index c = 0; c < J.cols(); ++c) array.mutable_at(r, c) = J(r, c);
    }
    return array;
  }
  [[nodiscard]] Array bounds(double robot::Joint::*bound) const {
    Array array(arm.joint_count());
    for (int i = 0; i < arm.joint_count(); ++i) array.mutable_at(i) = arm.joints[static_cast<std::size_t>(i)].*bound;
    return array;
  }
};

Array joints_as_array(const robot::JointVector& q) { return Array(static_cast<py::ssize_t>(q.size()), q.data()); }

}  // namespace

void bind_tools(py::module_& m) {
  py::class_<Cup>(m, "Cup")
      .def(py::init<const ScenarioHandle&>(), py::arg("scenario"))
      .def("__repr__",
           [](const Cup& c) {
             return fmt::format("<snug.Cup: lip radius {:.1f} mm, {:.0f} N/m along its axis>",
                                1e3 * c.params.lip_radius, c.K(2, 2));
           })
      .def_property_readonly("stiffness", [](const Cup& c) { return as_array(c.K); })
      .def_property_readonly("damping", [](const Cup& c) { return as_array(cup::as_matrix(c.params.damping)); })
      .def_property_readonly("hold_length", [](const Cup& c) { return c.params.hold_length; })
      .def_property_readonly("lip_radius", [](const Cup& c) { return c.params.lip_radius; })
      .def(
          "wrench", [](const Cup& c, const Array& H) { return as_array(c.respond(as_pose(H, "H")).wrench); },
          py::arg("H"))
      .def(
          "tangent", [](const Cup& c, const Array& H) { return as_array(c.respond(as_pose(H, "H")).tangent); },
          py::arg("H"))
      .def(
          "potential", [](const Cup& c, const Array& H) { return c.respond(as_pose(H, "H")).energy; }, py::arg("H"))
      .def("settle", &Cup::settle, py::arg("mass"), py::arg("com"), py::arg("tool"), py::arg("gravity"))
      .def("payload", &Cup::payload, py::arg("times"), py::arg("gripper"), py::arg("wrenches"),
           py::arg("rigid_lip") = false);
  py::class_<Arm>(m, "Arm")
      .def(py::init([](const ScenarioHandle& s) { return std::make_unique<Arm>(robot::load_arm(**s)); }),
           py::arg("scenario"))
      .def_static(
          "from_urdf",
          [](const std::filesystem::path& path, const std::string& tool_frame) {
            return std::make_unique<Arm>(robot::load_urdf(path, tool_frame));
          },
          py::arg("path"), py::arg("tool_frame") = "E")
      .def("__repr__",
           [](const Arm& a) { return fmt::format("<snug.Arm '{}': {} joints>", a.arm.name, a.arm.joint_count()); })
      .def_property_readonly("name", [](const Arm& a) { return a.arm.name; })
      .def_property_readonly("joints",
                             [](const Arm& a) {
                               std::vector<std::string> names;
                               for (const robot::Joint& joint : a.arm.joints) names.push_back(joint.name);
                               return names;
                             })
      .def_property_readonly("lower", [](const Arm& a) { return a.bounds(&robot::Joint::lower); })
      .def_property_readonly("upper", [](const Arm& a) { return a.bounds(&robot::Joint::upper); })
      .def_property_readonly("max_speed", [](const Arm& a) { return a.bounds(&robot::Joint::max_speed); })
      .def(
          "forward",
          [](const Arm& a, const Array& q) { return as_array(robot::forward_tool(a.arm, a.joints_of(q, "q"))); },
          py::arg("q"))
      .def("jacobian", &Arm::jacobian, py::arg("q"))
      .def(
          "inverse",
          [](const Arm& a, const Array& pose, const Array& near) -> py::object {
            const auto q = a.inverse.nearest(as_pose(pose, "pose"), a.joints_of(near, "near"));
            if (!q) return py::none();
            return joints_as_array(*q);
          },
          py::arg("pose"), py::arg("near"))
      .def(
          "branches",
          [](const Arm& a, const Array& pose, const Array& near) {
            const robot::IkBranches found = a.inverse.branches(as_pose(pose, "pose"), a.joints_of(near, "near"));
            py::list list;
            for (int i = 0; i < found.count; ++i) list.append(joints_as_array(found.q[static_cast<std::size_t>(i)]));
            return list;
          },
          py::arg("pose"), py::arg("near"));
}

}  // namespace snug::python
