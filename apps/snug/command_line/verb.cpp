// Verb: what a verb declares, told to the parser.
#include "apps/snug/command_line/verb.hpp"

#include <CLI/CLI.hpp>
#include <type_traits>

namespace snug::app {
namespace {

template <class Value>
bool has_default(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>) return true;
  if constexpr (std::is_same_v<Value, std::string> || std::is_same_v<Value, std::vector<std::string>>)
    return !value.empty();
  return false;
}

}  // namespace

OptionRow OptionRow::required(bool is_required) const {
  option_->required(is_required);
  if (is_required) option_->default_str("");
  return *this;
}

OptionRow OptionRow::needs(const OptionRow& other) const {
  option_->needs(other.option_);
  return *this;
}

OptionRow OptionRow::excludes(const OptionRow& other) const {
  option_->excludes(other.option_);
  return *this;
}

OptionRow OptionRow::excludes(const std::vector<std::string>& names) const {
  for (const std::string& name : names) option_->excludes(name);
  return *this;
}

OptionRow OptionRow::delimiter(char between) const {
  option_->delimiter(between);
  return *this;
}

OptionRow OptionRow::expected(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

OptionRow OptionRow::one_each() const {
  option_->allow_extra_args(false);
  return *this;
}

std::size_t OptionRow::count() const { return option_->count(); }

Verb::Verb(CLI::App& app, Action& action, const std::string& name, const std::string& about, const std::string& more)
    : app_(app.add_subcommand(name, about)), action_(&action) {
  if (!more.empty()) app_->footer(more);  // else that of the verb it is part of
}

Verb Verb::part(const std::string& name, const std::string& about, const std::string& more, bool is_optional) const {
  if (is_optional)
    app_->require_subcommand(0, 1);
  else
    app_->require_subcommand(1);
  return {*app_, *action_, name, about, more};
}

OptionRow Verb::option(const char* names, OptionTarget target, const char* value, const std::string& about,
                       const Check& check) const {
  CLI::Option& option =
      *std::visit([&](auto* variable) { return app_->add_option(names, *variable, about); }, target.variable);
  option.type_name(value);
  if (std::visit([](const auto* variable) { return has_default(*variable); }, target.variable))
    option.capture_default_str();
  if (check.find_fault) option.check(CLI::Validator(check.find_fault, "", check.name));
  return OptionRow(option);
}

OptionRow Verb::flag(const char* names, bool& target, const char* about) const {
  return OptionRow(*app_->add_flag(names, target, about));
}

void Verb::acts(Action action) const {
  app_->callback([all = action_, app = app_, action = std::move(action)] {
    if (app->get_subcommands().empty()) *all = action;  // else its part has
  });
}

bool Verb::has(const char* option) const { return app_->get_option(option)->count() > 0; }

}  // namespace snug::app
