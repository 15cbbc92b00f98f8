// LiveRun: stands between a simulation and those who watch it: paces it, pauses it, and keeps what they are to be told.
#include "snug/serve/live_run.hpp"

#include <nlohmann/json.hpp>

#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"
#include "snug/serve/internal/live_form.hpp"

namespace snug::serve {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kFlushPeriod(50);  // twenty pictures a second
constexpr double kMaxLag = 0.25;                       // s, that the run may be late before its clock is set anew

std::string form_of(const replay::HeaderInput& input, replay::FrameCoder& coder) {
  return replay::encode_form(replay::make_header_json(input), coder.finish());
}

}  // namespace

LiveRun::LiveRun(std::string name, double speed) : name_(std::move(name)), speed_(speed) {}

void LiveRun::log(const char* event, const std::string& data) {
  auto text = std::make_shared<const std::string>(internal::server_event(event, data));
  log_bytes_ += text->size();
  log_.push_back(std::move(text));
  changed_.notify_all();
}

void LiveRun::log_state() { log("state", Json({{"paused", is_paused_}, {"time", time_}}).dump()); }

void LiveRun::begin(const record::RecordingHeader& header) {
  const std::lock_guard lock(mutex_);
  if (is_over_) forget();
  header_ = header;
  whole_.emplace(header);
  batch_.emplace(header);
}

/// The run that is over: another one begins.
void LiveRun::forget() {
  ++run_;
  last_end_ = log_.back();
  log_.clear();
  log_bytes_ = 0;
  events_.clear();
  batch_events_.clear();
  time_ = 0.0;
  steps_ = 0;
  is_over_ = false;
  changed_.notify_all();
}

void LiveRun::add(const record::Event& event) {
  const std::lock_guard lock(mutex_);
  events_.push_back(event);
  batch_events_.push_back(event);
}

bool LiveRun::add(const record::Frame& frame) {
  std::unique_lock lock(mutex_);
  if (log_.empty()) {
    log("header", internal::header_data(name_, header_, frame));
    origin_ = last_flush_ = Clock::now();
    if (is_paused_) log_state();
  }
  time_ = frame.time;
  whole_->add(frame);
  batch_->add(frame);
  if (Clock::now() - last_flush_ >= kFlushPeriod) flush();
  return wait_for_turn(lock);
}

void LiveRun::flush() {
  last_flush_ = Clock::now();
  if (batch_->frames() == 0) return;
  log("frames", internal::frames_data(*batch_, batch_events_));
  batch_events_.clear();
}

bool LiveRun::wait_for_turn(std::unique_lock<std::mutex>& lock) {
  const auto may_pass = [&] { return is_stopped_ || !is_paused_ || steps_ > 0; };
  if (!may_pass()) {
    flush();
    changed_.wait(lock, may_pass);
  }
  if (steps_ > 0) --steps_;
  if (speed_ > 0.0 && !is_paused_ && !is_stopped_) {
    const auto due =
        origin_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time_ / speed_));
    const auto now = Clock::now();
    if (now - due > std::chrono::duration<double>(kMaxLag)) origin_ += now - due;
    changed_.wait_until(lock, due, [&] { return is_stopped_ || is_paused_; });
  }
  return !is_stopped_ && log_bytes_ < kMaxLogBytes;
}

void LiveRun::finish(const std::string& result_json, const std::string& failure, bool is_interrupted) {
  const std::lock_guard lock(mutex_);
  if (is_over_) return;
  if (whole_ && whole_->frames() > 0) {
    flush();
    const replay::HeaderInput input{name_,           &header_,         events_,       result_json,
                                    !is_interrupted, whole_->frames(), is_interrupted};
    whole_form_ = std::make_shared<const std::string>(form_of(input, *whole_));
  }
  is_over_ = true;
  const bool is_full = log_bytes_ >= kMaxLogBytes;
  log("end", Json({{"failure", is_full ? "the run is too long to be watched to its end" : failure}}).dump());
}

void LiveRun::pause() {
  const std::lock_guard lock(mutex_);
  if (is_paused_ || is_over_) return;
  is_paused_ = true;
  if (!log_.empty()) log_state();
  changed_.notify_all();
}

void LiveRun::resume() {
  const std::lock_guard lock(mutex_);
  if (!is_paused_ || is_over_) return;
  is_paused_ = false;
  steps_ = 0;
  if (speed_ > 0.0) {
    origin_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time_ / speed_));
  }
  if (!log_.empty()) log_state();
  changed_.notify_all();
}

void LiveRun::step() {
  const std::lock_guard lock(mutex_);
  if (!is_paused_ || is_over_) return;
  ++steps_;
  changed_.notify_all();
}

void LiveRun::stop() {
  const std::lock_guard lock(mutex_);
  is_stopped_ = true;
  changed_.notify_all();
}

std::shared_ptr<const std::string> LiveRun::wait_for(std::size_t index, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [&] { return index < log_.size(); });
  return index < log_.size() ? log_[index] : nullptr;
}

std::shared_ptr<const std::string> LiveRun::next(Place& place, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (place.run == 0) place.run = run_;
  changed_.wait_for(lock, patience, [&] { return place.run != run_ || place.index < log_.size(); });
  if (place.run != run_) {
    place = {run_, 0};
    return last_end_;
  }
  return place.index < log_.size() ? log_[place.index++] : nullptr;
}

bool LiveRun::is_paused() const {
  const std::lock_guard lock(mutex_);
  return is_paused_;
}

bool LiveRun::is_over() const {
  const std::lock_guard lock(mutex_);
  return is_over_;
}

std::shared_ptr<const std::string> LiveRun::whole_form() const {
  const std::lock_guard lock(mutex_);
  return whole_form_;
}

}  // namespace snug::serve
