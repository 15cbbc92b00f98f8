// Simulator: the answering side of CLICK: which message is answered by what, and what it does to the cell.
#include "snug/served_cell/simulator.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "snug/core/text.hpp"

namespace snug::served_cell {
namespace {

using click::Control;
using click::decode;
using click::encode;
using click::Error;
using click::HandshakeInit;
using click::kVersion;
using click::Message;
using click::Reset;
using click::SensorRequest;

constexpr const char* kBusy = "another controller drives this cell; only one can at a time";

template <class T>
bool holds(const Message& message) {
  return std::holds_alternative<T>(message);
}

Error unsupported(int version) { return {fmt::format("version {} is not supported, expected {}", version, kVersion)}; }

}  // namespace

Simulator::Simulator(const cell::Simulation& simulation, SimulatorSettings settings)
    : settings_(std::move(settings)),
      cell_(simulation, settings_.cell),
      initial_(simulation.make_state()),
      initial_reading_(simulation.read_still(initial_)),
      switches_(cell_.make_switches()) {}

Simulator::~Simulator() = default;

const cell::CellState& Simulator::state() const { return run_ ? run_->state() : initial_; }
double Simulator::time() const { return cell_.simulation().time(state()); }
std::uint64_t Simulator::hash() const { return cell_.simulation().hash(state()); }
Simulator::Reply Simulator::reply(const Message& message) { return {encode(message), holds<Error>(message)}; }

Simulator::Reply Simulator::sense() {
  return {run_ ? cell_.write_sensor(state(), run_->reading(), run_->tool_load(), written_)
               : cell_.write_sensor(state(), initial_reading_, Wrench{}, written_),
          false};
}

std::optional<std::string> Simulator::answer(const Peer& peer, std::string_view frame) {
  std::optional<Reply> reply = respond(peer, frame);
  if (!reply) return std::nullopt;
  ++counts_.replies;
  if (reply->is_error) ++counts_.errors;
  return std::move(reply->frame);
}

bool Simulator::is_step(const Peer& peer, std::string_view frame) const {
  if ((has_commanded_ && controller_ != peer) || is_watcher(peer)) return false;
  if (is_reset_ || is_ended_ || frame.size() > kLargestFrame) return false;
  const auto message = decode(frame);
  if (!message || !holds<Control>(*message)) return false;
  const auto order = cell_.understand(std::get<Control>(*message), switches_, state());
  return order && order->moves_joints;
}

bool Simulator::is_handshake(std::string_view frame) {
  if (frame.size() > kLargestFrame) return false;
  const auto message = decode(frame);
  return message && holds<HandshakeInit>(*message);
}

bool Simulator::is_control(std::string_view frame) {
  if (frame.size() > kLargestFrame) return false;
  const auto message = decode(frame);
  return message && holds<Control>(*message);
}

std::optional<Simulator::Reply> Simulator::respond(const Peer& peer, std::string_view frame) {
  if (frame.size() > kLargestFrame) {
    return reply(Error{fmt::format("a frame of {} bytes; {} are the most", frame.size(), kLargestFrame)});
  }
  const Expected<Message, std::string> message = decode(frame);
  if (!message) return reply(Error{message.error()});
  if (is_watcher(peer)) return show(*message);
  const auto* command = std::get_if<Control>(&*message);
  if (command != nullptr && controller_ != peer && !has_commanded_) return control_first(peer, *command);
  if (controller_ && *controller_ != peer) {
    return holds<HandshakeInit>(*message) || holds<SensorRequest>(*message) ? show(*message) : reply(Error{kBusy});
  }
  if (const auto* error = std::get_if<Error>(&*message)) {
    end("the controller reported: " + printable(error->text, kLongestMessage));
    clear();
    controller_.reset();
    has_commanded_ = false;
    return std::nullopt;
  }
  if (const auto* init = std::get_if<HandshakeInit>(&*message)) return shake_hands(peer, *init);
  if (is_reset_ && (holds<Control>(*message) || holds<SensorRequest>(*message) || holds<Reset>(*message))) {
    is_reset_ = false;
    return reply(Reset{});
  }
  if (holds<SensorRequest>(*message)) return sense();
  if (holds<Reset>(*message)) {
    end("reset by the controller");
    clear();
    return reply(Reset{});
  }
  if (command != nullptr) return control(*command);
  return reply(Error{fmt::format("a {} is for controllers; this is a simulator", name_of(*message))});
}

Simulator::Reply Simulator::show(const Message& message) {
  if (const auto* init = std::get_if<HandshakeInit>(&message)) {
    return reply(init->version == kVersion ? Message(cell_.handshake()) : Message(unsupported(init->version)));
  }
  if (holds<SensorRequest>(message)) return sense();
  return reply(Error{fmt::format("a {} is for controllers; this peer is an observer", name_of(message))});
}

Simulator::Reply Simulator::shake_hands(const Peer& peer, const HandshakeInit& init) {
  if (init.version != kVersion) return reply(unsupported(init.version));
  take_place(peer);
  return reply(cell_.handshake());
}

void Simulator::take_place(const Peer& peer) {
  controller_ = peer;
  has_commanded_ = false;
  is_reset_ = false;
  if (!failure_.empty()) end(failure_);  // a stop that nobody acknowledged
  if (is_ended_) clear();
  command_.reset();  // nothing moves before the first Control
}

Simulator::Reply Simulator::control_first(const Peer& peer, const Control& command) {
  // One that means nothing takes no place.
  const Expected<Order, std::string> order = cell_.understand(command, switches_, state());
  if (!order) return reply(Error{order.error()});
  take_place(peer);
  return control(command);
}

Simulator::Reply Simulator::control(const Control& control) {
  if (is_ended_) return reply(Error{failure_});
  has_commanded_ = true;
  Expected<Order, std::string> order = cell_.understand(control, switches_, state());
  if (!order) return reply(Error{order.error()});
  if (!run_) begin_run();
  if (!knows_who_feeds_) {
    knows_who_feeds_ = true;
    if (!order->names_feeding) feeder_.emplace();
  }
  if (!failure_.empty() && !order->acknowledges) return reply(Error{failure_});
  switches_ = order->switches;
  take_at_once(*order);
  if (!order->moves_joints) return sense();
  if (settings_.is_async) {
    command_ = std::move(order->command);
    silent_steps_ = 0;
    return sense();
  }
  advance(order->command);
  if (!failure_.empty()) return reply(Error{failure_});
  Reply sensed = sense();
  if (settings_.batch && time() >= *settings_.batch) reset(fmt::format("{} s are over", *settings_.batch));
  return sensed;
}

void Simulator::take_at_once(const Order& order) {
  if (order.acknowledges) {
    run_->acknowledge();
    failure_.clear();
  }
  if (order.stands) {
    run_->stand();
    if (command_) command_ = cell_.stand(order.command.cup);
  }
  if (order.item < 0) return;
  if (order.moves_joints) {
    (void)run_->feed(order.item, order.quarter);
  } else {  // as a plant brings it: what lies where it comes is taken away
    run_->bring(order.item, order.quarter);
  }
}

void Simulator::begin_run() {
  ++counts_.runs;
  run_ = std::make_unique<runs::OutsideRun>(
      cell_.simulation(), settings_.begin_run ? settings_.begin_run(counts_.runs) : runs::OutsideRunOptions{});
}

void Simulator::advance(const cell::OutsideCommand& command) {
  if (feeder_) {
    const int item = feeder_->next(cell_.simulation(), run_->state());
    if (item >= 0) {
      (void)run_->feed(item, 0);
      feeder_->advance();
    }
  }
  ++counts_.steps;
  const auto start = std::chrono::steady_clock::now();
  const cell::CellTick& tick = run_->advance(command);
  step_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!tick.failure) return;
  failure_ = tick.failure.text;
  if (!settings_.cell.is_plant || !run_->is_stopped_for_protection()) end(failure_);
}

bool Simulator::is_running() const {
  const bool is_on = settings_.runs_at_once || (run_ && command_);
  return settings_.is_async && !is_ended_ && failure_.empty() && is_on;
}

void Simulator::step() {
  if (!is_running()) return;
  if (!run_) begin_run();
  const bool is_silent = static_cast<double>(silent_steps_++) * cell_.handshake().time_step >= kPatience;
  advance(!command_ ? cell_.stand({}) : is_silent ? cell_.stand(command_->cup) : *command_);
  if (settings_.batch && !is_ended_ && time() >= *settings_.batch) {
    reset(fmt::format("{} s are over", *settings_.batch));
  }
}

bool Simulator::leave(const Peer& peer, const std::string& why) {
  if (controller_ != peer) return false;
  end(why);
  clear();
  controller_.reset();
  has_commanded_ = false;
  is_reset_ = false;
  return true;
}

void Simulator::reset(const std::string& why) {
  end("reset: " + why);
  clear();
  is_reset_ = controller_.has_value();
}

void Simulator::end(const std::string& why) {
  if (!run_ || is_ended_) return;
  is_ended_ = true;
  const runs::RunResult result = run_->finish(why);
  if (settings_.end_run) settings_.end_run(counts_.runs, result);
}

void Simulator::clear() {
  run_.reset();
  is_ended_ = false;
  failure_.clear();
  switches_ = cell_.make_switches();
  feeder_.reset();
  knows_who_feeds_ = false;
  command_.reset();
}

}  // namespace snug::served_cell
