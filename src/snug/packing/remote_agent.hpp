// Remote agent: decisions made by somebody who is asked in lines of JSON: a program in another language, say.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "snug/packing/agent.hpp"

namespace snug::packing {

/// Asks `input.ask` for every item (docs/python.md, the protocol of agents): what stands in the container, the item,
/// places where it can be lowered. The answer names places, best first, or says that there is none; places that
/// are given as numbers are lowered by the rules of the settings, and those that break them are left out. Throws
/// AgentError for an answer that cannot be understood.
[[nodiscard]] std::unique_ptr<Agent> make_remote_agent(std::string_view name, AgentInput input);

/// Somebody who was asked did not answer as agreed; what he said is in the message.
class AgentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace snug::packing
