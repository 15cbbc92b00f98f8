// tokens_of: words, numbers, strings and symbols of a program.
#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>

#include "snug/urscript/internal/code.hpp"

namespace snug::urscript::internal {
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {}

  std::vector<Token> all() {
    while (at_ < text_.size()) next();
    add(Token::Kind::NewLine, "");
    add(Token::Kind::End, "");
    return std::move(tokens_);
  }

 private:
  [[nodiscard]] int column() const { return static_cast<int>(at_ - line_begin_) + 1; }
  Token& add(Token::Kind kind, std::string text) {
    tokens_.push_back({kind, std::move(text), 0.0, false, line_, column()});
    return tokens_.back();
  }
  [[noreturn]] void fail(std::string text) const { throw ParseFault{{line_, column(), std::move(text)}}; }

  void next() {
    const char c = text_[at_];
    if (c == '\n') {
      if (depth_ == 0) add(Token::Kind::NewLine, "");
      ++at_;
      ++line_;
      line_begin_ = at_;
    } else if (c == ' ' || c == '\t' || c == '\r') {
      ++at_;
    } else if (c == '#' || (c == '$' && is_line_begin())) {
      while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    } else if (c == '"' || c == '\'') {
      string(c);
    } else if (std::isdigit(static_cast<unsigned char>(c)) != 0 ||
               (c == '.' && at_ + 1 < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_ + 1])) != 0)) {
      number();
    } else if (is_word(c)) {
      const std::size_t begin = at_;
      std::size_t end = at_;
      while (end < text_.size() && is_word(text_[end])) ++end;
      add(Token::Kind::Name, std::string(text_.substr(begin, end - begin)));
      at_ = end;
    } else {
      symbol();
    }
  }

  [[nodiscard]] bool is_line_begin() const { return tokens_.empty() || tokens_.back().kind == Token::Kind::NewLine; }

  void string(char quote) {
    Token& token = add(Token::Kind::String, "");
    for (++at_; at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n'; ++at_) token.text += text_[at_];
    if (at_ >= text_.size() || text_[at_] != quote) fail("a string without an end");
    ++at_;
  }

  void number() {
    const char* begin = text_.data() + at_;
    const char* end = text_.data() + text_.size();
    Token& token = add(Token::Kind::Number, "");
    if (end - begin > 2 && begin[0] == '0' && (begin[1] == 'x' || begin[1] == 'X')) {
      unsigned long long whole = 0;
      const auto found = std::from_chars(begin + 2, end, whole, 16);
      if (found.ec != std::errc()) fail("a hexadecimal number without digits or too large");
      token.number = static_cast<double>(whole);
      token.is_whole = true;
      at_ += static_cast<std::size_t>(found.ptr - begin);
      return;
    }
    const auto found = std::from_chars(begin, end, token.number);
    if (found.ec != std::errc()) fail("a number that cannot be");
    const std::string_view digits(begin, static_cast<std::size_t>(found.ptr - begin));
    token.is_whole = digits.find_first_of(".eE") == std::string_view::npos;
    at_ += digits.size();
    if (at_ < text_.size() && is_word(text_[at_])) fail("a number that ends in letters");
  }

  void symbol() {
    static constexpr std::array<std::string_view, 4> kDouble = {"==", "!=", "<=", ">="};
    const std::string_view two = text_.substr(at_, 2);
    for (const std::string_view symbol : kDouble) {
      if (two != symbol) continue;
      add(Token::Kind::Symbol, std::string(symbol));
      at_ += 2;
      return;
    }
    const char c = text_[at_];
    if (std::string_view("+-*/%<>=()[],:.;").find(c) == std::string_view::npos)
      fail(fmt::format("an unexpected character 0x{:02x}", static_cast<unsigned char>(c)));
    if (c == '(' || c == '[') ++depth_;
    if ((c == ')' || c == ']') && depth_ > 0) --depth_;
    if (c == ';')
      add(Token::Kind::NewLine, "");
    else
      add(Token::Kind::Symbol, std::string(1, c));
    ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
  int depth_ = 0;  ///< brackets: a new line within them is a blank
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> tokens_of(std::string_view text) { return Tokens(text).all(); }

}  // namespace snug::urscript::internal
