// Code: a program compiled for a stack machine, and the tokens that it was made from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "snug/urscript/internal/value.hpp"
#include "snug/urscript/program.hpp"

namespace snug::urscript::internal {

enum class Op : std::uint8_t {
  Constant,      ///< push constants[a]
  LoadGlobal,    ///< push globals[a]
  StoreGlobal,   ///< pop into globals[a]
  LoadLocal,     ///< push locals[a]
  StoreLocal,    ///< pop into locals[a]
  StoreElement,  ///< pop value, index; into an element of globals[a] (b = 0) or locals[a] (b = 1)
  StoreOutput,   ///< pop value, index; into the standard digital output
  MakeList,      ///< pop a values
  MakePose,      ///< pop six numbers
  Index,         ///< pop index, list
  Binary,        ///< operator a
  Unary,         ///< operator a
  Jump,          ///< to a
  JumpIfFalse,   ///< pop; to a
  AndOrSkip,     ///< keep the top as a boolean and jump to a where it is b; else pop it
  Call,          ///< function a with the arguments of names calls[b]
  CallBuiltin,   ///< built-in a with those of calls[b]
  Return,        ///< pop the result
  Pop,
  Run,   ///< push a thread of function a with the arguments of calls[b]
  Join,  ///< pop a thread
  Kill,  ///< pop a thread
  EnterCritical,
  ExitCritical,
  SkipIfGiven,  ///< to b where the argument in locals[a] was given
  Halt,
};

struct Instruction {
  Op op = Op::Halt;
  int a = 0, b = 0;
  int line = 0, column = 0;
};

/// Names of the arguments of a call, in order; empty: by position.
using CallNames = std::vector<std::string>;

struct Function {
  std::string name;
  std::vector<std::string> parameters;
  std::vector<bool> has_default;
  int locals = 0;  ///< parameters first
  int begin = 0;   ///< instruction
};

struct Code {
  std::string name;
  bool is_secondary = false;
  std::vector<Instruction> instructions;
  std::vector<Value> constants;
  std::vector<CallNames> calls;
  std::vector<Function> functions;  ///< the first is the program
  std::vector<std::string> globals;
};

struct Token {
  enum class Kind : std::uint8_t { Name, Number, String, Symbol, NewLine, End };
  Kind kind = Kind::End;
  std::string text;
  double number = 0.0;
  bool is_whole = false;
  int line = 1, column = 1;
};

struct ParseFault {
  ScriptError error;
};
/// Throws ParseFault.
[[nodiscard]] std::vector<Token> tokens_of(std::string_view text);

}  // namespace snug::urscript::internal
