// ItemsSheet: a table of boxes as people keep it (any order of columns, units, semicolons), made into a CSV of orders.
#include "snug/model/items_sheet.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/model/internal/orders_json.hpp"
#include "snug/model/items_file.hpp"

namespace snug::model {
namespace {

struct SheetUnit {
  std::string_view name;
  double factor;  ///< to mm or kg
};
constexpr std::array<SheetUnit, 4> kLengthUnits = {{{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"in", 25.4}}};
constexpr std::array<SheetUnit, 3> kMassUnits = {{{"kg", 1.0}, {"g", 1e-3}, {"lb", 0.45359237}}};

enum class Quantity { Word, Number, Length, Mass };

struct KnownColumn {
  std::string_view name;  ///< in the CSV of orders
  Quantity quantity;
  std::string_view words;  ///< of headings, small letters, each between blanks
};
constexpr std::string_view kSizeWords =
    " size sizes dimensions dimension lxwxh lxbxh abmessungen abmessung ma\xC3\x9F"
    "e afmetingen ";
constexpr std::array<KnownColumn, 11> kKnownColumns = {{
    {"count", Quantity::Number,
     " count quantity qty pieces pcs amount anzahl menge st\xC3\xBC"
     "ck stueck aantal quantit\xC3\xA9 "},
    {"order", Quantity::Word, " order orders shipment auftrag bestellung sendung opdracht commande "},
    {"article", Quantity::Word,
     " article item sku product name material description artikel produkt bezeichnung omschrijving produit "},
    {"length_mm", Quantity::Length, " length l len long l\xC3\xA4nge laenge lengte longueur "},
    {"width_mm", Quantity::Length, " width w b wide breadth breite breedte largeur "},
    {"height_mm", Quantity::Length, " height h high h\xC3\xB6he hoehe hoogte hauteur "},
    {"size", Quantity::Length, kSizeWords},
    {"mass_kg", Quantity::Mass, " mass weight wt gewicht masse poids "},
    {"upright_only", Quantity::Number, " upright "},
    {"no_stack", Quantity::Number, " stack "},
    {"max_load_kg", Quantity::Mass, " load "},
}};
constexpr std::string_view kSize = "size";

/// Small letters of ASCII and of the capitals with a mark that headings have; words between blanks.
std::vector<std::string> words_of(std::string_view heading) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < heading.size(); ++i) {
    const char c = heading[i];
    const auto byte = static_cast<unsigned char>(c);
    if (c >= 'A' && c <= 'Z') {
      words.back() += static_cast<char>(c - 'A' + 'a');
    } else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      words.back() += c;
    } else if (byte == 0xC3 && i + 1 < heading.size()) {  // U+00C0 to U+00FF: capitals are 32 before small ones
      const auto next = static_cast<unsigned char>(heading[++i]);
      words.back() += c;
      words.back() += static_cast<char>(next <= 0x9E ? next + 0x20U : next);
    } else if (byte >= 0x80) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

bool has_word(std::string_view words, const std::string& word) {
  return words.find(" " + word + " ") != std::string_view::npos;
}

template <std::size_t N>
const SheetUnit* find_unit(const std::array<SheetUnit, N>& units, std::string_view name) {
  const auto found = std::ranges::find(units, name, &SheetUnit::name);
  return found == units.end() ? nullptr : &*found;
}

const SheetUnit* find_unit(Quantity quantity, std::string_view name) {
  if (quantity == Quantity::Length) return find_unit(kLengthUnits, name);
  if (quantity == Quantity::Mass) return find_unit(kMassUnits, name);
  return nullptr;
}

/// A column of the sheet.
struct SheetHeading {
  const KnownColumn* column = nullptr;  ///< nullptr: passed over
  const SheetUnit* unit = nullptr;      ///< nullptr: it says none
};

SheetHeading read_heading(std::string_view text) {
  SheetHeading heading;
  const std::vector<std::string> words = words_of(text);
  // "size (l x w x h)" is one column, "l" another; "max load" and "no stack" before "no", which says nothing.
  const bool is_size =
      std::ranges::any_of(words, [](const std::string& word) { return has_word(kSizeWords, word) || word == "x"; });
  for (const KnownColumn& known : kKnownColumns) {
    if (heading.column != nullptr) break;
    if (is_size ? known.name == kSize
                : std::ranges::any_of(words, [&](const std::string& word) { return has_word(known.words, word); }))
      heading.column = &known;
  }
  // The weight that a carton may hold is not what it weighs.
  const bool is_most =
      std::ranges::any_of(words, [](const std::string& word) { return has_word(" max maximum ", word); });
  if (is_most && heading.column != nullptr && heading.column->name == "mass_kg") heading.column = nullptr;
  if (heading.column == nullptr) return heading;
  for (auto word = words.rbegin(); word != words.rend() && heading.unit == nullptr; ++word)
    heading.unit = find_unit(heading.column->quantity, *word);
  return heading;
}

/// A field as it is written: digits, one unit behind them at most.
struct SheetNumber {
  std::string digits;
  std::string unit;
};

SheetNumber split_number(std::string_view field) {
  const std::size_t end = std::min(field.find_first_not_of("0123456789.,+-' "), field.size());
  SheetNumber number;
  for (const char c : trim(field.substr(0, end)))
    if (c != ' ' && c != '\'') number.digits += c;
  const std::vector<std::string> words = words_of(field.substr(end));
  if (words.size() == 1) number.unit = words[0];
  return number;
}

/// "1,250" and "1.250" may be a thousand or one and a quarter.
bool is_unclear(const std::string& digits) {
  const std::size_t at = digits.find(',');
  if (at == std::string::npos || digits.find('.') != std::string::npos) return false;
  return at >= 1 && at <= 3 && digits.size() == at + 4 && digits.front() != '0';
}

std::optional<double> number_of(std::string digits, bool has_decimal_comma) {
  // A mark that cannot stand between thousands stands before decimals, whatever other numbers of the sheet have.
  const auto is_before_decimals = [&](char mark, char other) {
    const std::size_t at = digits.find(mark);
    return at != std::string::npos && digits.find(other) == std::string::npos &&
           digits.find(mark, at + 1) == std::string::npos && digits.size() != at + 4;
  };
  if (is_before_decimals(',', '.')) has_decimal_comma = true;
  if (is_before_decimals('.', ',')) has_decimal_comma = false;
  const char group = has_decimal_comma ? '.' : ',';
  std::erase(digits, group);
  std::ranges::replace(digits, ',', '.');
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_whole = error == std::errc{} && end == digits.data() + digits.size() && !digits.empty();
  return is_whole ? std::optional(value) : std::nullopt;
}

std::string shortest_text(double value) {
  std::array<char, 40> buffer{};
  const double rounded = std::round(value * 1e6) / 1e6;
  const auto done = std::to_chars(buffer.data(), buffer.data() + buffer.size(), rounded);
  return {buffer.data(), done.ptr};
}

std::string as_field(const std::string& word) {
  if (word.find_first_of(",\"") == std::string::npos) return word;
  std::string quoted = "\"";
  for (const char c : word) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// The line with commas where its separators stood, and blanks for commas within fields without quotes.
std::vector<std::string> split_line(std::string_view line, char separator, const std::string& where) {
  if (separator == ',') return split_csv(line, where);
  std::string changed;
  bool is_quoted = false, begins = true;
  constexpr char kStand = '\x1f';  // stands in for a comma
  for (const char c : line) {
    if (c == '"' && (begins || is_quoted)) is_quoted = !is_quoted;
    if (!is_quoted && c == separator) {
      changed += ',';
      begins = true;
      continue;
    }
    changed += c == ',' && !is_quoted ? kStand : c;
    if (c != ' ') begins = false;
  }
  std::vector<std::string> fields = split_csv(changed, where);
  for (std::string& field : fields) std::ranges::replace(field, kStand, ',');
  return fields;
}

struct SheetTable {
  char separator = ',';
  std::vector<SheetHeading> headings;
  std::vector<std::vector<std::string>> lines;  ///< of fields; an empty one is an empty line
};

char find_separator(std::string_view header) {
  char best = ',';
  for (const char one : {';', '\t'})
    if (std::ranges::count(header, one) > std::ranges::count(header, best)) best = one;
  return best;
}

/// Calls with each line, without its end, and its number from 1.
template <class Call>
void each_line(std::string_view text, Call call) {
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    call(line, number);
  }
}

bool has_orders_header(std::string_view header, const std::string& name) {
  const std::vector<std::string> fields = split_csv(header, name + ":1");
  return std::ranges::all_of(fields, [](const std::string& field) {
    return field != kSize && std::ranges::find(kKnownColumns, field, &KnownColumn::name) != kKnownColumns.end();
  });
}

void check_headings(const std::vector<SheetColumn>& columns, const std::string& name) {
  const auto count_of = [&](std::string_view column) {
    return std::ranges::count_if(columns, [&](const SheetColumn& one) { return one.column == column; });
  };
  std::string known;
  for (const SheetColumn& one : columns) known += (known.empty() ? "" : ", ") + printable(one.heading, 40);
  const bool has_size = count_of(kSize) > 0;
  for (const KnownColumn& one : kKnownColumns) {
    const auto count = count_of(one.name);
    if (count > 1) {
      std::string several;
      for (const SheetColumn& column : columns)
        if (column.column == one.name) several += (several.empty() ? "" : ", ") + printable(column.heading, 40);
      throw InputError(name + ":1", std::string(one.name), "more than one column: " + several, "one");
    }
    const bool is_edge = one.quantity == Quantity::Length && one.name != kSize;
    const bool is_needed = (is_edge && !has_size) || one.name == "mass_kg";
    if (is_needed && count == 0)
      throw InputError(name + ":1", std::string(one.name), "no such column among " + known,
                       "headings such as length, width, height (or size), mass");
    if (is_edge && has_size && count > 0)
      throw InputError(name + ":1", std::string(one.name), "a column beside that of sizes", "one of the two");
  }
}

/// The three edges of "200 x 150 x 100 mm", each with the unit that stands behind them.
std::vector<SheetNumber> edges_of(const std::string& field) {
  std::vector<SheetNumber> edges;
  std::string rest;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const bool is_times = field.compare(i, 2, "\xC3\x97") == 0;
    rest += is_times || field[i] == 'x' || field[i] == 'X' ? '*' : field[i];
    if (is_times) ++i;
  }
  for (std::size_t at = 0; at != std::string::npos;) {
    const std::size_t next = rest.find('*', at);
    edges.push_back(split_number(std::string_view(rest).substr(at, next == std::string::npos ? next : next - at)));
    at = next == std::string::npos ? next : next + 1;
  }
  for (SheetNumber& edge : edges)
    if (edge.unit.empty()) edge.unit = edges.back().unit;
  return edges;
}

/// What the sheet leaves open, found by looking at each number.
class OpenQuestions {
 public:
  explicit OpenQuestions(const SheetAnswers& answers) : answers_(answers) {}

  void look(const SheetHeading& heading, const SheetNumber& number) {
    if (number.digits.empty()) return;
    if (number.digits.find(',') != std::string::npos) {
      if (is_unclear(number.digits)) {
        if (unclear_.empty()) unclear_ = number.digits;
      } else {
        has_comma_ = true;
      }
    }
    if (number.digits.find('.') != std::string::npos && number.digits.find(',') == std::string::npos) has_point_ = true;
    if (heading.unit != nullptr || find_unit(heading.column->quantity, number.unit) != nullptr) return;
    if (heading.column->quantity == Quantity::Length && lengths_.size() < 3) lengths_.push_back(number.digits);
    if (heading.column->quantity == Quantity::Mass && mass_.empty()) mass_ = number.digits;
  }

  /// Whether a comma stands before decimals: it does in some number, and no number has a point alone.
  [[nodiscard]] bool has_decimal_comma() const {
    if (!answers_.decimal.empty()) return answers_.decimal == "comma";
    return has_comma_ && !has_point_;
  }

  [[nodiscard]] std::vector<SheetQuestion> questions() const {
    std::vector<SheetQuestion> all;
    if (!unclear_.empty() && answers_.decimal.empty() && !has_comma_ && !has_point_) {
      SheetQuestion one{"decimal", {}};
      for (const char* answer : {"point", "comma"})
        one.choices.push_back({answer, unclear_ + " is " + shortest_text(*number_of(unclear_, answer[0] == 'c'))});
      all.push_back(std::move(one));
    }
    if (!lengths_.empty() && answers_.length.empty()) {
      SheetQuestion one{"length", {}};
      for (const SheetUnit& unit : kLengthUnits) one.choices.push_back({std::string(unit.name), size_with(unit)});
      all.push_back(std::move(one));
    }
    if (!mass_.empty() && answers_.mass.empty()) {
      SheetQuestion one{"mass", {}};
      for (const SheetUnit& unit : kMassUnits) {
        const std::optional<double> value = number_of(mass_, has_decimal_comma());
        one.choices.push_back({std::string(unit.name), value ? shortest_text(*value * unit.factor) + " kg" : mass_});
      }
      all.push_back(std::move(one));
    }
    return all;
  }

 private:
  [[nodiscard]] std::string size_with(const SheetUnit& unit) const {
    std::string text;
    for (const std::string& digits : lengths_) {
      const std::optional<double> value = number_of(digits, has_decimal_comma());
      text += (text.empty() ? "" : " x ") + (value ? shortest_text(*value * unit.factor) : digits);
    }
    return text + " mm";
  }
  const SheetAnswers& answers_;
  std::vector<std::string> lengths_;  ///< of the first box
  std::string mass_, unclear_;
  bool has_comma_ = false, has_point_ = false;
};

SheetTable read_table(std::string_view text, const std::string& name) {
  SheetTable table;
  each_line(text, [&](std::string_view line, int number) {
    const std::string where = name + ":" + std::to_string(number);
    if (number == 1) {
      table.separator = find_separator(line);
      table.lines.push_back(split_line(line, table.separator, where));
      for (const std::string& field : table.lines.back()) table.headings.push_back(read_heading(field));
    } else if (trim(line).find_first_not_of(",;\t") == std::string_view::npos) {
      table.lines.emplace_back();
    } else {
      table.lines.push_back(split_line(line, table.separator, where));
    }
  });
  return table;
}

/// Calls with each number of the table, edges of one field apart.
template <class Call>
void each_number(const SheetTable& table, Call call) {
  for (std::size_t row = 1; row < table.lines.size(); ++row) {
    const std::vector<std::string>& fields = table.lines[row];
    for (std::size_t k = 0; k < std::min(fields.size(), table.headings.size()); ++k) {
      const SheetHeading& heading = table.headings[k];
      if (heading.column == nullptr || heading.column->quantity == Quantity::Word) continue;
      if (heading.column->name == kSize) {
        for (const SheetNumber& edge : edges_of(fields[k])) call(heading, edge);
      } else {
        call(heading, split_number(fields[k]));
      }
    }
  }
}

/// In mm, kg or as it is; what cannot be read stays.
std::string converted(const SheetHeading& heading, const SheetNumber& number, const std::string& field,
                      const SheetAnswers& answers, bool has_decimal_comma) {
  const Quantity quantity = heading.column->quantity;
  const SheetUnit* unit = find_unit(quantity, number.unit);
  const std::optional<double> value = number_of(number.digits, has_decimal_comma);
  if (!value || (unit == nullptr && !number.unit.empty())) return as_field(field);
  if (unit == nullptr) unit = heading.unit;
  if (unit == nullptr) unit = find_unit(quantity, quantity == Quantity::Length ? answers.length : answers.mass);
  return shortest_text(*value * (unit == nullptr ? 1.0 : unit->factor));
}

std::string write_orders(const SheetTable& table, const SheetAnswers& answers, bool has_decimal_comma) {
  std::string text;
  const auto add = [&](const std::string& field, bool is_first) { text += (is_first ? "" : ",") + field; };
  for (std::size_t row = 0; row < table.lines.size(); ++row) {
    const std::vector<std::string>& fields = table.lines[row];
    bool is_first = true;
    for (std::size_t k = 0; !fields.empty() && k < table.headings.size(); ++k) {
      const SheetHeading& heading = table.headings[k];
      if (heading.column == nullptr) continue;
      const std::string field = k < fields.size() ? fields[k] : std::string();
      if (row == 0) {
        add(heading.column->name == kSize ? "length_mm,width_mm,height_mm" : std::string(heading.column->name),
            is_first);
      } else if (heading.column->quantity == Quantity::Word) {
        add(as_field(field), is_first);
      } else if (heading.column->name == kSize) {
        const std::vector<SheetNumber> edges = edges_of(field);
        for (std::size_t i = 0; i < 3; ++i) {
          const bool is_there = edges.size() == 3;
          add(is_there ? converted(heading, edges[i], edges[i].digits, answers, has_decimal_comma)
              : i == 0 ? as_field(field)
                       : "",
              is_first && i == 0);
        }
      } else {
        add(field.empty() ? field : converted(heading, split_number(field), field, answers, has_decimal_comma),
            is_first);
      }
      is_first = false;
    }
    text += '\n';
  }
  return text;
}

void check_answers(const SheetAnswers& answers) {
  if (!answers.length.empty() && find_unit(Quantity::Length, answers.length) == nullptr)
    throw InputError("sheet", "length", printable(answers.length, 40), "mm, cm, m or in");
  if (!answers.mass.empty() && find_unit(Quantity::Mass, answers.mass) == nullptr)
    throw InputError("sheet", "mass", printable(answers.mass, 40), "kg, g or lb");
  if (!answers.decimal.empty() && answers.decimal != "point" && answers.decimal != "comma")
    throw InputError("sheet", "decimal", printable(answers.decimal, 40), "point or comma");
}

}  // namespace

ItemsSheet read_items_sheet(std::string_view text, const std::string& name, const SheetAnswers& answers) {
  check_answers(answers);
  check_utf8(text, name);
  text = without_byte_order_mark(text);
  while (!text.empty() && (text.front() == '\n' || text.front() == '\r')) text.remove_prefix(1);
  if (trim(text).empty()) throw InputError(name, "", "nothing", "a header and at least one line");
  ItemsSheet sheet;
  const SheetTable table = read_table(text, name);
  for (std::size_t k = 0; k < table.headings.size(); ++k) {
    const KnownColumn* column = table.headings[k].column;
    sheet.columns.push_back(
        {printable(table.lines[0][k], 60), column == nullptr ? std::string() : std::string(column->name)});
  }
  if (table.separator == ',' && has_orders_header(text.substr(0, text.find('\n')), name)) {
    sheet.orders = std::string(text);
    return sheet;
  }
  check_headings(sheet.columns, name);
  OpenQuestions open(answers);
  each_number(table, [&](const SheetHeading& heading, const SheetNumber& number) { open.look(heading, number); });
  sheet.questions = open.questions();
  if (sheet.questions.empty()) sheet.orders = write_orders(table, answers, open.has_decimal_comma());
  return sheet;
}

std::string require_orders(const ItemsSheet& sheet, const std::string& name) {
  if (!sheet.questions.empty()) {
    const SheetQuestion& open = sheet.questions.front();
    const std::string option = open.about == "decimal" ? "--decimal" : "--" + open.about + "-unit";
    std::string choices;
    for (const auto& [answer, meaning] : open.choices)
      choices += (choices.empty() ? "" : ", ") + option + " " + answer + " (" + meaning + ")";
    throw InputError(name, open.about, "a sheet that does not say it", choices);
  }
  (void)parse_orders_csv(sheet.orders, name);  // says where a number is none
  return sheet.orders;
}

}  // namespace snug::model
