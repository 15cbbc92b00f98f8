// Served: a controller that runs in a thread of its own, at ports that were free.
#pragma once

#include <unistd.h>

#include <optional>
#include <thread>

#include "snug/core/input_error.hpp"
#include "snug/served_ur/server.hpp"
#include "snug/served_ur/test/cell.hpp"

namespace snug::served_ur::test {

class Served {
 public:
  Served() : controller_(demonstrator_cell(), {}) {
    for (offset_ = 1000 + static_cast<int>(::getpid() % 200) * 100; !server_; offset_ += 10) {
      ServerSettings settings;
      settings.port_offset = offset_;
      try {
        server_.emplace(controller_, settings);
        break;
      } catch (const InputError&) {
        if (offset_ > 33000) throw;
      }
    }
    thread_ = std::thread([this] { server_->run(); });
  }
  ~Served() {
    server_->stop();
    thread_.join();
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;
  [[nodiscard]] int offset() const { return offset_; }

 private:
  Controller controller_;
  std::optional<Server> server_;
  int offset_ = 0;
  std::thread thread_;
};

}  // namespace snug::served_ur::test
