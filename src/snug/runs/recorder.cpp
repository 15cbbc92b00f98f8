// Recorder: turns the state of a running cell into frames of a recording.
#include "snug/runs/recorder.hpp"

#include <algorithm>

namespace snug::runs {
namespace {

using cell::CellWorld;

record::ShapeInfo shape_info(const physics::Geom& geom) {
  record::ShapeInfo info;
  info.X_BG = geom.X_BG;
  if (const auto* box = std::get_if<geometry::Box>(&geom.shape)) {
    info.kind = record::ShapeKind::Box;
    info.half = box->half;
  } else if (const auto* capsule = std::get_if<geometry::Capsule>(&geom.shape)) {
    info.kind = record::ShapeKind::Capsule;
    info.radius = capsule->radius;
    info.half_length = capsule->half_length;
  } else if (const auto* cylinder = std::get_if<geometry::Cylinder>(&geom.shape)) {
    info.kind = record::ShapeKind::Cylinder;
    info.radius = cylinder->radius;
    info.half_length = cylinder->half_length;
  } else {
    info.kind = record::ShapeKind::Hull;
    info.vertices = std::get<geometry::ConvexHull>(geom.shape).vertices;
  }
  return info;
}

record::BodyKind kind_of(physics::BodyKind kind) {
  switch (kind) {
    case physics::BodyKind::Static:
      return record::BodyKind::Static;
    case physics::BodyKind::Kinematic:
      return record::BodyKind::Kinematic;
    case physics::BodyKind::Dynamic:
      break;
  }
  return record::BodyKind::Dynamic;
}

record::RecordingHeader header_of(const model::Scenario& scenario, const CellWorld& world, const RecorderSetup& setup) {
  record::RecordingHeader header;
  header.scenario_text = scenario.source_text;
  header.program_text = setup.program_text;
  header.program_name = setup.program_name;
  header.sequence = setup.sequence;
  header.seed = scenario.seed;
  header.version = setup.version;
  header.settings = setup.settings_json;
  header.dt = scenario.time_step;
  header.record_period = setup.period;
  header.joints = setup.joints;
  for (std::size_t i = 0; i < world.model.bodies.size(); ++i) {
    const physics::BodyModel& body = world.model.bodies[i];
    record::BodyInfo info;
    info.name = body.name;
    info.type = world.types[i];
    info.kind = kind_of(body.kind);
    if (body.kind == physics::BodyKind::Dynamic) info.mass = body.inertia.mass;
    info.com = body.inertia.com;
    for (const physics::Geom& geom : body.geoms) info.shapes.push_back(shape_info(geom));
    header.bodies.push_back(std::move(info));
  }
  if (const model::Container* container = model::find_container(scenario, scenario.target)) {
    header.container.name = container->name;
    header.container.X_WT = container->X_WT;
    header.container.inner_size = container->inner_size;
  }
  return header;
}

record::ContactSample contact_sample(const physics::ContactReport& contact) {
  record::ContactSample sample;
  sample.body_a = contact.a.index;
  sample.body_b = contact.b.index;
  sample.p_WQ = contact.p_WQ;
  sample.n_AB_W = contact.n_AB_W;
  sample.force_B_W = contact.force_W;
  sample.phi = contact.phi;
  sample.state = contact.force_W.isZero(0.0) ? record::ContactState::Open
                 : contact.slides            ? record::ContactState::Sliding
                                             : record::ContactState::Sticking;
  return sample;
}

void fill_cup(const CellWorld& world, const physics::WorldState& state, const FrameInput& input,
              record::CupSample& cup) {
  cup = record::CupSample{};
  cup.vacuum_command = input.command.vacuum;
  cup.blow_off_command = input.command.blow_off;
  if (input.gripper == nullptr) return;
  cup.pressure_gauge = input.gripper->cup.pressure_gauge;
  cup.attached_body = input.gripper->cup.body;
  if (cup.attached_body < 0) return;
  const Pose X_ES = input.X_WE.inverse() * (physics::pose_of(world.model, state, physics::BodyId{cup.attached_body}) *
                                            input.gripper->cup.X_PS);
  cup.X_ES = X_ES;
  cup.length = X_ES.p.z();
  cup.bend = cup::bend_angle(X_ES.R);
  cup.F_PSo_S = input.gripper->F_S;
}

bool is_asleep(const CellWorld& world, const physics::WorldState& state, int body) {
  const physics::BodyState& now = state.bodies[static_cast<std::size_t>(body)];
  return world.model.bodies[static_cast<std::size_t>(body)].kind == physics::BodyKind::Dynamic && now.is_present &&
         now.sleep_group >= 0;
}

/// A static body, or a kinematic one that is not being moved.
bool is_still(const CellWorld& world, const physics::WorldState& state, int body) {
  const physics::BodyState& now = state.bodies[static_cast<std::size_t>(body)];
  return world.model.bodies[static_cast<std::size_t>(body)].kind != physics::BodyKind::Dynamic && now.is_present &&
         now.velocity.isZero(0.0) && now.angular_velocity.isZero(0.0);
}

}  // namespace

Recorder::Recorder(const model::Scenario& scenario, const CellWorld& world, const RecorderSetup& setup)
    : observer_(setup.observer) {
  const record::RecordingHeader header = header_of(scenario, world, setup);
  if (setup.file != nullptr) {
    writer_.emplace(std::move(*setup.file), header,
                    setup.program_grows ? record::ProgramText::Grows : record::ProgramText::Known);
  } else if (!setup.path.empty()) {
    writer_.emplace(setup.path, header);
  }
  if (observer_ != nullptr) observer_->begin(header);
}

void Recorder::add_events(const std::vector<record::Event>& events) {
  for (; recorded_events_ < events.size(); ++recorded_events_) {
    const record::Event& event = events[recorded_events_];
    if (writer_) writer_->append(event);
    if (observer_ != nullptr) observer_->add(event);
  }
}

void Recorder::append_program(std::string_view lines) {
  if (writer_) writer_->append_program(lines);
}

void Recorder::close(const std::string& result_json, bool is_interrupted) {
  if (writer_) writer_->close(result_json, is_interrupted ? record::RunEnd::Interrupted : record::RunEnd::Complete);
}

void Recorder::add_contacts(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work) {
  frame_.contacts.clear();
  for (const physics::ContactReport& contact : work.contacts()) frame_.contacts.push_back(contact_sample(contact));
  for (const record::ContactSample& contact : contacts_) {
    const bool is_asleep_a = is_asleep(world, state, contact.body_a);
    const bool is_asleep_b = is_asleep(world, state, contact.body_b);
    const bool is_held = (is_asleep_a && (is_asleep_b || is_still(world, state, contact.body_b))) ||
                         (is_asleep_b && is_still(world, state, contact.body_a));
    if (is_held) frame_.contacts.push_back(contact);
  }
  contacts_ = frame_.contacts;
}

bool Recorder::add_frame(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                         const physics::StepReport& report, const FrameInput& input) {
  frame_.time = state.time(world.model);
  frame_.step = state.step_index;
  frame_.program_row = input.program_row;
  frame_.X_WE = input.X_WE;
  frame_.V_WE = input.V_WE;
  frame_.X_WE_command = input.X_WE_command;
  fill_cup(world, state, input, frame_.cup);
  frame_.bodies.resize(state.bodies.size());
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const physics::BodyId id{static_cast<int>(i)};
    record::BodySample& body = frame_.bodies[i];
    body.present = state.bodies[i].is_present;
    body.X_WB = record::PoseSample(physics::pose_of(world.model, state, id).p, state.bodies[i].quat_WB);
    body.V_WB = physics::twist_of(world.model, state, id);
  }
  add_contacts(world, state, work);
  Wrench F_E_W;  // on the tool, about the origin of E
  for (const record::ContactSample& contact : frame_.contacts) {
    const double sign = contact.body_b == world.tool.index ? 1.0 : contact.body_a == world.tool.index ? -1.0 : 0.0;
    F_E_W.force += sign * contact.force_B_W;
    F_E_W.torque += (contact.p_WQ - input.X_WE.p).cross(sign * contact.force_B_W);
  }
  frame_.F_flange.force = input.X_WE.R.transpose() * F_E_W.force;
  frame_.F_flange.torque = input.X_WE.R.transpose() * F_E_W.torque;
  if (frame_.cup.attached_body >= 0) {  // the reaction of the cup
    const Pose X_ES = frame_.cup.X_ES.pose();
    const Vector3 force = -(X_ES.R * frame_.cup.F_PSo_S.force);
    frame_.F_flange.force += force;
    frame_.F_flange.torque += X_ES.p.cross(force) - X_ES.R * frame_.cup.F_PSo_S.torque;
  }
  if (input.arm != nullptr) {
    frame_.F_flange = input.arm->F_sensor;
    frame_.joints = input.arm->joints;
    for (const physics::ContactReport& contact : input.arm->contacts)
      frame_.contacts.push_back(contact_sample(contact));
  }
  frame_.solver.residual = report.residual;
  frame_.solver.iterations = report.sweeps;
  frame_.solver.status = report.contacts == 0                              ? record::SolverStatus::NothingToSolve
                         : report.status == physics::StepStatus::Converged ? record::SolverStatus::Converged
                                                                           : record::SolverStatus::NotConverged;
  if (writer_) writer_->append(frame_);
  return observer_ == nullptr || observer_->add(frame_);
}

}  // namespace snug::runs
