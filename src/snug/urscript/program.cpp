// parse: from the text of a program to code for the stack machine, in one pass over its tokens.
#include "snug/urscript/program.hpp"

#include <fmt/format.h>

#include "snug/urscript/internal/expressions.hpp"

namespace snug::urscript {
namespace internal {
namespace {

constexpr std::size_t kLongest = 4'000'000;  // bytes
constexpr std::size_t kMostParameters = 64;

/// Statements; functions and variables may be used before they come.
class Compiler : private ExpressionCompiler {
 public:
  explicit Compiler(std::string_view text) : ExpressionCompiler(text) {}

  std::unique_ptr<const Code> run() {
    find_names();
    skip_lines();
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
    code_.functions.resize(names_.size() + 1);
    code_.functions.front() = main;
    begin_function(0);
    if (is_def || is_sec) {
      block();
      word("end");
    } else {
      while (peek().kind != Token::Kind::End) {
        statement();
        if (is_word("end") || is_word("elif") || is_word("else"))
          fail(peek(), fmt::format("got {}, outside of a block", shown(peek())));
      }
    }
    end_function();
    if (is_def || is_sec) rest(main.name);
    return std::make_unique<const Code>(std::move(code_));
  }

 private:
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
      if (made.parameters.size() >= kMostParameters) fail(peek(), "too many parameters");
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

  /// Behind the program's end: nothing, or a call of it.
  void rest(const std::string& program) {
    skip_lines();
    if (is_word(program) && is_symbol("(", 1) && is_symbol(")", 2)) at_ += 3;
    skip_lines();
    if (peek().kind != Token::Kind::End)
      fail(peek(), fmt::format("got {} behind the end of the program", shown(peek())));
  }
};

/// Names and numbers of a line, without its strings and comments.
std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  const auto is_word = [&](std::size_t at) {
    return at < line.size() && (std::isalnum(static_cast<unsigned char>(line[at])) != 0 || line[at] == '_');
  };
  for (std::size_t at = line.find_first_not_of(" \t\r"); at < line.size();) {
    if (line[at] == '#' || (line[at] == '$' && words.empty())) break;
    if (line[at] == '"' || line[at] == '\'') {
      at = line.find(line[at], at + 1);
      at = at == std::string_view::npos ? line.size() : at + 1;
      continue;
    }
    const std::size_t begin = at;
    while (is_word(at)) ++at;
    if (at > begin)
      words.push_back(line.substr(begin, at - begin));
    else
      ++at;
  }
  return words;
}

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
  int open = 0;
  bool is_begun = false;
  for (std::size_t at = 0, end = stream.find('\n'); end != std::string_view::npos; end = stream.find('\n', at)) {
    const std::vector<std::string_view> words = internal::words_of(stream.substr(at, end - at));
    at = end + 1;
    if (words.empty()) continue;
    if (!is_begun && words.front() != "def" && words.front() != "sec") return at;
    is_begun = true;
    for (const std::string_view word : words) {
      if (word == "def" || word == "sec" || word == "thread" || word == "if" || word == "while") ++open;
      if (word == "end") --open;
    }
    if (open <= 0) return at;
  }
  return 0;
}

}  // namespace snug::urscript
