// IPv4 addresses: whom a server listens to, and whom it lets in.
#pragma once

#include <netinet/in.h>

#include <string>
#include <vector>

#include "snug/core/descriptor.hpp"

namespace snug::served_ur::internal {

/// In the network's order of bytes. Throws InputError naming `option` for what is no IPv4 address; `localhost` is one.
[[nodiscard]] in_addr parse_address(const std::string& text, const char* option);
/// 127.0.0.0/8
[[nodiscard]] bool is_loopback(in_addr address);

/// Who may connect: this machine, and the addresses of a list.
class Guests {
 public:
  /// "any" lets in all. Throws as parse_address.
  explicit Guests(const std::vector<std::string>& addresses);
  [[nodiscard]] bool is_welcome(in_addr address) const;
  [[nodiscard]] bool has_others() const { return lets_in_all_ || !addresses_.empty(); }

 private:
  bool lets_in_all_ = false;
  std::vector<in_addr> addresses_;
};

/// A socket that listens and does not block. Throws InputError where the port cannot be had.
[[nodiscard]] Descriptor listen_at(in_addr address, int port, const std::string& host);

}  // namespace snug::served_ur::internal
