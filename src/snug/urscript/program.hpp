// Program: the text of a URScript program, checked and ready to run.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "snug/core/expected.hpp"

namespace snug::urscript {

namespace internal {
struct Code;
}

/// What is wrong with a program, as a controller says it.
struct ScriptError {
  int line = 0;    ///< from 1; 0: of no line
  int column = 0;  ///< from 1; 0: of no column
  std::string text;
  bool operator==(const ScriptError&) const = default;
};

/// Movable; owns its code. Made by parse().
class Program {
 public:
  explicit Program(std::unique_ptr<const internal::Code> code);
  Program(Program&&) noexcept;
  Program& operator=(Program&&) noexcept;
  ~Program();

  [[nodiscard]] const std::string& name() const;
  /// `sec`: runs beside another program and moves nothing.
  [[nodiscard]] bool is_secondary() const;
  [[nodiscard]] const internal::Code& code() const { return *code_; }

 private:
  std::unique_ptr<const internal::Code> code_;
};

/// `def NAME(): .. end`, `sec NAME(): .. end`, or statements. Statements behind the end of a `def` or `sec` belong to
/// another program on a controller: they are refused, but for blank lines, comments, and a call of the program itself,
/// which files that a teach pendant loads end with. At most 4 MB of text.
[[nodiscard]] Expected<Program, ScriptError> parse(std::string_view text);

/// Bytes of the first complete program at the beginning of what came through a socket so far: up to the newline behind
/// its last `end`, or one line for a bare statement (blank lines and comments before it included). 0: more has to come.
[[nodiscard]] std::size_t find_program_end(std::string_view stream);

}  // namespace snug::urscript
