// ExpressionCompiler: reads tokens one after the other, and turns expressions into code.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "snug/urscript/internal/code.hpp"

namespace snug::urscript::internal {

/// Words of the language that begin, part or end statements.
[[nodiscard]] bool is_reserved(std::string_view word);

class TokenReader {
 public:
  explicit TokenReader(std::string_view text) : tokens_(tokens_of(text)) {}

 protected:
  [[nodiscard]] const Token& peek(std::size_t ahead = 0) const {
    return tokens_[std::min(at_ + ahead, tokens_.size() - 1)];
  }
  const Token& take() {
    const Token& token = peek();
    if (at_ + 1 < tokens_.size()) ++at_;
    return token;
  }
  [[noreturn]] void fail(const Token& token, std::string text) const {
    throw ParseFault{{token.line, token.column, std::move(text)}};
  }
  [[nodiscard]] static std::string shown(const Token& token) {
    if (token.kind == Token::Kind::NewLine) return "the end of the line";
    if (token.kind == Token::Kind::End) return "the end of the program";
    return "'" + token.text.substr(0, 40) + "'";
  }
  [[nodiscard]] bool is_symbol(std::string_view text, std::size_t ahead = 0) const {
    return peek(ahead).kind == Token::Kind::Symbol && peek(ahead).text == text;
  }
  [[nodiscard]] bool is_word(std::string_view text) const {
    return peek().kind == Token::Kind::Name && peek().text == text;
  }
  void expect(std::string_view symbol) {
    if (!is_symbol(symbol)) fail(peek(), fmt::format("got {}, expected '{}'", shown(peek()), symbol));
    take();
  }
  void word(std::string_view text) {
    if (!is_word(text)) fail(peek(), fmt::format("got {}, expected '{}'", shown(peek()), text));
    take();
  }
  std::string name(const char* what) {
    if (peek().kind != Token::Kind::Name) fail(peek(), fmt::format("got {}, expected {}", shown(peek()), what));
    return take().text;
  }
  void skip_lines() {
    while (peek().kind == Token::Kind::NewLine) take();
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
};

class ExpressionCompiler : protected TokenReader {
 public:
  explicit ExpressionCompiler(std::string_view text) : TokenReader(text) {}

 protected:
  struct Scope {
    int function = 0;
    std::map<std::string, int> locals;
    std::vector<std::vector<int>> breaks;  ///< jumps of each loop that is open, to be patched
    std::vector<int> loops;                ///< where each begins
  };

  int emit(Op op, int a = 0, int b = 0) {
    code_.instructions.push_back({op, a, b, where_.line, where_.column});
    return static_cast<int>(code_.instructions.size()) - 1;
  }
  [[nodiscard]] int here() const { return static_cast<int>(code_.instructions.size()); }
  void patch(int jump) { code_.instructions[static_cast<std::size_t>(jump)].a = here(); }
  void constant(Value value) {
    code_.constants.push_back(std::move(value));
    emit(Op::Constant, static_cast<int>(code_.constants.size()) - 1);
  }

  void deeper() {
    constexpr int kDeepest = 100;
    if (++depth_ > kDeepest) fail(peek(), "blocks or brackets too deep in each other");
  }
  /// Code that leaves the value of the expression that begins here.
  void expression();

  Code code_;
  std::map<std::string, int> names_;  ///< functions and threads
  std::map<std::string, int> globals_;
  std::vector<Scope> scopes_;
  Token where_;  ///< of the code that is emitted
  int depth_ = 0;

 private:
  // The loosest binding first.
  void logical(int level);
  void negation();
  void comparison();
  void sum();
  void product();
  void sign();
  void postfix();
  void primary();
  [[nodiscard]] bool is_variable(const std::string& text) const;
  int elements();
  void start_thread(const Token& token);
  void call(const Token& token, bool is_run);
  void variable(const Token& token);
};

}  // namespace snug::urscript::internal
