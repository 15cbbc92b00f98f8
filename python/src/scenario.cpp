// Scenario, Program: what is simulated, and what the tool does.
#include <fmt/format.h>

#include "core.hpp"
#include "handles.hpp"
#include "snug/model/items_file.hpp"
#include "snug/model/other_container.hpp"
#include "snug/model/scenario_edit.hpp"
#include "snug/model/scenario_names.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::python {
namespace {

/// A value as YAML writes it: 0.5, true, [1.0, 2.0]; words as they are.
std::string as_yaml(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  const py::object plain =
      py::hasattr(value, "tolist") ? value.attr("tolist")() : py::reinterpret_borrow<py::object>(value);
  return py::module_::import("json").attr("dumps")(plain).cast<std::string>();
}

py::dict as_dict(const model::Parcel& parcel) {
  py::dict dict;
  dict["id"] = parcel.id;
  dict["type"] = parcel.type;
  dict["size"] = as_array(parcel.size);
  dict["mass"] = parcel.inertia.mass;
  dict["com"] = as_array(parcel.inertia.com);
  return dict;
}

py::dict as_dict(const motion::Waypoint& row) {
  py::dict dict;
  dict["name"] = motion::name_of(row);
  dict["pose"] = as_array(row.X_WE);
  dict["vacuum"] = row.io.vacuum;
  dict["blow_off"] = row.io.blow_off;
  return dict;
}

py::object container_of(const model::Scenario& scenario) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) return py::none();
  py::dict dict;
  dict["name"] = container->name;
  dict["inner_size"] = as_array(container->inner_size);
  dict["pose"] = as_array(container->X_WT);
  dict["walls"] = container->has_walls;
  return dict;
}

/// <snug.Scenario 'box-demonstrator': 45 parcels, 5 sequences, 9 bodies, container 370 x 570 x 250 mm>
std::string describe(const Held<model::Scenario>& s) {
  std::string text = fmt::format("<snug.Scenario '{}': {} parcels, {} sequences, {} bodies", s->name, s->parcels.size(),
                                 s->sequences.size(), s->bodies.size());
  if (const model::Container* container = model::find_container(*s, s->target)) {
    const Vector3 mm = container->inner_size * 1e3;
    text += fmt::format(", container {:.0f} x {:.0f} x {:.0f} mm", mm.x(), mm.y(), mm.z());
  }
  return text + ">";
}

ScenarioHandle held(model::Scenario scenario) { return std::make_shared<Held<model::Scenario>>(std::move(scenario)); }

}  // namespace

void bind_scenario(py::module_& m) {
  py::class_<Held<model::Scenario>, ScenarioHandle>(m, "Scenario")
      .def_property_readonly("name", [](const Held<model::Scenario>& s) { return s->name; })
      .def_property_readonly("source", [](const Held<model::Scenario>& s) { return s->source_name; })
      .def_property_readonly("text", [](const Held<model::Scenario>& s) { return s->source_text; })
      .def_property_readonly("time_step", [](const Held<model::Scenario>& s) { return s->time_step; })
      .def_property_readonly("duration", [](const Held<model::Scenario>& s) { return s->duration; })
      .def_property_readonly("seed", [](const Held<model::Scenario>& s) { return s->seed; })
      .def_property_readonly("sequences",
                             [](const Held<model::Scenario>& s) {
                               py::dict all;
                               for (const model::Sequence& sequence : s->sequences) {
                                 py::list ids;
                                 for (const model::Item& item : sequence.items) ids.append(item.parcel);
                                 all[py::str(sequence.name)] = ids;
                               }
                               return all;
                             })
      .def_property_readonly("parcels",
                             [](const Held<model::Scenario>& s) {
                               py::list all;
                               for (const model::Parcel& parcel : s->parcels) all.append(as_dict(parcel));
                               return all;
                             })
      .def_property_readonly("container", [](const Held<model::Scenario>& s) { return container_of(*s); })
      .def(
          "with_values",
          [](const Held<model::Scenario>& s, const py::dict& values) {
            std::vector<model::KeyValue> changes;
            for (const auto& [key, value] : values) changes.emplace_back(key.cast<std::string>(), as_yaml(value));
            return held(model::with_values(*s, changes, "with_values"));
          },
          py::arg("values"))
      .def(
          "with_container",
          [](const Held<model::Scenario>& s, const std::string& words) {
            return held(model::with_container(*s, words));
          },
          py::arg("words"))
      .def(
          "with_pallet",
          [](const Held<model::Scenario>& s, const std::string& words) { return held(model::with_pallet(*s, words)); },
          py::arg("words"))
      .def(
          "with_items",
          [](const Held<model::Scenario>& s, const py::object& items) {
            model::Scenario changed = *s;
            if (py::isinstance<py::str>(items) || py::hasattr(items, "__fspath__")) {
              model::add_items(changed, items.cast<std::filesystem::path>());
            } else {
              const auto table = py::module_::import("snug._items").attr("as_csv")(items).cast<std::string>();
              model::add_orders(changed, model::parse_orders_csv(table, "items"), "items");
            }
            return held(std::move(changed));
          },
          py::arg("items"))
      .def("__repr__", &describe)
      .def(
          "__eq__", [](const Held<model::Scenario>& a, const Held<model::Scenario>& b) { return *a == *b; },
          py::is_operator());
  m.def(
      "load_scenario",
      [](const std::string& words, const std::filesystem::path& shipped) {
        return held(model::load_scenario(model::find_scenario_file(words, shipped)));
      },
      py::arg("words"), py::arg("shipped"));
  m.def("list_scenarios", &model::list_scenarios, py::arg("shipped"));
  m.def(
      "parse_scenario",
      [](const std::string& text, const std::string& name) { return held(model::parse_scenario(text, name)); },
      py::arg("text"), py::arg("name") = "text");

  py::class_<Held<motion::Program>, ProgramHandle>(m, "Program")
      .def_property_readonly("name", [](const Held<motion::Program>& p) { return p->name; })
      .def_property_readonly("rows",
                             [](const Held<motion::Program>& p) {
                               py::list rows;
                               for (const motion::Waypoint& row : p->waypoints) rows.append(as_dict(row));
                               return rows;
                             })
      .def("to_csv", [](const Held<motion::Program>& p) { return motion::format_program(*p); })
      .def(
          "save",
          [](const Held<motion::Program>& p, const std::filesystem::path& path) { motion::write_program(*p, path); },
          py::arg("path"))
      .def("__repr__",
           [](const Held<motion::Program>& p) {
             return fmt::format("<snug.Program '{}': {} waypoints>", p->name, p->waypoints.size());
           })
      .def("__len__", [](const Held<motion::Program>& p) { return p->waypoints.size(); });
  m.def(
      "load_program",
      [](const std::filesystem::path& path) {
        return std::make_shared<Held<motion::Program>>(motion::load_program(path));
      },
      py::arg("path"));
  m.def(
      "parse_program",
      [](const std::string& text, const std::string& name) {
        return std::make_shared<Held<motion::Program>>(motion::parse_program(text, name));
      },
      py::arg("text"), py::arg("name") = "text");
}

}  // namespace snug::python
