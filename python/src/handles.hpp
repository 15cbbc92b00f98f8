// Handles: constants that Python objects share, such as a scenario that several cells were made of.
#pragma once

#include <memory>
#include <utility>

#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::python {

/// A value that nobody changes any more.
template <class T>
class Held {
 public:
  explicit Held(T value) : value_(std::move(value)) {}
  const T& operator*() const { return value_; }
  const T* operator->() const { return &value_; }

 private:
  T value_;
};

using ScenarioHandle = std::shared_ptr<Held<model::Scenario>>;
using ProgramHandle = std::shared_ptr<Held<motion::Program>>;

}  // namespace snug::python
