// Keys: who may drive a served cell: CurveZMQ key pairs in a folder, and what each side reads of them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace snug::click {

/// A key as ZeroMQ writes it: Z85, 40 characters.
struct KeyPair {
  std::string public_key, secret_key;
  bool operator==(const KeyPair&) const = default;
};

/// What a server needs: its own secret, and the public keys of those that may come.
struct ServerKeys {
  KeyPair own;
  std::vector<std::string> allowed;
};

/// What a controller or observer needs: whom it expects to meet, and who it is.
struct ClientKeys {
  std::string server_public_key;
  KeyPair own;
};

/// A folder of keys has NAME.key (public: hand it on) and NAME.key_secret (only its owner may read it) for each name,
/// in the form of certificates that other programs with ZeroMQ read too (RFC 4, zmq.auth of Python). `server` is the
/// served cell.
inline constexpr const char* kServerName = "server";

/// Makes a pair and the folder where there is none. Throws InputError where the name has a key already, is none
/// (letters, digits, - and _), or the folder cannot be written.
void make_keys(const std::filesystem::path& folder, const std::string& name);
[[nodiscard]] bool has_keys(const std::filesystem::path& folder, const std::string& name);

/// server.key_secret, and every NAME.key beside it as allowed. Throws InputError for what is missing, cannot be read,
/// or is a secret that others on this machine can read.
[[nodiscard]] ServerKeys load_server_keys(const std::filesystem::path& folder);
/// `place`: a folder with server.key and one NAME.key_secret, or that file itself where there are more. Throws as
/// load_server_keys.
[[nodiscard]] ClientKeys load_client_keys(const std::filesystem::path& place);
/// None where no place is named.
[[nodiscard]] std::optional<ClientKeys> find_client_keys(const std::optional<std::string>& place);

}  // namespace snug::click
