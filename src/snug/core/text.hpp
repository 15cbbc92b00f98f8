// Text from outside: is it UTF-8, and how is it shown in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace snug {

/// Characters that a message for people has at most.
inline constexpr std::size_t kLongestMessage = 300;

/// Index of the first byte that is not part of well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, nothing
/// above U+10FFFF), npos when all are.
[[nodiscard]] std::size_t find_not_utf8(std::string_view text);
[[nodiscard]] inline bool is_utf8(std::string_view text) { return find_not_utf8(text) == std::string_view::npos; }

/// Throws InputError with "name:line" of the first byte that is not UTF-8. Every reader of text asks this first: names
/// of boxes and sequences go into JSON and HDF5, which take nothing else.
void check_utf8(std::string_view text, std::string_view name);

/// The text for people: control characters, marks that turn the direction of writing and bytes that are not UTF-8 as
/// \n, \x1b, \u202e; of more than `most` characters the first ones and "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t most);
/// The same with the last characters kept, behind "...".
[[nodiscard]] std::string printable_end(std::string_view text, std::size_t most);
/// Is it UTF-8 that needs no such escape? Names are, as tables show them on terminals.
[[nodiscard]] bool is_printable(std::string_view text);

/// Without spaces, tabs and carriage returns at both ends.
[[nodiscard]] std::string_view trim(std::string_view text);

}  // namespace snug
