// OperatorOrder: what a person decides in the place of the session, as lines of words, and the file that has them.
#include "snug/session/operator.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::session {
namespace {

constexpr std::size_t kLongestOrder = 4096;  // bytes of a line
constexpr std::size_t kMostOrders = 10000;
constexpr std::string_view kAnyItem = "next";
constexpr std::array kActions{OperatorAction::Hold,  OperatorAction::Go,        OperatorAction::Skip,
                              OperatorAction::Place, OperatorAction::Elsewhere, OperatorAction::TakeOut};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

struct Word {
  std::string text;
  bool is_quoted = false;
};

std::vector<Word> split_words(std::string_view text, const std::string& place) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < text.size();) {
    if (is_blank(text[i])) {
      ++i;
      continue;
    }
    if (text[i] == '#' && words.empty()) break;
    Word& word = words.emplace_back();
    word.is_quoted = text[i] == '"';
    if (!word.is_quoted) {
      while (i < text.size() && !is_blank(text[i])) word.text += text[i++];
      continue;
    }
    bool is_closed = false;
    for (++i; i < text.size() && !is_closed; ++i) {
      is_closed = text[i] == '"';
      if (text[i] == '\\' && i + 1 < text.size()) ++i;
      if (!is_closed) word.text += text[i];
    }
    if (!is_closed) throw InputError(place, "", printable(text, 60), "a closing double quote");
  }
  return words;
}

std::string quoted(const std::string& id) {
  const bool is_plain =
      !id.empty() && id != kAnyItem && id.front() != '#' && id.front() != '"' && std::ranges::none_of(id, is_blank);
  if (is_plain) return id;
  std::string text = "\"";
  for (const char c : id) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

OperatorAction action_of(const std::string& word, const std::string& place) {
  std::vector<std::string> names;
  for (const OperatorAction one : kActions) {
    if (word == name_of(one)) return one;
    names.emplace_back(name_of(one));
  }
  const std::string nearest(find_nearest(word, names));
  throw InputError(place, "action", "'" + printable(word, 60) + "'",
                   nearest.empty() ? "hold, go, skip, place, elsewhere or take-out" : "'" + nearest + "'");
}

}  // namespace

const char* name_of(OperatorAction action) {
  switch (action) {
    case OperatorAction::Hold:
      return "hold";
    case OperatorAction::Go:
      return "go";
    case OperatorAction::Skip:
      return "skip";
    case OperatorAction::Place:
      return "place";
    case OperatorAction::Elsewhere:
      return "elsewhere";
    case OperatorAction::TakeOut:
      return "take-out";
  }
  return "";
}

std::optional<OperatorOrder> parse_operator_order(std::string_view text, const std::string& where, int line) {
  const std::string place = where + ":" + std::to_string(line);
  if (text.size() > kLongestOrder)
    throw InputError(place, "", std::to_string(text.size()) + " bytes", "at most " + std::to_string(kLongestOrder));
  if (!is_utf8(text)) throw InputError(place, "", printable(text, 60), "UTF-8");
  const std::vector<Word> words = split_words(text, place);
  if (words.empty()) return std::nullopt;
  if (words.size() < 2)
    throw InputError(place, "", printable(text, 60), "AT ACTION, such as 'next hold' or 'BOX027 skip'");
  OperatorOrder order;
  order.line = line;
  const bool is_any = !words[0].is_quoted && words[0].text == kAnyItem;
  if (!is_any && words[0].text.empty()) throw InputError(place, "item", "''", "the id of an item, or next");
  if (!is_any) order.at = words[0].text;
  order.action = action_of(words[1].text, place);
  const bool takes_more = order.action == OperatorAction::Place || order.action == OperatorAction::TakeOut;
  if (words.size() != (takes_more ? 3U : 2U)) {
    throw InputError(place, name_of(order.action), std::to_string(words.size()) + " words",
                     order.action == OperatorAction::Place     ? "the number of a candidate"
                     : order.action == OperatorAction::TakeOut ? "the id of a packed box"
                                                               : "nothing after it");
  }
  if (order.action == OperatorAction::TakeOut) order.box = words[2].text;
  if (order.action != OperatorAction::Place) return order;
  const std::string& digits = words[2].text;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), order.candidate);
  if (error != std::errc() || end != digits.data() + digits.size() || order.candidate < 1)
    throw InputError(place, "place", "'" + printable(digits, 60) + "'", "the number of a candidate, from 1");
  return order;
}

std::string format_operator_order(const OperatorOrder& order) {
  std::string text = (order.at.empty() ? std::string(kAnyItem) : quoted(order.at)) + " " + name_of(order.action);
  if (order.action == OperatorAction::Place) text += " " + std::to_string(order.candidate);
  if (order.action == OperatorAction::TakeOut) text += " " + quoted(order.box);
  return text;
}

OperatorFile::OperatorFile(const std::filesystem::path& path, std::vector<std::string> items,
                           std::function<void(const std::string&)> warn)
    : name_(path == "-" ? std::string("standard input") : path.string()),
      items_(std::move(items)),
      warn_(std::move(warn)),
      file_(path == "-" ? ::dup(STDIN_FILENO) : ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  struct stat status {};
  if (!file_.is_open() || ::fstat(file_.get(), &status) != 0)
    throw InputError(name_, "", std::strerror(errno), "a file with the operator's orders");
  if (S_ISDIR(status.st_mode)) throw InputError(name_, "", "a folder", "a file with the operator's orders");
  is_stream_ = !S_ISREG(status.st_mode);
  take(!is_stream_);
}

void OperatorFile::expect_known(const OperatorOrder& order) const {
  for (const std::string* id : {&order.at, &order.box}) {
    if (id->empty() || std::ranges::find(items_, *id) != items_.end()) continue;
    const std::string nearest(find_nearest(*id, items_));
    throw InputError(name_ + ":" + std::to_string(order.line), "item", "'" + printable(*id, 60) + "'",
                     nearest.empty() ? "an item of the sequence" : "'" + nearest + "'");
  }
}

void OperatorFile::take(bool is_strict) {
  std::array<char, 4096> buffer{};
  for (;;) {
    pollfd ready{file_.get(), POLLIN, 0};
    if (is_stream_ && ::poll(&ready, 1, 0) <= 0) break;
    const ssize_t count = ::read(file_.get(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0 && is_stream_) said_.is_over = true;
    if (count <= 0) break;
    rest_.append(buffer.data(), static_cast<std::size_t>(count));
    if (rest_.size() > kLongestOrder * kMostOrders) break;
  }
  if (said_.is_over && !rest_.empty()) rest_ += '\n';
  for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
    const std::string text = rest_.substr(0, end);
    rest_.erase(0, end + 1);
    ++lines_;
    try {
      const std::optional<OperatorOrder> order = parse_operator_order(text, name_, lines_);
      if (!order) continue;
      expect_known(*order);
      if (said_.orders.size() < kMostOrders) said_.orders.push_back(*order);
    } catch (const InputError& error) {
      if (is_strict) throw;
      if (warn_) warn_(error.what());
    }
  }
}

OperatorOrders OperatorFile::read() {
  if (!said_.is_over) take(false);
  return said_;
}

}  // namespace snug::session
