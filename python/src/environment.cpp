// Environments: single and many; observations are written into arrays that nobody else holds.
#include "core.hpp"
#include "handles.hpp"
#include "snug/core/input_error.hpp"
#include "snug/environment/vector_environment.hpp"

namespace snug::python {
namespace {

using environment::Action;
using environment::Environment;
using environment::VectorEnvironment;
using Floats = py::array_t<float>;

environment::Mode mode_named(const std::string& name) {
  if (name == "geometric") return environment::Mode::Geometric;
  if (name == "statics") return environment::Mode::Statics;
  if (name == "executed") return environment::Mode::Executed;
  throw InputError("argument", "mode", "'" + name + "'", "geometric, statics or executed");
}

/// Keyword arguments into settings: every one must be known.
environment::Settings settings_of(const py::dict& words) {
  environment::Settings s;
  s.packing.max_candidates = 1;  // of agents; here max_candidates is the environment's
  const auto number = [](double& to) { return [&to](const py::handle& v) { to = v.cast<double>(); }; };
  const auto whole = [](int& to) { return [&to](const py::handle& v) { to = v.cast<int>(); }; };
  const std::vector<std::pair<std::string, std::function<void(const py::handle&)>>> known = {
      {"mode", [&](const py::handle& v) { s.mode = mode_named(v.cast<std::string>()); }},
      {"sequence", [&](const py::handle& v) { s.sequence = v.is_none() ? "" : v.cast<std::string>(); }},
      {"resolution", number(s.resolution)},
      {"max_candidates", whole(s.max_candidates)},
      {"max_steps", whole(s.max_steps)},
      {"settle_time", number(s.settle_time)},
      {"time_step", number(s.time_step)},
      {"max_displacement", number(s.max_displacement)},
      {"max_tilt", number(s.max_tilt)},
      {"max_flips", whole(s.packing.max_flips)},
      {"planned_interference", number(s.packing.planned_interference)},
      {"squeeze", number(s.packing.planned_interference)},  // its name in earlier scripts
      {"min_support", number(s.packing.min_support)},
      {"com_margin", number(s.packing.com_margin)},
      {"vary", [&](const py::handle& v) { s.varies = v.cast<bool>(); }},
  };
  std::vector<std::string> names;
  for (const auto& [name, set] : known) names.push_back(name);
  for (const auto& [key, value] : words) {
    const auto word = key.cast<std::string>();
    const auto found = std::ranges::find(known, word, [](const auto& entry) { return entry.first; });
    if (found != known.end()) {
      found->second(value);
      continue;
    }
    const std::string_view nearest = find_nearest(word, names);
    throw InputError("argument", word, "an unknown setting",
                     nearest.empty() ? "a setting of an environment" : "perhaps " + std::string(nearest));
  }
  return s;
}

environment::Parameters parameters_of(const py::dict& words) {
  environment::Parameters p;
  for (const auto& [key, value] : words) {
    const auto word = key.cast<std::string>();
    const double number = value.cast<double>();
    if (word == "size_offset") {
      p.size_offset = number;
    } else if (word == "friction_scale") {
      p.friction_scale = number;
    } else if (word == "cup_scale") {
      p.cup_scale = number;
    } else if (word == "mass_scale") {
      p.mass_scale = number;
    } else {
      throw InputError("argument", word, "an unknown parameter", "size_offset, friction_scale, cup_scale, mass_scale");
    }
  }
  return p;
}

/// Arrays for `count` environments; which of them are wanted.
struct Arrays {
  Arrays(const Environment& e, int count, bool maps, bool boxes, bool is_batch) : n(count) {
    const auto shape = [&](std::vector<py::ssize_t> rest) {
      if (is_batch) rest.insert(rest.begin(), n);
      return rest;
    };
    if (maps) height_map = Floats(shape({e.rows(), e.columns()}));
    if (boxes) box_list = Floats(shape({e.most_boxes(), environment::kBoxNumbers}));
    item = Floats(shape({environment::kItemNumbers}));
    candidates = Floats(shape({e.settings().max_candidates, environment::kCandidateNumbers}));
    mask = py::array_t<std::int8_t>(shape({e.settings().max_candidates}));
    at = {.height_map = all(height_map),
          .item = all(item),
          .boxes = all(box_list),
          .candidates = all(candidates),
          .mask = std::span<std::int8_t>(mask.mutable_data(), static_cast<std::size_t>(mask.size()))};
  }

  [[nodiscard]] environment::ObservationView of(int index) const {
    const auto part = [&](auto whole) {
      const std::size_t size = whole.size() / static_cast<std::size_t>(n);
      return whole.subspan(static_cast<std::size_t>(index) * size, size);
    };
    return {part(at.height_map), part(at.item), part(at.boxes), part(at.candidates), part(at.mask)};
  }
  [[nodiscard]] py::dict as_dict() const {
    py::dict dict;
    if (height_map.size() > 0) dict["height_map"] = height_map;
    if (box_list.size() > 0) dict["boxes"] = box_list;
    dict["item"] = item;
    dict["candidates"] = candidates;
    dict["action_mask"] = mask;
    return dict;
  }

 private:
  static std::span<float> all(Floats& array) {
    return {array.size() > 0 ? array.mutable_data() : nullptr, static_cast<std::size_t>(array.size())};
  }
  int n;
  Floats height_map, box_list, item, candidates;
  py::array_t<std::int8_t> mask;
  environment::ObservationView at;
};

struct Single {
  Single(const ScenarioHandle& scenario, const py::dict& settings, const py::dict& parameters, bool with_maps,
         bool with_boxes)
      : environment(**scenario, settings_of(settings), parameters_of(parameters)), maps(with_maps), boxes(with_boxes) {}
  Single(const Single& other) : environment(other.environment), maps(other.maps), boxes(other.boxes) {}
  Environment environment;
  bool maps, boxes;
  std::atomic<bool> busy{false};

  [[nodiscard]] py::dict observe() const {
    const Arrays arrays(environment, 1, maps, boxes, false);
    environment.observe(arrays.of(0));
    return arrays.as_dict();
  }
  /// reward, terminated, truncated, reason, displacement.
  py::tuple step(const Action& action) {
    const Use use(busy);
    environment::Step result;
    {
      const py::gil_scoped_release release;
      result = environment.step(action);
    }
    return py::make_tuple(observe(), result.reward, result.terminated, result.truncated, std::string(result.reason),
                          result.displacement, result.is_placed);
  }
};

py::list boxes_of(const Environment& e) {
  py::list list;
  for (const packing::PlacedBox& box : e.boxes()) {
    py::dict entry;
    entry["id"] = box.item.id;
    entry["size"] = as_array(box.item.size);
    entry["mass"] = box.item.mass;
    entry["pose"] = as_array(box.X_TP);
    list.append(entry);
  }
  return list;
}

struct Many {
  Many(const std::vector<ScenarioHandle>& scenarios, const std::vector<py::dict>& settings,
       const std::vector<py::dict>& parameters, int threads, bool with_maps, bool with_boxes)
      : all(make(scenarios, settings, parameters), threads), maps(with_maps), boxes(with_boxes) {}
  static std::vector<Environment> make(const std::vector<ScenarioHandle>& scenarios,
                                       const std::vector<py::dict>& settings, const std::vector<py::dict>& parameters) {
    if (scenarios.size() != settings.size() || scenarios.size() != parameters.size())
      throw InputError("argument", "scenarios", std::to_string(scenarios.size()), "as many as settings and parameters");
    std::vector<Environment> list;
    for (std::size_t i = 0; i < scenarios.size(); ++i)
      list.emplace_back(**scenarios[i], settings_of(settings[i]), parameters_of(parameters[i]));
    return list;
  }
  VectorEnvironment all;
  bool maps, boxes;
  std::atomic<bool> busy{false};

  py::dict reset(const std::vector<std::uint8_t>& mask, const std::vector<std::uint64_t>& seeds) {
    const Use use(busy);
    const Arrays arrays(all.environment(0), all.count(), maps, boxes, true);
    {
      const py::gil_scoped_release release;
      all.reset(mask, seeds, [&](int i, const Environment& e) { e.observe(arrays.of(i)); });
    }
    return arrays.as_dict();
  }
  py::tuple step(const std::vector<Action>& actions, const std::vector<std::uint64_t>& next_seeds) {
    const Use use(busy);
    const Arrays arrays(all.environment(0), all.count(), maps, boxes, true);
    py::array_t<double> reward(all.count());
    py::array_t<bool> terminated(all.count()), truncated(all.count());
    const auto n = static_cast<std::size_t>(all.count());
    const environment::BatchView results{{reward.mutable_data(), n},
                                         {reinterpret_cast<std::uint8_t*>(terminated.mutable_data()), n},
                                         {reinterpret_cast<std::uint8_t*>(truncated.mutable_data()), n}};
    {
      const py::gil_scoped_release release;
      all.step(actions, next_seeds, results, [&](int i, const Environment& e) { e.observe(arrays.of(i)); });
    }
    return py::make_tuple(arrays.as_dict(), reward, terminated, truncated);
  }
};

/// Indices, or rows of orientation, x, y.
std::vector<Action> actions_of(const Array& array, bool is_candidate) {
  std::vector<Action> actions;
  if (is_candidate && array.ndim() == 1) {
    for (py::ssize_t i = 0; i < array.size(); ++i) {
      const double index = array.data()[i];
      actions.push_back({.candidate = index >= 0.0 && index < 1e6 ? static_cast<int>(index) : 1'000'000});
    }
    return actions;
  }
  if (is_candidate || array.ndim() != 2 || array.shape(1) != 3)
    throw InputError("argument", "actions", "an array of another shape",
                     is_candidate ? "one index for each environment" : "rows of orientation, x, y");
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const double* const row = array.data() + 3 * i;
    const bool is_index = row[0] >= 0.0 && row[0] < 1e6;
    actions.push_back({.orientation = is_index ? static_cast<int>(row[0]) : -1, .x = row[1], .y = row[2]});
  }
  return actions;
}

}  // namespace

void bind_environment(py::module_& m) {
  py::class_<Single>(m, "Environment")
      .def(py::init<const ScenarioHandle&, const py::dict&, const py::dict&, bool, bool>(), py::arg("scenario"),
           py::arg("settings"), py::arg("parameters"), py::arg("maps"), py::arg("boxes"))
      .def("reset",
           [](Single& s, std::uint64_t seed) {
             const Use use(s.busy);
             {
               const py::gil_scoped_release release;
               s.environment.reset(seed);
             }
             return s.observe();
           })
      .def("observe", &Single::observe)
      .def("step_candidate",
           [](Single& s, long long index) {
             return s.step({.candidate = index >= 0 && index < 1'000'000 ? static_cast<int>(index) : 1'000'000});
           })
      .def("step_place", [](Single& s, int orientation, double x,
                            double y) { return s.step({.orientation = orientation, .x = x, .y = y}); })
      .def("copy", [](const Single& s) { return std::make_unique<Single>(s); })
      .def_property_readonly("rows", [](const Single& s) { return s.environment.rows(); })
      .def_property_readonly("columns", [](const Single& s) { return s.environment.columns(); })
      .def_property_readonly("most_boxes", [](const Single& s) { return s.environment.most_boxes(); })
      .def_property_readonly("max_candidates", [](const Single& s) { return s.environment.settings().max_candidates; })
      .def_property_readonly("candidates",
                             [](const Single& s) { return static_cast<int>(s.environment.candidates().size()); })
      .def_property_readonly("has_ended", [](const Single& s) { return s.environment.has_ended(); })
      .def_property_readonly("next", [](const Single& s) { return s.environment.next(); })
      .def_property_readonly("items",
                             [](const Single& s) {
                               std::vector<std::string> ids;
                               for (const packing::Item& item : s.environment.items()) ids.push_back(item.id);
                               return ids;
                             })
      .def("boxes", [](const Single& s) { return boxes_of(s.environment); })
      .def_property_readonly("packed_percent", [](const Single& s) { return s.environment.packed_percent(); })
      .def_property_readonly("time", [](const Single& s) { return s.environment.time(); })
      .def_property_readonly("hash", [](const Single& s) { return s.environment.hash(); });
  py::class_<Many>(m, "VectorEnvironment")
      .def(py::init<const std::vector<ScenarioHandle>&, const std::vector<py::dict>&, const std::vector<py::dict>&, int,
                    bool, bool>(),
           py::arg("scenarios"), py::arg("settings"), py::arg("parameters"), py::arg("threads"), py::arg("maps"),
           py::arg("boxes"))
      .def("reset", &Many::reset, py::arg("mask"), py::arg("seeds"))
      .def("step_candidates",
           [](Many& v, const Array& actions, const std::vector<std::uint64_t>& next) {
             return v.step(actions_of(actions, true), next);
           })
      .def("step_places",
           [](Many& v, const Array& actions, const std::vector<std::uint64_t>& next) {
             return v.step(actions_of(actions, false), next);
           })
      .def_property_readonly("candidates",
                             [](const Many& v) {
                               std::vector<int> counts;
                               for (int i = 0; i < v.all.count(); ++i)
                                 counts.push_back(static_cast<int>(v.all.environment(i).candidates().size()));
                               return counts;
                             })
      .def_property_readonly("rows", [](const Many& v) { return v.all.environment(0).rows(); })
      .def_property_readonly("columns", [](const Many& v) { return v.all.environment(0).columns(); })
      .def_property_readonly("most_boxes", [](const Many& v) { return v.all.environment(0).most_boxes(); })
      .def_property_readonly("max_candidates",
                             [](const Many& v) { return v.all.environment(0).settings().max_candidates; })
      .def_property_readonly("reasons",
                             [](const Many& v) {
                               std::vector<std::string> reasons;
                               for (int i = 0; i < v.all.count(); ++i) reasons.emplace_back(v.all.reason(i));
                               return reasons;
                             })
      .def_property_readonly("packed_percent",
                             [](const Many& v) {
                               py::array_t<double> percent(v.all.count());
                               for (int i = 0; i < v.all.count(); ++i)
                                 percent.mutable_data()[i] = v.all.environment(i).packed_percent();
                               return percent;
                             })
      .def_property_readonly("hashes", [](const Many& v) {
        std::vector<std::uint64_t> hashes;
        for (int i = 0; i < v.all.count(); ++i) hashes.push_back(v.all.environment(i).hash());
        return hashes;
      });
}

}  // namespace snug::python
