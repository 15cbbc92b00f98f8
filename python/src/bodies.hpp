// What every class that steps a world shows of its bodies: live views, poses, contacts.
#pragma once

#include "core.hpp"
#include "snug/cell/world_builder.hpp"

namespace snug::python {

[[nodiscard]] physics::BodyId body_named(const cell::CellWorld& world, const std::string& name);
[[nodiscard]] py::list names_of(const cell::CellWorld& world);
/// (n, 7) or, with `out`, into it.
[[nodiscard]] Array poses_of(const cell::CellWorld& world, const physics::WorldState& state,
                             const std::optional<Array>& out);
[[nodiscard]] py::list contacts_of(const cell::CellWorld& world, const physics::WorldState& state);

/// `Self` has: world() -> const CellWorld&, state() -> const WorldState&, whose bodies never move in memory.
template <class Self, class... More>
void add_bodies(py::class_<Self, More...>& type) {
  using physics::BodyState;
  const auto member = [&type](const char* name, auto field, int columns) {
    type.def_property_readonly(name, [field, columns](const py::object& self) {
      const std::vector<BodyState>& bodies = self.cast<const Self&>().state().bodies;
      const void* const data = bodies.empty() ? nullptr : field(bodies.front());
      return view(self, py::dtype::of<double>(), data, {static_cast<py::ssize_t>(bodies.size()), columns},
                  {sizeof(BodyState), sizeof(double)});
    });
  };
  member(
      "positions", [](const BodyState& b) { return b.p_WBcm.data(); }, 3);
  member(
      "quaternions_xyzw", [](const BodyState& b) { return b.quat_WB.coeffs().data(); }, 4);
  member(
      "velocities", [](const BodyState& b) { return b.velocity.data(); }, 3);
  member(
      "angular_velocities", [](const BodyState& b) { return b.angular_velocity.data(); }, 3);
  type.def_property_readonly("present", [](const py::object& self) {
    const std::vector<BodyState>& bodies = self.cast<const Self&>().state().bodies;
    return view(self, py::dtype::of<bool>(), bodies.empty() ? nullptr : &bodies.front().is_present,
                {static_cast<py::ssize_t>(bodies.size())}, {sizeof(BodyState)});
  });
  type.def_property_readonly("names", [](const Self& self) { return names_of(self.world()); })
      .def(
          "poses",
          [](const Self& self, const std::optional<Array>& out) { return poses_of(self.world(), self.state(), out); },
          py::arg("out") = py::none())
      .def(
          "pose",
          [](const Self& self, const std::string& name) {
            return as_array(physics::pose_of(self.world().model, self.state(), body_named(self.world(), name)));
          },
          py::arg("name"))
      .def("contacts", [](const Self& self) { return contacts_of(self.world(), self.state()); })
      .def_property_readonly("time", [](const Self& self) { return self.state().time(self.world().model); })
      .def_property_readonly(
          "kinetic_energy", [](const Self& self) { return physics::kinetic_energy(self.world().model, self.state()); });
}

}  // namespace snug::python
