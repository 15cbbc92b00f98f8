// check_yaml: is this text one YAML document that does not grow beyond measure when it is read.
#pragma once

#include <cstddef>
#include <string_view>

namespace snug::model {

/// Bytes of a YAML text; a scenario has some thousand.
inline constexpr std::size_t kLargestYaml = std::size_t{4} << 20U;
/// Values (scalars, lists, mappings) of a document, an alias counted as all that it stands for: a few lines of aliases
/// of aliases would stand for millions.
inline constexpr std::size_t kMostYamlValues = 100'000;
/// One more for every so many bytes beyond the first half megabyte: 10 000 boxes have 240 000 values in 2.4 MB.
inline constexpr std::size_t kFewYamlBytes = std::size_t{512} << 10U, kBytesPerYamlValue = 12;

/// Throws InputError with "name:line" when the text is larger, not UTF-8, no YAML, no document or more than one, has
/// more values, or a value that contains itself. Every reader of YAML asks this before it loads.
void check_yaml(std::string_view text, std::string_view name);

}  // namespace snug::model
