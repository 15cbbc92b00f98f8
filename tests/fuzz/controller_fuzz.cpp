// What a controller of Universal Robots says to who drives it: RTDE and the primary port, by the first byte. The same
// bytes come on every connection; then the controller has gone.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "fuzz.hpp"
#include "snug/remote_ur/rtde_link.hpp"
#include "snug/ur/primary_reader.hpp"

namespace {

using namespace snug;

/// What the other side sent; nothing follows, and what it is told it does not read.
class Said {
 public:
  explicit Said(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] remote_ur::Connection connect() {
    int ends[2] = {-1, -1};
    SNUG_CHECK(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) == 0, "two descriptors");
    Descriptor here(ends[0]);
    there_ = Descriptor(ends[1]);
    SNUG_CHECK(::send(there_.get(), bytes_.data(), bytes_.size(), MSG_NOSIGNAL) >= 0 || bytes_.empty(),
               "room for them");
    (void)::shutdown(there_.get(), SHUT_WR);
    return remote_ur::Connection(std::move(here), "controller", 1.0);
  }

 private:
  std::string_view bytes_;
  Descriptor there_;
};

void drive(std::string_view bytes) {
  Said said(bytes);
  fuzz::expect_answer([&] {
    remote_ur::RtdeLink link([&said] { return said.connect(); });
    remote_ur::RobotCommand command;
    for (int i = 0; i < 8; ++i) {
      remote_ur::RobotSample sample;
      const std::string trouble = link.exchange(command, sample);
      SNUG_CHECK(is_utf8(trouble) && printable(trouble, kLongestMessage) == trouble, "a reason that can be shown");
      if (!trouble.empty()) return;
      for (const ur::Values6* values : {&sample.q, &sample.qd, &sample.target_q, &sample.tcp_force})
        SNUG_CHECK(std::ranges::all_of(*values, [](double one) { return std::isfinite(one); }), "numbers");
      command.q[0] = sample.q;
    }
  });
}

void read_packets(std::string_view bytes) {
  while (true) {
    const ur::NextPacket next = ur::next_packet(bytes);
    if (next.is_broken || !next.packet) return;
    SNUG_CHECK(!next.packet->empty() && next.packet->size() <= bytes.size(), "a packet is within what came");
    (void)ur::read_robot_state(*next.packet);
    (void)ur::read_version(*next.packet);
    (void)ur::read_runtime_exception(*next.packet);
    bytes.remove_prefix(next.packet->size());
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes = fuzz::text_of(data + 1, size - 1);
  if (data[0] == 'p')
    read_packets(bytes);
  else
    drive(bytes);
  return 0;
}
