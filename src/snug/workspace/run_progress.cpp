// RunProgress: how far a run has come, by the log of events that `snug pack --log` writes while it goes on.
#include "snug/workspace/run_progress.hpp"

#include <algorithm>
#include <array>
#include <variant>

#include "snug/core/text.hpp"

namespace snug::workspace {
namespace {

/// Of events that ProgressFold makes nothing of.
constexpr std::array<std::string_view, 12> kPassedOver = {
    "stepped",        "item brought", "perceived",  "planned",  "plan dropped", "sent",
    "motion started", "motion ended", "send ended", "assessed", "remedied",     "repacked"};

/// Of a line as format_event() writes it.
bool is_passed_over(std::string_view line) {
  constexpr std::string_view kBegin = "{\"event\":\"";
  if (!line.starts_with(kBegin) || !line.ends_with('}')) return false;
  const std::string_view kind = line.substr(kBegin.size(), line.find('"', kBegin.size()) - kBegin.size());
  return std::ranges::find(kPassedOver, kind) != kPassedOver.end();
}

bool is_lost(session::ItemEnd end) { return end == session::ItemEnd::Left || end == session::ItemEnd::Gone; }

}  // namespace

void ProgressFold::add(const session::SessionEvent& one) {
  fold_.add(one);
  if (const auto* started = std::get_if<session::event::SessionStarted>(&one)) {
    said_.sequence = started->sequence;
    said_.agent = started->agent;
    said_.plant = started->plant;
    said_.items = static_cast<int>(started->items.size());
    ids_.clear();
    for (const model::ParcelId& id : started->items) ids_.push_back(id.value);
  } else if (const auto* counted = std::get_if<session::event::Counted>(&one)) {
    said_.planned_percent = counted->planned_percent;
    said_.time = counted->time;
  } else if (const auto* begun = std::get_if<session::event::ItemStarted>(&one)) {
    if (!begun->because_of) said_.now = ids_[begun->item.slot()];
  } else if (const auto* done = std::get_if<session::event::ItemEnded>(&one)) {
    if (said_.now == ids_[done->item.slot()]) said_.now = said_.held = "";
  } else if (const auto* operated = std::get_if<session::event::Operated>(&one)) {
    const bool is_hold = operated->order.ends_with(" hold") && operated->was_followed;
    const bool is_end = operated->order.ends_with(" go") || operated->order.ends_with(" skip");
    if (is_hold || is_end) said_.held = is_hold ? said_.now : std::string();
  } else if (const auto* stopped = std::get_if<session::event::Stopped>(&one)) {
    said_.stopped = stopped->text;
  } else if (const auto* ended = std::get_if<session::event::SessionEnded>(&one)) {
    said_.is_over = true;
    said_.now = said_.held = "";
    said_.time = ended->time;
    said_.failure = ended->text;
  }
}

RunProgress ProgressFold::progress() const {
  RunProgress progress = said_;
  for (const session::ItemReport& item : fold_.result().items) {
    ++progress.done;
    progress.packed += item.is_packed() ? 1 : 0;
    progress.lost += is_lost(item.end) ? 1 : 0;
    progress.boxes.push_back({item.id, session::name_of(item.end), item.reason, item.is_packed()});
  }
  return progress;
}

void LogReader::read(const Folder& folder, const std::string& name) {
  if (folder.size(name) < offset_) *this = {};  // begun anew
  const std::string text = folder.read_from(name, offset_);
  bool is_new = false;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    ++lines_;
    if (!is_passed_over(line)) {
      check_utf8(line, name);
      const session::SessionEvent one = session::parse_event(line, name, lines_);
      order_.add(one, name + ":" + std::to_string(lines_));
      fold_.add(one);
      is_new = true;
    }
    offset_ += line.size() + 1;
  }
  if (is_new) progress_ = fold_.progress();
}

RunProgress progress_of(const session::EventLog& log) {
  ProgressFold fold;
  for (const session::SessionEvent& one : log.events) fold.add(one);
  return fold.progress();
}

RunProgress read_progress(std::string_view text, const std::string& name) {
  return progress_of(session::parse_log(text, name));
}

}  // namespace snug::workspace
