// read_orders_json: orders in the JSON form of BED-BPP, read as a stream, so that each complaint has its line.
#include "snug/model/internal/orders_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/model/internal/value.hpp"

namespace snug::model::internal {
namespace {

using nlohmann::json;

constexpr const char* kForm = "a JSON object of orders (BED-BPP)";

/// Reads characters and tells how many were taken: the library itself says where it is only when the text is no JSON.
class CountedIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountedIterator(const char* at, std::size_t* taken) : at_(at), taken_(taken) {}
  reference operator*() const { return *at_; }
  CountedIterator& operator++() {
    ++at_;
    ++*taken_;
    return *this;
  }
  bool operator==(const CountedIterator& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  std::size_t* taken_;
};

/// The numbers that an item must have.
struct Wanted {
  const char* key;
  double low, high;
};
constexpr std::array<Wanted, 4> kWanted = {{{"length/mm", kShortestMm, kLongestMm},
                                            {"width/mm", kShortestMm, kLongestMm},
                                            {"height/mm", kShortestMm, kLongestMm},
                                            {"weight/kg", kLightest, kHeaviest}}};

/// Takes the events of the library's parser. Levels: 0 outside, 1 among orders, 2 in an order, 3 among its items, 4 in
/// an item; what is not asked for is skipped, however deep.
class OrdersReader : public nlohmann::json_sax<json> {
 public:
  OrdersReader(std::string_view text, const std::string& name, const std::size_t& taken)
      : text_(text), name_(name), taken_(taken) {}

  std::vector<OrderLine> finish() {
    std::vector<OrderLine> lines;
    for (auto& [order, items] : orders_)
      for (auto& [number, line] : items) lines.push_back(std::move(line));
    if (lines.empty()) throw InputError(where(), "", "no items", "at least one");
    return lines;
  }

  bool null() override { return value("null"); }
  bool boolean(bool is_true) override { return value(is_true ? "true" : "false"); }
  bool number_integer(json::number_integer_t number) override { return number_value(static_cast<double>(number)); }
  bool number_unsigned(json::number_unsigned_t number) override { return number_value(static_cast<double>(number)); }
  bool number_float(json::number_float_t number, const std::string&) override { return number_value(number); }
  bool binary(json::binary_t&) override { return value("bytes"); }
  bool string(std::string& text) override {
    if (skipped_ == 0 && level_ == 4 && key_ == "id") {
      item_.article = text;
      return true;
    }
    return value(quote(text));
  }
  bool start_array(std::size_t) override {
    if (skipped_ > 0 || is_skippable()) return ++skipped_ > 0;
    return value("a list");
  }
  bool end_array() override { return --skipped_ >= 0; }
  bool start_object(std::size_t) override {
    if (skipped_ > 0 || is_skippable()) return ++skipped_ > 0;
    if (level_ == 4) return value("an object");
    if (++level_ == 4) begin_item();
    if (level_ == 2) has_items_ = false;
    return true;
  }
  bool end_object() override {
    if (skipped_ > 0) return --skipped_ >= 0;
    if (level_ == 4) end_item();
    if (level_ == 2 && !has_items_) {
      throw InputError(name_ + ":" + std::to_string(order_line_), order_, "no item_sequence",
                       "an order with an item_sequence (BED-BPP)");
    }
    --level_;
    return true;
  }
  bool key(std::string& key) override {
    if (skipped_ > 0) return true;
    key_ = key;
    if (level_ == 1) begin_order();
    if (level_ == 2 && key == "item_sequence" && std::exchange(has_items_, true))
      refuse_second(order_ + ".item_sequence");
    if (level_ == 3) number_item();
    if (level_ == 4 && !keys_of_item_.insert(key).second) refuse_second(path());
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const json::exception& error) override {
    const std::string text = error.what();
    const std::size_t colon = text.find(": ");
    throw InputError(where(), "", colon == std::string::npos ? text : text.substr(colon + 2), kForm);
  }

 private:
  /// File and line of what was read last.
  [[nodiscard]] std::string where(std::size_t ahead = 0) {
    const std::size_t end = std::min(taken_ - std::min(ahead, taken_), text_.size());
    line_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(std::min(counted_, end)),
                                         text_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    counted_ = std::max(counted_, end);
    return name_ + ":" + std::to_string(line_);
  }
  [[nodiscard]] std::string path() const {
    if (level_ <= 1) return order_;
    if (level_ == 2) return order_ + "." + key_;
    return order_ + ".item_sequence." + number_ + (level_ == 4 ? "." + key_ : "");
  }
  [[nodiscard]] static const Wanted* find_wanted(const std::string& key) {
    const auto found = std::find_if(kWanted.begin(), kWanted.end(), [&](const Wanted& w) { return key == w.key; });
    return found == kWanted.end() ? nullptr : &*found;
  }
  /// May the value that comes be anything?
  [[nodiscard]] bool is_skippable() const {
    if (level_ == 2) return key_ != "item_sequence";
    return level_ == 4 && find_wanted(key_) == nullptr;
  }
  void refuse_second(const std::string& what) { throw InputError(where(), what, "a second time", "each key once"); }

  bool value(const std::string& got, std::size_t ahead = 0) {
    if (skipped_ > 0 || is_skippable()) return true;
    static constexpr const char* kExpected[] = {kForm, "an order with an item_sequence (BED-BPP)",
                                                "an object of items, counted from 1", "an item"};
    if (level_ < 4) throw InputError(where(ahead), level_ == 0 ? "" : path(), got, kExpected[level_]);
    const Wanted* wanted = find_wanted(key_);
    throw InputError(where(ahead), path(), got,
                     "a number from " + to_text(wanted->low) + " to " + to_text(wanted->high));
  }
  bool number_value(double number) {
    const std::size_t lookahead = 1;  // the library sees the end of a number by the character after it
    const Wanted* wanted = skipped_ == 0 && level_ == 4 ? find_wanted(key_) : nullptr;
    if (wanted == nullptr || !(number >= wanted->low && number <= wanted->high)) {
      return value(to_text(number), lookahead);
    }
    numbers_[static_cast<std::size_t>(wanted - kWanted.data())] = number;
    return true;
  }

  void begin_order() {
    order_ = key_;
    (void)where();
    order_line_ = line_;
    if (!orders_.try_emplace(order_).second) refuse_second(order_);
  }
  void number_item() {
    number_ = key_;
    const auto [end, error] = std::from_chars(number_.data(), number_.data() + number_.size(), position_);
    if (error != std::errc{} || end != number_.data() + number_.size()) {
      throw InputError(where(), order_ + ".item_sequence", quote(number_), "items counted from 1");
    }
    if (orders_[order_].contains(position_)) refuse_second(path());
    if (++boxes_ > kMostBoxes) {
      throw InputError(where(), "", "more than " + std::to_string(kMostBoxes) + " boxes", "fewer");
    }
    (void)where();
    item_line_ = line_;
  }
  void begin_item() {
    item_ = {};
    item_.order = order_;
    item_.line = item_line_;
    numbers_ = {};
    keys_of_item_.clear();
  }
  void end_item() {
    for (std::size_t i = 0; i < kWanted.size(); ++i) {
      if (numbers_[i]) continue;
      throw InputError(name_ + ":" + std::to_string(item_line_),
                       order_ + ".item_sequence." + number_ + "." + kWanted[i].key, "nothing",
                       "a number from " + to_text(kWanted[i].low) + " to " + to_text(kWanted[i].high));
    }
    item_.size = kMillimetre * Vector3(*numbers_[0], *numbers_[1], *numbers_[2]);
    item_.mass = *numbers_[3];
    orders_[order_].emplace(position_, std::move(item_));
  }

  std::string_view text_;
  const std::string& name_;
  const std::size_t& taken_;
  std::size_t counted_ = 0;  ///< characters whose lines are in line_
  int line_ = 1, order_line_ = 1, item_line_ = 1;

  int level_ = 0;
  std::ptrdiff_t skipped_ = 0;  ///< open lists and objects of what is not asked for
  std::string key_, order_, number_;
  bool has_items_ = false;
  long position_ = 0;
  OrderLine item_;
  std::array<std::optional<double>, 4> numbers_;
  std::set<std::string> keys_of_item_;
  std::size_t boxes_ = 0;
  std::map<std::string, std::map<long, OrderLine>> orders_;
};

}  // namespace

std::vector<OrderLine> read_orders_json(std::string_view text, const std::string& name) {
  std::size_t taken = 0;
  OrdersReader reader(text, name, taken);
  (void)json::sax_parse(CountedIterator(text.data(), &taken), CountedIterator(text.data() + text.size(), &taken),
                        &reader);
  return reader.finish();
}

}  // namespace snug::model::internal
