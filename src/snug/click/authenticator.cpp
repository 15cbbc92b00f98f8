// Authenticator: answers ZeroMQ's question whether a key may connect (ZAP, RFC 27).
#include "snug/click/authenticator.hpp"

#include <zmq.h>

#include <array>
#include <stdexcept>

namespace snug::click::wire {
namespace {

constexpr const char* kEndpoint = "inproc://zeromq.zap.01";
constexpr std::string_view kDomain = "snug";
constexpr std::size_t kKeyBytes = 32;

}  // namespace

Authenticator::Authenticator(void* context, const std::vector<std::string>& allowed)
    : socket_(make_socket(context, ZMQ_REP)), allowed_(allowed.begin(), allowed.end()) {
  if (zmq_bind(socket_.get(), kEndpoint) != 0) throw std::runtime_error("ZeroMQ takes no authenticator");
}

void Authenticator::answer() {
  // version, request, domain, address, identity, mechanism, key
  for (Parts asked; receive(socket_.get(), asked);) {
    const std::vector<std::string>& parts = asked.parts;
    bool may_come = parts.size() == 7 && parts[0] == "1.0" && parts[5] == "CURVE" && parts[6].size() == kKeyBytes;
    if (may_come) {
      std::array<char, 41> key{};
      zmq_z85_encode(key.data(), reinterpret_cast<const std::uint8_t*>(parts[6].data()), kKeyBytes);
      may_come = allowed_.contains(key.data());
    }
    const std::string request = parts.size() > 1 ? parts[1] : "";
    for (const std::string_view part :
         {std::string_view("1.0"), std::string_view(request), std::string_view(may_come ? "200" : "400"),
          std::string_view(may_come ? "OK" : "no such key"), std::string_view()}) {
      (void)send(socket_.get(), part, true);
    }
    (void)send(socket_.get(), "", false);
  }
}

void refuse_old_peers(void* socket) {
  if (zmq_setsockopt(socket, ZMQ_ZAP_DOMAIN, kDomain.data(), kDomain.size()) != 0) {
    throw std::runtime_error("ZeroMQ takes no domain of authentication");
  }
}

}  // namespace snug::click::wire
