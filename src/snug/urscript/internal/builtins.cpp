// Built-in functions by name.
#include "snug/urscript/internal/builtins.hpp"

#include <map>

#include "snug/core/input_error.hpp"

namespace snug::urscript::internal {
namespace {

struct Table {
  std::vector<const Builtin*> functions;
  std::vector<std::vector<std::string>> parameters;
  std::map<std::string_view, int> by_name;
  std::vector<std::string> names;
  Table() {
    for (const auto list : {math_builtins(), motion_builtins(), robot_builtins(), io_builtins()}) {
      for (const Builtin& one : list) {
        by_name.emplace(one.name, static_cast<int>(functions.size()));
        functions.push_back(&one);
        names.emplace_back(one.name);
        std::vector<std::string>& own = parameters.emplace_back();
        for (std::size_t at = 0; at < one.parameters.size();) {
          const std::size_t end = std::min(one.parameters.find(' ', at), one.parameters.size());
          own.emplace_back(one.parameters.substr(at, end - at));
          at = end + 1;
        }
      }
    }
  }
};

const Table& table() {
  static const Table all;
  return all;
}

}  // namespace

int find_builtin(std::string_view name) {
  const auto found = table().by_name.find(name);
  return found == table().by_name.end() ? -1 : found->second;
}
std::string nearest_builtin(std::string_view name) { return std::string(find_nearest(name, table().names)); }
const Builtin& builtin(int index) { return *table().functions[static_cast<std::size_t>(index)]; }
std::span<const std::string> parameters_of(int index) { return table().parameters[static_cast<std::size_t>(index)]; }

}  // namespace snug::urscript::internal
