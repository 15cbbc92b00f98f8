// Connections: which peers are still there, whatever ZeroMQ's news of them says and when.
#include "snug/served_cell/internal/connections.hpp"

#include <sys/stat.h>

#include <cstdint>

namespace snug::served_cell::internal {
namespace {

constexpr Connection kUnknown = {-1, 1};

/// Routing ids that ZeroMQ makes: a zero byte and a number that counts connections.
bool is_counted(const std::string& peer) { return peer.size() == 5 && peer[0] == '\0'; }

std::uint32_t count_of(const std::string& peer) {
  std::uint32_t count = 0;
  for (std::size_t i = 1; i < 5; ++i) count = count << 8U | static_cast<unsigned char>(peer[i]);
  return count;
}

/// Did it connect before the other? Known when both are counted; else who is seen first.
bool came_before(const std::string& peer, const std::string& other) {
  constexpr std::uint32_t kHalf = 1U << 31U;  // numbers begin anywhere and may begin again at 0
  return is_counted(peer) && is_counted(other) && count_of(other) - count_of(peer) < kHalf;
}

}  // namespace

Connection find_connection(int fd) {
  struct stat status = {};
  if (fd < 0 || ::fstat(fd, &status) != 0 || !S_ISSOCK(status.st_mode)) return {};
  return {fd, status.st_ino};
}

Connections::Sender Connections::see(const std::string& peer, int fd) {
  if (fd < 0) {
    of_peers_[peer] = kUnknown;
    return Sender::Known;
  }
  const Connection now = find_connection(fd);
  if (now.fd < 0) {
    of_peers_.erase(peer);
    return Sender::Gone;
  }
  const auto [entry, is_new] = of_peers_.try_emplace(peer, now);
  std::string& owner = peers_.try_emplace(now, peer).first->second;
  const bool was_here = !is_new && entry->second == now;
  if (owner != peer && (was_here || came_before(peer, owner))) {
    entry->second = now;
    return Sender::Gone;
  }
  owner = peer;
  entry->second = now;
  return is_new || was_here ? Sender::Known : Sender::Back;
}

bool Connections::is_there(const std::string& peer) const {
  const auto found = of_peers_.find(peer);
  if (found == of_peers_.end()) return false;
  const Connection& connection = found->second;
  if (connection == kUnknown) return true;
  const auto owner = peers_.find(connection);
  return owner != peers_.end() && owner->second == peer && find_connection(connection.fd) == connection;
}

void Connections::forget_closed() {
  std::erase_if(peers_, [](const auto& entry) { return find_connection(entry.first.fd) != entry.first; });
  std::erase_if(of_peers_,
                [this](const auto& entry) { return entry.second != kUnknown && !peers_.contains(entry.second); });
}

}  // namespace snug::served_cell::internal
