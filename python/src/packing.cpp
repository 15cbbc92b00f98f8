// Packing agents: the built-in ones, item by item, without a cell.
#include <fmt/format.h>

#include "core.hpp"
#include "handles.hpp"
#include "snug/core/input_error.hpp"
#include "snug/packing/agent.hpp"

namespace snug::python {
namespace {

const packing::ContainerState& container_of(const model::Scenario& scenario, packing::ContainerState& made) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) throw InputError(scenario.source_name, "target", "nothing", "a container to be packed");
  return made = packing::make_container_state(*container);
}

std::vector<packing::Item> items_of(const model::Scenario& scenario, const std::string& name) {
  const model::Sequence* sequence = model::find_sequence(scenario, name);
  if (sequence == nullptr)
    throw InputError(scenario.source_name, "sequence", "'" + name + "'", "one of the scenario's");
  return packing::make_items(scenario, *sequence);
}

py::dict as_dict(const packing::Candidate& candidate) {
  const packing::Orientation& orientation = candidate.placement.orientation;
  py::dict dict;
  dict["item"] = candidate.placement.item;
  dict["pose"] = as_array(candidate.placement.X_TP);
  dict["up"] = std::string(1, "XYZ"[static_cast<int>(orientation.up)]);
  dict["up_sign"] = orientation.up_sign;
  dict["yaw_quarter"] = orientation.yaw_quarter;
  dict["flips"] = candidate.placement.flips;
  dict["score"] = candidate.score;
  dict["expected_percent"] = candidate.expected_percent;
  dict["support"] = candidate.support;
  return dict;
}

/// An agent and the container that it packs without executing anything.
class Packer {
 public:
  Packer(const ScenarioHandle& scenario, const std::string& agent, const std::string& sequence, std::uint64_t seed,
         double decision_time)
      : scenario_(scenario) {
    (void)container_of(**scenario_, state_);
    packing::AgentInput input;
    input.settings = (**scenario_).packing;
    input.run.seed = seed;
    input.run.time = decision_time;
    input.future = packing::make_future_model(**scenario_);
    if (!sequence.empty()) input.sequence = items_of(**scenario_, sequence);
    agent_ = packing::make_agent(agent, std::move(input));
  }
  /// Candidates, best first; a word when there is none.
  py::object decide(const std::string& parcel) {
    const packing::Item item = find(parcel);
    const Use use(busy_);
    Expected<packing::Decision, packing::NoPlace> decision = [&] {
      const py::gil_scoped_release release;
      return agent_->decide(state_, item);
    }();
    if (!decision) return py::str(std::string(packing::describe(decision.error())));
    decided_ = std::move(*decision);
    py::list list;
    for (const packing::Candidate& candidate : decided_.candidates) list.append(as_dict(candidate));
    return list;
  }
  void place(const std::string& parcel, int candidate) {
    const Use use(busy_);
    const auto index = static_cast<std::size_t>(candidate);
    if (candidate < 0 || index >= decided_.candidates.size() || decided_.candidates[index].placement.item != parcel)
      throw InputError("argument", "candidate", std::to_string(candidate), "an index of what decide() returned last");
    state_ = packing::with_candidate(std::move(state_), find(parcel), decided_.candidates[index]);
    decided_ = {};
  }
  [[nodiscard]] const packing::ContainerState& state() const { return state_; }

 private:
  [[nodiscard]] packing::Item find(const std::string& parcel) const {
    model::Item item;
    item.parcel = parcel;
    return packing::make_item(**scenario_, item);
  }
  ScenarioHandle scenario_;
  packing::ContainerState state_;
  std::unique_ptr<packing::Agent> agent_;
  packing::Decision decided_;
  std::atomic<bool> busy_{false};
};

}  // namespace

void bind_packing(py::module_& m) {
  m.def("agent_names", &packing::agent_names);
  py::class_<Packer>(m, "Packer")
      .def(py::init<const ScenarioHandle&, const std::string&, const std::string&, std::uint64_t, double>(),
           py::arg("scenario"), py::arg("agent") = "contact-aware", py::kw_only(), py::arg("sequence") = "",
           py::arg("seed") = 1, py::arg("decision_time") = packing::DecisionRun{}.time)
      .def("decide", &Packer::decide, py::arg("parcel"))
      .def("place", &Packer::place, py::arg("parcel"), py::arg("candidate") = 0)
      .def("__repr__",
           [](const Packer& p) {
             return fmt::format("<snug.Packer: {} boxes, {:.1f} % of the container>", p.state().boxes.size(),
                                packing::filling_percent(p.state()));
           })
      .def_property_readonly("percent", [](const Packer& p) { return packing::filling_percent(p.state()); })
      .def("boxes", [](const Packer& p) {
        py::list list;
        for (const packing::PlacedBox& box : p.state().boxes) {
          py::dict entry;
          entry["id"] = box.item.id;
          entry["size"] = as_array(box.item.size);
          entry["pose"] = as_array(box.X_TP);
          list.append(entry);
        }
        return list;
      });
}

}  // namespace snug::python
