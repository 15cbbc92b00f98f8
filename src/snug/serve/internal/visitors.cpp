// Visitors: which requests are answered: by the name they ask for, where they come from, and what they know.
#include "snug/serve/internal/visitors.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "snug/serve/internal/guarded_server.hpp"

namespace snug::serve::internal {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// "[::1]:80" and "localhost:80" without port and brackets; nothing when there is anything else.
std::string host_of(std::string_view header) {
  const bool is_bracketed = header.starts_with('[');
  const std::size_t end = is_bracketed ? header.find(']') : std::min(header.find(':'), header.size());
  if (end == std::string_view::npos) return {};
  const std::string_view rest = header.substr(end + (is_bracketed ? 1 : 0));
  const bool is_port =
      rest.empty() || (rest.front() == ':' && rest.size() <= 6 &&
                       std::all_of(rest.begin() + 1, rest.end(), [](char c) { return c >= '0' && c <= '9'; }));
  if (!is_port) return {};
  return std::string(is_bracketed ? header.substr(1, end - 1) : header.substr(0, end));
}

/// Browsers say where a request comes from. A link on another site's page may lead here; nothing else of it has any
/// business here: it could not read the answers, but take the places of watchers.
bool is_from_another_page(const httplib::Request& request) {
  const std::string site = request.get_header_value("Sec-Fetch-Site");
  return (site == "cross-site" || site == "same-site") && request.get_header_value("Sec-Fetch-Mode") != "navigate";
}

/// Of the interfaces that are up, as numbers; now, as they may change.
std::vector<std::string> interface_addresses() {
  ifaddrs* all = nullptr;
  std::vector<std::string> addresses;
  if (::getifaddrs(&all) != 0) return addresses;
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(all, ::freeifaddrs);
  for (const ifaddrs* entry = all; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || (entry->ifa_flags & IFF_UP) == 0 || (entry->ifa_flags & IFF_LOOPBACK) != 0)
      continue;
    std::array<char, INET6_ADDRSTRLEN> text{};
    const int family = entry->ifa_addr->sa_family;
    const void* number = nullptr;
    if (family == AF_INET) number = &reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr;
    if (family == AF_INET6) number = &reinterpret_cast<const sockaddr_in6*>(entry->ifa_addr)->sin6_addr;
    if (number != nullptr && ::inet_ntop(family, number, text.data(), text.size()) != nullptr) {
      addresses.emplace_back(text.data());
    }
  }
  return addresses;
}

std::string machine_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? lower(name.data()) : std::string();
}

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system gives no random numbers");
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) {
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 15U];
  }
  return token;
}

/// In a time that does not tell how much of it is right.
bool is_same(std::string_view one, std::string_view other) {
  unsigned char differs = one.size() != other.size() ? 1 : 0;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
    differs = static_cast<unsigned char>(differs | static_cast<unsigned char>(one[i] ^ other[i]));
  return differs == 0;
}

/// The value of a cookie: "a=1; b=2".
std::string_view find_cookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::string_view part = header.substr(0, header.find(';'));
    header.remove_prefix(std::min(header.size(), part.size() + 1));
    const std::string_view trimmed = part.substr(std::min(part.find_first_not_of(' '), part.size()));
    if (trimmed.size() > name.size() && trimmed.starts_with(name) && trimmed[name.size()] == '=')
      return trimmed.substr(name.size() + 1);
  }
  return {};
}

}  // namespace

Visitors::Visitors(bool is_local, std::vector<std::string> names, int port, TokenUse token)
    : is_local_(is_local), names_(std::move(names)), cookie_("snug" + std::to_string(port)) {
  for (std::string& name : names_) name = lower(name);
  if (!is_local_ || token == TokenUse::Always) token_ = make_token();
  if (is_local_) return;
  if (const std::string name = machine_name(); !name.empty()) names_.insert(names_.end(), {name, name + ".local"});
}

std::string Visitors::query() const { return token_.empty() ? "" : "?token=" + token_; }

std::string Visitors::own_address() {
  for (const std::string& address : interface_addresses()) {
    if (address.find(':') == std::string::npos) return address;
  }
  const std::string name = machine_name();
  return name.empty() ? "127.0.0.1" : name;
}

bool Visitors::is_right_name(const httplib::Request& request) const {
  if (request.get_header_value_count("Host") != 1) return false;
  const std::string& header = request.headers.find("Host")->second;  // get_header_value() ends at a NUL
  const std::string host = lower(host_of(header));
  if (is_loopback_name(host) || std::ranges::find(names_, host) != names_.end()) return !host.empty();
  if (is_local_) return false;
  const std::vector<std::string> own = interface_addresses();
  return std::ranges::find(own, host) != own.end();
}

/// The token, in the address or in the cookie that an address with it leaves.
bool Visitors::knows_token(const httplib::Request& request, httplib::Response& response) const {
  if (token_.empty()) return true;
  if (request.get_param_value_count("token") == 1 && is_same(request.get_param_value("token"), token_)) {
    response.set_header("Set-Cookie", cookie_ + "=" + token_ + "; Path=/; HttpOnly; SameSite=Strict");
    return true;
  }
  return request.get_header_value_count("Cookie") == 1 &&
         is_same(find_cookie(request.get_header_value("Cookie"), cookie_), token_);
}

int Visitors::refuse(const httplib::Request& request, httplib::Response& response) const {
  const auto forbid = [&](const char* why) {
    response.status = 403;
    response.set_content(why, "text/plain");
    return 403;
  };
  if (!is_right_name(request)) {
    return forbid(is_local_ ? "This server answers only to names of this machine.\n"
                            : "This server answers only to names of its machine and to those of --name.\n");
  }
  if (is_from_another_page(request)) {
    response.status = 403;
    return 403;
  }
  if (!knows_token(request, response)) return forbid("Open the address that the program prints: it has a token.\n");
  return 0;
}

}  // namespace snug::serve::internal
