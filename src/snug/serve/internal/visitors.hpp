// Visitors: which requests are answered: by the name they ask for, where they come from, and what they know. Internal.
#pragma once

#include <string>
#include <vector>

#include "snug/serve/internal/httplib.hpp"
#include "snug/serve/server.hpp"

namespace snug::serve::internal {

/// Two things keep strangers out. Names: a page of another site can have its own name resolve to this machine, and its
/// requests then carry that name. A token, where other machines can reach the server: it stands in the address that is
/// shown to the user, and the browser keeps it as a cookie.
class Visitors {
 public:
  /// `is_local`: only this machine can reach the server; then there is a token only if it is always asked for. `names`:
  /// more than those of this machine's own: localhost, and where others reach it the machine's name and the addresses
  /// of its interfaces.
  Visitors(bool is_local, std::vector<std::string> names, int port, TokenUse token);

  /// 0, or the status and text by which it is refused.
  [[nodiscard]] int refuse(const httplib::Request& request, httplib::Response& response) const;
  /// What the address ends in, "" or "?token=...".
  [[nodiscard]] std::string query() const;
  /// The host that people write who want to come by an address that stands for all of this machine's.
  [[nodiscard]] static std::string own_address();

 private:
  [[nodiscard]] bool is_right_name(const httplib::Request& request) const;
  [[nodiscard]] bool knows_token(const httplib::Request& request, httplib::Response& response) const;

  bool is_local_;
  std::vector<std::string> names_;
  std::string cookie_;
  std::string token_;  ///< empty: none is asked for
};

}  // namespace snug::serve::internal
