// Socket: what the server and the client need of ZeroMQ, with errors as exceptions and addresses that are checked
// first.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace snug::click::wire {

/// Contexts and sockets are those of zmq.h, which files that set options include themselves.
struct CloseContext {
  void operator()(void* context) const;
};
struct CloseSocket {
  void operator()(void* socket) const;
};
using Context = std::unique_ptr<void, CloseContext>;
using Socket = std::unique_ptr<void, CloseSocket>;

[[nodiscard]] Context make_context();
/// Closing it drops what was not sent within `linger_ms`.
[[nodiscard]] Socket make_socket(void* context, int type, int linger_ms = 0);
void set(void* socket, int option, int value);
void set(void* socket, int option, std::int64_t value);
void set(void* socket, int option, const std::string& value);

/// Throws InputError, naming the option --click, unless it is tcp://HOST:PORT or ipc://PATH.
void check_endpoint(const std::string& endpoint);
/// Can other machines reach a socket that is bound to it? tcp://127.0.0.1:5555, localhost, [::1] and ipc: no.
[[nodiscard]] bool is_local(const std::string& endpoint);
/// The file of ipc://PATH; empty for tcp and for names that are no files.
[[nodiscard]] std::string path_of(const std::string& endpoint);

/// The parts of one message, the first eight. `fd`: of the connection it came by, -1 when unknown.
struct Parts {
  std::vector<std::string> parts;
  int fd = -1;
};
/// False when there is none now. Throws std::runtime_error for a socket that cannot be used any more.
[[nodiscard]] bool receive(void* socket, Parts& message);
/// False when it cannot be sent now.
bool send(void* socket, std::string_view part, bool has_more);

}  // namespace snug::click::wire
