// Socket: what the server and the client need of ZeroMQ, with errors as exceptions and addresses that are checked
// first.
#include "snug/click/socket.hpp"

#include <zmq.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include "snug/core/input_error.hpp"

namespace snug::click::wire {
namespace {

[[noreturn]] void fail(const char* what) { throw std::runtime_error(std::string(what) + ": " + zmq_strerror(errno)); }

[[noreturn]] void refuse(const std::string& endpoint) {
  throw InputError("command line", "--click", "'" + endpoint + "'", "tcp://HOST:PORT or ipc://PATH");
}

constexpr std::size_t kMostParts = 8;  ///< of a message; what comes behind is dropped

class Frame {
 public:
  Frame() { zmq_msg_init(&message_); }
  ~Frame() { zmq_msg_close(&message_); }
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;
  [[nodiscard]] zmq_msg_t* get() { return &message_; }

 private:
  zmq_msg_t message_;
};

}  // namespace

void CloseContext::operator()(void* context) const { zmq_ctx_term(context); }
void CloseSocket::operator()(void* socket) const { zmq_close(socket); }

Context make_context() {
  Context context(zmq_ctx_new());
  if (!context) fail("ZeroMQ");
  return context;
}

Socket make_socket(void* context, int type, int linger_ms) {
  Socket socket(zmq_socket(context, type));
  if (!socket) fail("ZeroMQ socket");
  set(socket.get(), ZMQ_LINGER, linger_ms);
  return socket;
}

void set(void* socket, int option, int value) {
  if (zmq_setsockopt(socket, option, &value, sizeof value) != 0) fail("ZeroMQ option");
}

void set(void* socket, int option, std::int64_t value) {
  if (zmq_setsockopt(socket, option, &value, sizeof value) != 0) fail("ZeroMQ option");
}

void set(void* socket, int option, const std::string& value) {
  if (zmq_setsockopt(socket, option, value.c_str(), value.size()) != 0) fail("ZeroMQ option");
}

void check_endpoint(const std::string& endpoint) {
  if (endpoint.starts_with("ipc://") && endpoint.size() > 6) return;
  if (!endpoint.starts_with("tcp://")) refuse(endpoint);
  const std::size_t colon = endpoint.rfind(':');
  const std::string host = endpoint.substr(6, colon > 6 ? colon - 6 : 0), port = endpoint.substr(colon + 1);
  const bool is_number = !port.empty() && port.size() <= 5 &&
                         std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
                         std::stoi(port) <= 65535;
  if (colon <= 6 || host.empty() || (port != "*" && !is_number)) refuse(endpoint);
}

bool is_local(const std::string& endpoint) {
  if (endpoint.starts_with("ipc://")) return true;
  const std::string host = endpoint.substr(6, endpoint.rfind(':') - 6);
  if (host == "localhost" || host == "[::1]" || host == "::1" || host == "lo") return true;
  return host.starts_with("127.") &&
         std::all_of(host.begin(), host.end(), [](char c) { return c == '.' || (c >= '0' && c <= '9'); });
}

std::string path_of(const std::string& endpoint) {
  if (!endpoint.starts_with("ipc://") || endpoint == "ipc://*") return {};
  const std::string path = endpoint.substr(6);
  return path.starts_with('@') ? "" : path;  // a name that is not in the file system
}

bool receive(void* socket, Parts& message) {
  message.parts.clear();
  message.fd = -1;
  for (bool has_more = true; has_more;) {
    Frame frame;
    if (zmq_msg_recv(frame.get(), socket, ZMQ_DONTWAIT) < 0) {
      if (errno == EAGAIN && message.parts.empty()) return false;
      if (errno == EINTR) continue;
      fail("receiving");
    }
    has_more = zmq_msg_more(frame.get()) != 0;
    message.fd = zmq_msg_get(frame.get(), ZMQ_SRCFD);
    if (message.parts.size() == kMostParts) continue;
    message.parts.emplace_back(static_cast<const char*>(zmq_msg_data(frame.get())), zmq_msg_size(frame.get()));
  }
  return true;
}

bool send(void* socket, std::string_view part, bool has_more) {
  const int flags = ZMQ_DONTWAIT | (has_more ? ZMQ_SNDMORE : 0);
  for (int tries = 0; tries < 3; ++tries) {
    if (zmq_send(socket, part.data(), part.size(), flags) >= 0) return true;
    if (errno != EINTR && errno != EAGAIN) return false;
    // ZeroMQ looks at what peers have read only now and then, unless it is asked for events: there may be room.
    int events = 0;
    std::size_t size = sizeof events;
    (void)zmq_getsockopt(socket, ZMQ_EVENTS, &events, &size);
  }
  return false;
}

}  // namespace snug::click::wire
