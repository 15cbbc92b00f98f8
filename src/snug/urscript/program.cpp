// parse: from the text of a program to code for the stack machine, in one pass over its tokens.
#include "snug/urscript/program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "snug/urscript/internal/builtins.hpp"
#include "snug/urscript/internal/code.hpp"

namespace snug::urscript {
namespace internal {
namespace {

constexpr std::size_t kLongest = 4'000'000;  // bytes
constexpr int kDeepest = 100;                // blocks or brackets in each other
constexpr std::size_t kMostArguments = 64;

bool is_reserved(std::string_view word) {
  static const std::set<std::string_view> kWords = {
      "def",   "sec",    "thread", "if",       "elif",           "else",          "while", "end",  "break", "return",
      "local", "global", "halt",   "continue", "enter_critical", "exit_critical", "join",  "kill", "pass"};
  return kWords.count(word) > 0;
}

class Compiler {
 public:
  explicit Compiler(std::string_view text) : tokens_(tokens_of(text)) {}

  std::unique_ptr<const Code> run() {
    find_names();
    skip_lines();
    code_.functions.reserve(names_.size() + 1);
    const bool is_def = is_word("def"), is_sec = is_word("sec");
    code_.is_secondary = is_sec;
    Function main;
    main.name = "program";
    if (is_def || is_sec) {
      take();
      main.name = name("the name of the program");
      expect("(");
      expect(")");
      expect(":");
    }
    code_.name = main.name;
    code_.functions.push_back(main);
    for (const auto& [text, index] : names_) {
      (void)text;
      (void)index;
      code_.functions.emplace_back();
    }
    begin_function(0);
    if (is_def || is_sec) {
      block();
      word("end");
    } else {
      while (peek().kind != Token::Kind::End) statement();
    }
    end_function();
    if (is_def || is_sec) rest(main.name);
    return std::make_unique<const Code>(std::move(code_));
  }

 private:
  struct Scope {
    int function = 0;
    std::map<std::string, int> locals;
    std::vector<std::vector<int>> breaks;  ///< jumps of each loop that is open, to be patched
    std::vector<int> loops;                ///< where each begins
  };

  // --- tokens
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

  /// Functions, threads and variables of the program, before anything is compiled: they may be used before they come.
  void find_names() {
    int functions = 0;
    std::vector<bool> blocks;  // those that are open: whether it is a function
    bool is_first = true, is_begin = true;
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i) {
      const Token& token = tokens_[i];
      const Token& next = tokens_[i + 1];
      const bool is_declaration = token.kind == Token::Kind::Name && (token.text == "global" || token.text == "local");
      if (token.kind == Token::Kind::Name && (is_begin || is_declaration)) {
        const bool opens = token.text == "def" || token.text == "thread" || token.text == "sec";
        if (opens) {
          if (!is_first || token.text == "thread") {
            if (next.kind == Token::Kind::Name &&
                !names_.emplace(next.text, static_cast<int>(names_.size()) + 1).second)
              fail(next, fmt::format("a second function '{}'", next.text));
          }
          blocks.push_back(true);
          ++functions;
        } else if (token.text == "if" || token.text == "while") {
          blocks.push_back(false);
        } else if (token.text == "end") {
          if (!blocks.empty()) {
            if (blocks.back()) --functions;
            blocks.pop_back();
          }
        } else if (token.text == "global" || (token.text == "local" && functions <= 1)) {
          if (next.kind == Token::Kind::Name) add_global(next.text);
        } else if (functions <= 1 && next.kind == Token::Kind::Symbol && next.text == "=") {
          add_global(token.text);
        }
        is_first = false;
      }
      is_begin = token.kind == Token::Kind::NewLine || (token.kind == Token::Kind::Symbol && token.text == ":");
    }
  }
  void add_global(const std::string& text) {
    if (!globals_.emplace(text, static_cast<int>(code_.globals.size())).second) return;
    code_.globals.push_back(text);
  }

  // --- code
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
  void begin_function(int index) {
    scopes_.push_back({});
    scopes_.back().function = index;
    function(index).begin = here();
  }
  void end_function() {
    constant({});
    emit(Op::Return);
    function(scopes_.back().function).locals = static_cast<int>(scopes_.back().locals.size());
    scopes_.pop_back();
  }
  Function& function(int index) { return code_.functions[static_cast<std::size_t>(index)]; }

  void deeper() {
    if (++depth_ > kDeepest) fail(peek(), "blocks or brackets too deep in each other");
  }

  void block() {
    deeper();
    while (!is_word("end") && !is_word("elif") && !is_word("else")) {
      if (peek().kind == Token::Kind::End) fail(peek(), "the program ends within a block: 'end' is missing");
      statement();
    }
    --depth_;
  }

  void statement() {
    skip_lines();
    if (peek().kind == Token::Kind::End || is_word("end") || is_word("elif") || is_word("else")) return;
    where_ = peek();
    if (peek().kind == Token::Kind::Name && compound()) return;
    if (!(peek().kind == Token::Kind::Name && (simple() || assignment()))) {
      expression();
      emit(Op::Pop);
    }
    // A statement that begins with a word of the language needs no line of its own.
    const bool is_next = peek().kind == Token::Kind::Name && is_reserved(peek().text);
    if (peek().kind != Token::Kind::NewLine && peek().kind != Token::Kind::End && !is_next)
      fail(peek(), fmt::format("got {}, expected the end of the line", shown(peek())));
  }

  bool compound() {
    const std::string& text = peek().text;
    if (text == "def" || text == "thread") {
      take();
      nested();
    } else if (text == "if") {
      take();
      condition();
    } else if (text == "while") {
      take();
      loop();
    } else {
      return false;
    }
    return true;
  }

  void nested() {
    const Token& token = peek();
    const std::string text = name("a name");
    const auto known = names_.find(text);
    if (known == names_.end()) fail(token, fmt::format("a function '{}' within a line", text));
    const int index = known->second;
    if (!is_symbol("(")) fail(peek(), fmt::format("got {}, expected '('", shown(peek())));
    const int over = emit(Op::Jump);
    Function made;
    made.name = text;
    begin_function(index);
    take();
    while (!is_symbol(")")) {
      const std::string parameter = name("the name of a parameter");
      if (made.parameters.size() >= kMostArguments) fail(peek(), "too many parameters");
      const int slot = static_cast<int>(made.parameters.size());
      if (!scopes_.back().locals.emplace(parameter, slot).second)
        fail(peek(), fmt::format("a second parameter '{}'", parameter));
      made.parameters.push_back(parameter);
      const bool has_default = is_symbol("=");
      made.has_default.push_back(has_default);
      if (has_default) {
        take();
        const int skip = emit(Op::SkipIfGiven, slot);
        expression();
        emit(Op::StoreLocal, slot);
        code_.instructions[static_cast<std::size_t>(skip)].b = here();
      }
      if (!is_symbol(",")) break;
      take();
    }
    expect(")");
    expect(":");
    made.begin = function(index).begin;
    function(index) = made;
    block();
    word("end");
    end_function();
    patch(over);
  }

  void condition() {
    std::vector<int> ends;
    for (;;) {
      expression();
      const int next = emit(Op::JumpIfFalse);
      expect(":");
      block();
      const bool goes_on = is_word("elif") || is_word("else");
      if (goes_on) ends.push_back(emit(Op::Jump));
      patch(next);
      if (is_word("elif")) {
        take();
        continue;
      }
      if (is_word("else")) {
        take();
        expect(":");
        block();
      }
      word("end");
      break;
    }
    for (const int jump : ends) patch(jump);
  }

  void loop() {
    const int begin = here();
    expression();
    const int out = emit(Op::JumpIfFalse);
    expect(":");
    scopes_.back().loops.push_back(begin);
    scopes_.back().breaks.emplace_back();
    block();
    word("end");
    emit(Op::Jump, begin);
    patch(out);
    for (const int jump : scopes_.back().breaks.back()) patch(jump);
    scopes_.back().breaks.pop_back();
    scopes_.back().loops.pop_back();
  }

  bool simple() {
    const Token token = peek();
    const std::string& text = token.text;
    Scope& scope = scopes_.back();
    if (text == "break" || text == "continue") {
      if (scope.loops.empty()) fail(token, fmt::format("'{}' outside of a loop", text));
      take();
      if (text == "break")
        scope.breaks.back().push_back(emit(Op::Jump));
      else
        emit(Op::Jump, scope.loops.back());
    } else if (text == "return") {
      take();
      if (peek().kind == Token::Kind::NewLine || is_word("end"))
        constant({});
      else
        expression();
      emit(Op::Return);
    } else if (text == "halt") {
      take();
      brackets();
      emit(Op::Halt);
    } else if (text == "pass") {
      take();
    } else if (text == "enter_critical" || text == "exit_critical") {
      take();
      brackets();
      emit(text == "enter_critical" ? Op::EnterCritical : Op::ExitCritical);
    } else if (text == "join" || text == "kill") {
      take();
      expression();
      emit(text == "join" ? Op::Join : Op::Kill);
    } else if (text == "local" || text == "global") {
      take();
      declaration(text == "local");
    } else {
      return false;
    }
    return true;
  }
  void brackets() {
    if (!is_symbol("(")) return;
    take();
    expect(")");
  }

  void declaration(bool is_local) {
    const std::string variable = name("the name of a variable");
    // Variables of the program's own body are seen by its functions.
    const bool is_own = is_local && scopes_.size() > 1;
    if (!is_own) add_global(variable);
    const int slot = is_own ? local_slot(variable) : globals_.at(variable);
    if (is_symbol("=")) {
      take();
      expression();
    } else {
      constant({});
    }
    emit(is_own ? Op::StoreLocal : Op::StoreGlobal, slot);
  }
  int local_slot(const std::string& variable) {
    Scope& scope = scopes_.back();
    return scope.locals.emplace(variable, static_cast<int>(scope.locals.size())).first->second;
  }

  bool assignment() {
    const Token token = peek();
    if (is_symbol("=", 1)) {
      take();
      take();
      expression();
      store(token.text);
      return true;
    }
    if (!is_symbol("[", 1)) return false;
    // An element of a variable: only where '=' comes behind the bracket.
    std::size_t ahead = 2;
    for (int open = 1; open > 0; ++ahead) {
      const Token::Kind kind = peek(ahead).kind;
      if (kind == Token::Kind::NewLine || kind == Token::Kind::End) return false;
      open += is_symbol("[", ahead) ? 1 : is_symbol("]", ahead) ? -1 : 0;
    }
    if (!is_symbol("=", ahead)) return false;
    take();
    take();
    expression();
    expect("]");
    expect("=");
    expression();
    const auto local = scopes_.back().locals.find(token.text);
    const auto global = globals_.find(token.text);
    where_ = token;
    if (local != scopes_.back().locals.end())
      emit(Op::StoreElement, local->second, 1);
    else if (global != globals_.end())
      emit(Op::StoreElement, global->second, 0);
    else if (token.text == "digital_out")
      emit(Op::StoreOutput);
    else
      fail(token, fmt::format("no variable '{}'", token.text));
    return true;
  }
  void store(const std::string& variable) {
    const auto local = scopes_.back().locals.find(variable);
    const auto global = globals_.find(variable);
    if (local != scopes_.back().locals.end())
      emit(Op::StoreLocal, local->second);
    else if (global != globals_.end())
      emit(Op::StoreGlobal, global->second);
    else
      emit(Op::StoreLocal, local_slot(variable));
  }

  // --- expressions, the loosest binding first
  void expression() {
    deeper();
    logical(0);
    --depth_;
  }
  void logical(int level) {
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
  void negation() {
    if (!is_word("not")) return comparison();
    where_ = take();
    deeper();
    negation();
    --depth_;
    emit(Op::Unary, static_cast<int>(Operator::Not));
  }
  void comparison() {
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
  void sum() {
    product();
    while (is_symbol("+") || is_symbol("-")) {
      const Token token = take();
      product();
      where_ = token;
      emit(Op::Binary, static_cast<int>(token.text == "+" ? Operator::Add : Operator::Subtract));
    }
  }
  void product() {
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
  void sign() {
    if (!is_symbol("-") && !is_symbol("+")) return postfix();
    const Token token = take();
    deeper();
    sign();
    --depth_;
    where_ = token;
    if (token.text == "-") emit(Op::Unary, static_cast<int>(Operator::Negate));
  }
  void postfix() {
    primary();
    while (is_symbol("[")) {
      const Token token = take();
      expression();
      expect("]");
      where_ = token;
      emit(Op::Index);
    }
  }

  void primary() {
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
  [[nodiscard]] bool is_variable(const std::string& text) const {
    return scopes_.back().locals.count(text) > 0 || globals_.count(text) > 0;
  }
  int elements() {
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
  void start_thread(const Token& token) {
    const Token callee = peek();
    if (names_.count(name("a thread")) == 0) fail(callee, fmt::format("no thread '{}'", callee.text));
    where_ = token;
    call(callee, true);
  }

  void call(const Token& token, bool is_run) {
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

  void variable(const Token& token) {
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

  /// Behind the program's end: nothing, or a call of it.
  void rest(const std::string& program) {
    skip_lines();
    if (is_word(program) && is_symbol("(", 1) && is_symbol(")", 2)) at_ += 3;
    skip_lines();
    if (peek().kind != Token::Kind::End)
      fail(peek(), fmt::format("got {} behind the end of the program", shown(peek())));
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  Code code_;
  std::map<std::string, int> names_;  ///< functions and threads
  std::map<std::string, int> globals_;
  std::vector<Scope> scopes_;
  Token where_;
  int depth_ = 0;
};

}  // namespace
}  // namespace internal

Program::Program(std::unique_ptr<const internal::Code> code) : code_(std::move(code)) {}
Program::Program(Program&&) noexcept = default;
Program& Program::operator=(Program&&) noexcept = default;
Program::~Program() = default;
const std::string& Program::name() const { return code_->name; }
bool Program::is_secondary() const { return code_->is_secondary; }

Expected<Program, ScriptError> parse(std::string_view text) {
  if (text.size() > internal::kLongest)
    return Unexpected<ScriptError>(ScriptError{0, 0, "a program of more than 4 MB"});
  try {
    return Program(internal::Compiler(text).run());
  } catch (const internal::ParseFault& fault) {
    return Unexpected<ScriptError>(fault.error);
  }
}

std::size_t find_program_end(std::string_view stream) {
  std::size_t at = 0;
  int open = 0;
  bool is_begun = false;
  while (at < stream.size()) {
    const std::size_t end = stream.find('\n', at);
    if (end == std::string_view::npos) return 0;
    std::string_view line = stream.substr(at, end - at);
    at = end + 1;
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || line[begin] == '#' || line[begin] == '$') continue;
    line = line.substr(begin);
    const std::string_view word = line.substr(0, line.find_first_of(" \t\r:(#"));
    if (!is_begun && word != "def" && word != "sec") return at;
    is_begun = true;
    if (word == "def" || word == "sec" || word == "thread" || word == "if" || word == "while") ++open;
    if (word == "end") --open;
    if (open <= 0) return at;
  }
  return 0;
}

}  // namespace snug::urscript
