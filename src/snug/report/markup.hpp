// Markup: a piece of a page. Text becomes markup by being escaped, in no other way: no name can break out of a page.
#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace snug::report {

namespace internal {
class Raw;
}

/// HTML that is whole and well-formed by itself.
class Markup {
 public:
  Markup() = default;
  /// Escapes. Implicit on purpose: wherever markup is wanted, text may stand.
  template <class Text>
  requires std::convertible_to<const Text&, std::string_view> Markup(const Text& text) : Markup(escaped(text)) {}

  [[nodiscard]] const std::string& html() const { return html_; }
  [[nodiscard]] bool is_empty() const { return html_.empty(); }
  Markup& operator+=(const Markup& other);
  friend Markup operator+(Markup first, const Markup& second) { return first += second; }
  bool operator==(const Markup&) const = default;

 private:
  friend class internal::Raw;
  [[nodiscard]] static Markup escaped(std::string_view text);
  std::string html_;
};

/// `level`: 1 (the page's own, which make_page() writes) to 4.
[[nodiscard]] Markup heading(int level, const Markup& content);
[[nodiscard]] Markup paragraph(const Markup& content);
[[nodiscard]] Markup bold(const Markup& content);
/// Of less weight: a deviation behind a mean, a remark.
[[nodiscard]] Markup small(const Markup& content);
/// A word or a command; breaks anywhere.
[[nodiscard]] Markup code(std::string_view text);
/// Lines as they are.
[[nodiscard]] Markup preformatted(std::string_view text);
[[nodiscard]] Markup line_break();
/// `path`: of a file, from the folder of the page.
[[nodiscard]] Markup link(std::string_view path, const Markup& content);
/// Opens when its summary is pressed; always open when printed.
[[nodiscard]] Markup details(const Markup& summary, const Markup& content);
[[nodiscard]] Markup section(const Markup& content);
[[nodiscard]] Markup figure(const Markup& caption, const Markup& drawing);
/// An SVG document as a picture of its own: its parts cannot be taken for those of the page.
[[nodiscard]] Markup picture(std::string_view alternative, const std::string& svg);
/// Beside each other as far as the width allows.
[[nodiscard]] Markup side_by_side(const std::vector<Markup>& parts);
/// The same of narrow frames of equal width.
[[nodiscard]] Markup cards(const std::vector<Markup>& parts);
/// A number for which there was no measurement.
[[nodiscard]] Markup not_available();
/// With so many decimals; n.a. where it is not finite.
[[nodiscard]] Markup number(double value, int decimals);
/// "4.31 +- 0.12"; without the latter where `deviation` is not finite.
[[nodiscard]] Markup number(double value, double deviation, int decimals);

/// What somebody who reads one line of a page reads.
struct KeyFigure {
  std::string label;  ///< "filling degree"
  std::string value;  ///< "74.2 %"
  std::string note;   ///< "12 of 15 boxes that came, 16 ordered", or empty
};
[[nodiscard]] Markup key_figures(const std::vector<KeyFigure>& figures);

}  // namespace snug::report
