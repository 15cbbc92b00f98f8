// Authenticator: answers ZeroMQ's question whether a key may connect (ZAP, RFC 27).
#pragma once

#include <set>
#include <string>
#include <vector>

#include "snug/click/socket.hpp"

namespace snug::click::wire {

/// One in each context, made before a socket of it is bound. Connections with another mechanism than CURVE, or with a
/// key that is not listed, do not come about.
class Authenticator {
 public:
  /// `allowed`: public keys, Z85.
  Authenticator(void* context, const std::vector<std::string>& allowed);
  /// Answers what is asked now. `socket()` is readable when there is something.
  void answer();
  [[nodiscard]] void* socket() const { return socket_.get(); }

 private:
  Socket socket_;
  std::set<std::string> allowed_;
};

/// For a socket that is bound in `context`: peers of ZMTP 1.0 and 2.0 are refused. Their greeting is whatever bytes
/// come first, so that the text of a page's HTTP request would be one; it takes a domain of authentication to say so.
void refuse_old_peers(void* socket);

}  // namespace snug::click::wire
