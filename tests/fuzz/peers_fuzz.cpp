// What peers on the wire send: frames of CLICK, RTDE, lines of the dashboard; and the keys that say who they are, by
// the first byte.
#include "fuzz.hpp"
#include "scratch_file.hpp"
#include "snug/click/keys.hpp"
#include "snug/click/message.hpp"
#include "snug/click/sensor_writer.hpp"
#include "snug/ur/dashboard.hpp"
#include "snug/ur/rtde.hpp"

namespace {

using namespace snug;

void answer_frames(std::string_view bytes) {
  ur::InputOwners owners;
  ur::RtdeSession session(ur::facts_of(ur::Model::Ur10), 1, owners);
  ur::RobotInputs inputs;
  while (true) {
    const ur::rtde::NextFrame next = ur::rtde::next_frame(bytes);
    if (next.is_broken || !next.frame) return;
    SNUG_CHECK(next.size >= 3 && next.size <= bytes.size(), "a frame is within what came");
    const std::string reply = session.answer(*next.frame, inputs).bytes;
    SNUG_CHECK(reply.size() <= 65535, "an answer is one frame");
    SNUG_CHECK(session.package(ur::RobotData{}, 0).size() <= 65535, "a package is one frame");
    bytes.remove_prefix(next.size);
  }
}

void decode_twice(std::string_view frame) {
  const Expected<click::Message, std::string> message = click::decode(frame);
  if (!message) {
    SNUG_CHECK(!message.error().empty() && is_utf8(message.error()), "a reason in UTF-8");
    return;
  }
  const std::string bytes = click::encode(*message);
  const Expected<click::Message, std::string> again = click::decode(bytes);
  SNUG_CHECK(again.has_value() && click::encode(*again) == bytes, "what was read can be said, and read again");
}

/// As the secret of a server, as a public key beside it, and as the secret of a client.
void read_keys(std::string_view bytes) {
  static const fuzz::ScratchFolder folder;
  for (const char* name : {"server.key_secret", "cell.key", "server.key"}) folder.write(name, bytes);
  fuzz::expect_answer([] { (void)click::load_server_keys(folder.path()); });
  fuzz::expect_answer([] { (void)click::load_client_keys(folder.path() / "server.key_secret"); });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes = fuzz::text_of(data + 1, size - 1);
  switch (data[0]) {
    case 'r':
      answer_frames(bytes);
      break;
    case 'd':
      SNUG_CHECK(ur::parse_dashboard(bytes).argument.size() <= bytes.size(), "an argument is part of the line");
      break;
    case 'k':
      read_keys(bytes);
      break;
    case 'o':
      (void)click::wire::decode_object(bytes);
      break;
    default:
      decode_twice(bytes);
  }
  return 0;
}
