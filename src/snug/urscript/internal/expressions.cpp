// ExpressionCompiler: operators by how tightly they bind, values, calls.
#include "snug/urscript/internal/expressions.hpp"

#include <set>

#include "snug/urscript/internal/builtins.hpp"

namespace snug::urscript::internal {
namespace {

constexpr std::size_t kMostArguments = 64;

}  // namespace

bool is_reserved(std::string_view word) {
  static const std::set<std::string_view> kWords = {
      "def",   "sec",    "thread", "if",       "elif",           "else",          "while", "end",  "break", "return",
      "local", "global", "halt",   "continue", "enter_critical", "exit_critical", "join",  "kill", "pass"};
  return kWords.count(word) > 0;
}

void ExpressionCompiler::expression() {
  deeper();
  logical(0);
  --depth_;
}

void ExpressionCompiler::logical(int level) {
  static constexpr std::string_view kWords[] = {"or", "xor", "and"};
  if (level == 3) return negation();
  logical(level + 1);
  while (is_word(kWords[level])) {
    where_ = take();
    if (level == 1) {
      logical(level + 1);
      emit(Op::Binary, static_cast<int>(Operator::Xor));
      continue;
    }
    const int skip = emit(Op::AndOrSkip, 0, level == 0 ? 1 : 0);
    logical(level + 1);
    patch(skip);
  }
}

void ExpressionCompiler::negation() {
  if (!is_word("not")) return comparison();
  where_ = take();
  deeper();
  negation();
  --depth_;
  emit(Op::Unary, static_cast<int>(Operator::Not));
}

void ExpressionCompiler::comparison() {
  static const std::map<std::string_view, Operator> kSymbols = {
      {"==", Operator::Equal},     {"!=", Operator::Unequal}, {"<", Operator::Less},
      {"<=", Operator::LessEqual}, {">", Operator::Greater},  {">=", Operator::GreaterEqual}};
  sum();
  while (peek().kind == Token::Kind::Symbol) {
    const auto found = kSymbols.find(peek().text);
    if (found == kSymbols.end()) return;
    where_ = take();
    sum();
    emit(Op::Binary, static_cast<int>(found->second));
  }
}

void ExpressionCompiler::sum() {
  product();
  while (is_symbol("+") || is_symbol("-")) {
    const Token token = take();
    product();
    where_ = token;
    emit(Op::Binary, static_cast<int>(token.text == "+" ? Operator::Add : Operator::Subtract));
  }
}

void ExpressionCompiler::product() {
  sign();
  while (is_symbol("*") || is_symbol("/") || is_symbol("%")) {
    const Token token = take();
    sign();
    where_ = token;
    emit(Op::Binary, static_cast<int>(token.text == "*"   ? Operator::Multiply
                                      : token.text == "/" ? Operator::Divide
                                                          : Operator::Modulo));
  }
}

void ExpressionCompiler::sign() {
  if (!is_symbol("-") && !is_symbol("+")) return postfix();
  const Token token = take();
  deeper();
  sign();
  --depth_;
  where_ = token;
  if (token.text == "-") emit(Op::Unary, static_cast<int>(Operator::Negate));
}

void ExpressionCompiler::postfix() {
  primary();
  while (is_symbol("[")) {
    const Token token = take();
    expression();
    expect("]");
    where_ = token;
    emit(Op::Index);
  }
}

void ExpressionCompiler::primary() {
  skip_lines();  // a value may stand on the next line
  const Token token = take();
  where_ = token;
  if (token.kind == Token::Kind::Name && is_reserved(token.text))
    fail(token, fmt::format("got {}, expected a value", shown(token)));
  if (token.kind == Token::Kind::Number) {
    Value value = Value::of(token.number);
    if (token.is_whole && token.number <= 2147483647.0) value.kind = Value::Kind::Int;
    return constant(std::move(value));
  }
  if (token.kind == Token::Kind::String) return constant(Value::of(token.text));
  if (token.kind == Token::Kind::Symbol && token.text == "(") {
    expression();
    return expect(")");
  }
  if (token.kind == Token::Kind::Symbol && token.text == "[") {
    const int count = elements();
    where_ = token;
    emit(Op::MakeList, count);
    return;
  }
  if (token.kind != Token::Kind::Name) fail(token, fmt::format("got {}, expected a value", shown(token)));
  if (token.text == "p" && is_symbol("[") && !is_variable(token.text)) {
    take();
    const int count = elements();
    if (count != 6) fail(token, fmt::format("a pose of {} numbers, not 6", count));
    where_ = token;
    emit(Op::MakePose);
    return;
  }
  if (token.text == "run") return start_thread(token);
  if (is_symbol("(")) return call(token, false);
  variable(token);
}

bool ExpressionCompiler::is_variable(const std::string& text) const {
  return scopes_.back().locals.count(text) > 0 || globals_.count(text) > 0;
}

int ExpressionCompiler::elements() {
  int count = 0;
  while (!is_symbol("]")) {
    expression();
    ++count;
    if (!is_symbol(",")) break;
    take();
  }
  expect("]");
  return count;
}

void ExpressionCompiler::start_thread(const Token& token) {
  const Token callee = peek();
  if (names_.count(name("a thread")) == 0) fail(callee, fmt::format("no thread '{}'", callee.text));
  where_ = token;
  call(callee, true);
}

void ExpressionCompiler::call(const Token& token, bool is_run) {
  expect("(");
  CallNames given;
  while (!is_symbol(")")) {
    std::string argument;
    if (peek().kind == Token::Kind::Name && is_symbol("=", 1)) {
      argument = take().text;
      take();
    } else if (!given.empty() && !given.back().empty()) {
      fail(peek(), "an argument without a name behind one with a name");
    }
    if (given.size() >= kMostArguments) fail(peek(), "too many arguments");
    given.push_back(argument);
    expression();
    if (!is_symbol(",")) break;
    take();
  }
  expect(")");
  where_ = token;
  code_.calls.push_back(given);
  const int names = static_cast<int>(code_.calls.size()) - 1;
  if (const auto found = names_.find(token.text); found != names_.end()) {
    emit(is_run ? Op::Run : Op::Call, found->second, names);
    return;
  }
  const int builtin = find_builtin(token.text);
  if (builtin < 0) {
    const std::string nearest = nearest_builtin(token.text);
    fail(token, fmt::format("unknown function '{}'{}", token.text,
                            nearest.empty() ? "" : fmt::format(", nearest is '{}'", nearest)));
  }
  emit(Op::CallBuiltin, builtin, names);
}

void ExpressionCompiler::variable(const Token& token) {
  if (const auto local = scopes_.back().locals.find(token.text); local != scopes_.back().locals.end()) {
    emit(Op::LoadLocal, local->second);
    return;
  }
  if (const auto global = globals_.find(token.text); global != globals_.end()) {
    emit(Op::LoadGlobal, global->second);
    return;
  }
  if (token.text == "True" || token.text == "False") return constant(Value::of(token.text == "True"));
  if (token.text == "None") return constant({});
  if (token.text == "pi" || token.text == "PI") return constant(Value::of(3.14159265358979323846));
  fail(token, fmt::format("no variable '{}'", token.text));
}
}  // namespace snug::urscript::internal
