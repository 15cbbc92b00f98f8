// Connections: descriptors that are used again name nobody who had them before.
#include "snug/served_cell/internal/connections.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace snug::served_cell::internal {
namespace {

using Sender = Connections::Sender;
using namespace std::string_literals;

/// A connection of this process with itself.
class Pair {
 public:
  Pair() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds_.data()), 0); }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  ~Pair() { close(); }
  [[nodiscard]] int fd() const { return fds_[0]; }
  void close() {
    for (int& fd : fds_) {
      if (fd >= 0) ::close(fd);
      fd = -1;
    }
  }

 private:
  std::array<int, 2> fds_ = {-1, -1};
};

TEST(Connections, KnowWhoIsThereUntilTheConnectionIsClosed) {
  Connections connections;
  EXPECT_FALSE(connections.is_there("a"));
  Pair pair;
  EXPECT_EQ(connections.see("a", pair.fd()), Sender::Known);
  EXPECT_EQ(connections.see("a", pair.fd()), Sender::Known);
  connections.forget_closed();
  EXPECT_TRUE(connections.is_there("a"));
  const int fd = pair.fd();
  pair.close();
  EXPECT_FALSE(connections.is_there("a"));
  EXPECT_EQ(connections.see("a", fd), Sender::Gone);
  connections.forget_closed();
  EXPECT_FALSE(connections.is_there("a"));
}

TEST(Connections, DescriptorIsOfWhoUsesItNow) {
  Connections connections;
  Pair first;
  const int fd = first.fd();
  EXPECT_EQ(connections.see("a", fd), Sender::Known);
  first.close();
  Pair second;
  ASSERT_EQ(second.fd(), fd) << "the kernel gives the lowest one";
  EXPECT_FALSE(connections.is_there("a"));
  EXPECT_EQ(connections.see("b", fd), Sender::Known);
  EXPECT_TRUE(connections.is_there("b"));
  EXPECT_FALSE(connections.is_there("a"));
}

// Two messages of a peer that is gone, read before and after one of the peer that has its descriptor.
TEST(Connections, MessageThatIsReadLateNamesNobodyElse) {
  for (const auto& [gone, there] : {std::pair{"\0\xff\xff\xff\xff"s, "\0\0\0\0\0"s}, std::pair{"old"s, "new"s}}) {
    Connections connections;
    Pair pair;
    EXPECT_EQ(connections.see(gone, pair.fd()), Sender::Known) << "nobody can know yet";
    EXPECT_EQ(connections.see(there, pair.fd()), Sender::Known);
    EXPECT_FALSE(connections.is_there(gone));
    EXPECT_EQ(connections.see(gone, pair.fd()), Sender::Gone);
    EXPECT_TRUE(connections.is_there(there));
  }
}

TEST(Connections, WhoCameBeforeIsGoneThoughItIsReadLater) {
  Connections connections;
  Pair pair;
  EXPECT_EQ(connections.see("\0\0\0\0\x02"s, pair.fd()), Sender::Known);
  EXPECT_EQ(connections.see("\0\0\0\0\x01"s, pair.fd()), Sender::Gone);
  EXPECT_TRUE(connections.is_there("\0\0\0\0\x02"s));
  EXPECT_FALSE(connections.is_there("\0\0\0\0\x01"s));
}

TEST(Connections, PeerThatKeepsItsNameComesBackByAnother) {
  Connections connections;
  Pair first, second;
  EXPECT_EQ(connections.see("a", first.fd()), Sender::Known);
  EXPECT_EQ(connections.see("a", second.fd()), Sender::Back);
  EXPECT_EQ(connections.see("a", second.fd()), Sender::Known);
  first.close();
  connections.forget_closed();
  EXPECT_TRUE(connections.is_there("a"));
}

TEST(Connections, DescriptorsThatAreNoneOfASocketAreNobodys) {
  Connections connections;
  EXPECT_EQ(connections.see("a", 0x7fffffff), Sender::Gone);
  std::array<int, 2> pipe = {};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  EXPECT_EQ(connections.see("a", pipe[0]), Sender::Gone);
  ::close(pipe[0]);
  ::close(pipe[1]);
  EXPECT_EQ(connections.see("a", -1), Sender::Known) << "ZeroMQ does not say";
  connections.forget_closed();
  EXPECT_TRUE(connections.is_there("a"));
}

}  // namespace
}  // namespace snug::served_cell::internal
