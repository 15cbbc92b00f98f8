// ProtobufMessages: messages made as JSON in the encoding of protocol buffers, by the schemas of proto/. Internal to
// the module.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "snug/replay/internal/mcap_messages.hpp"

namespace snug::replay::internal {

/// Knows the schemas of proto/ by names such as "foxglove.SceneUpdate". They are in a pool of its own: a program that
/// has the same messages in code of its own, or in another version, is not disturbed.
class ProtobufMessages {
 public:
  ProtobufMessages();
  ~ProtobufMessages();
  ProtobufMessages(const ProtobufMessages&) = delete;
  ProtobufMessages& operator=(const ProtobufMessages&) = delete;

  /// A serialised FileDescriptorSet: the file of the message `type` and all that it imports.
  [[nodiscard]] std::string descriptors_of(std::string_view type) const;
  /// `message` as `type`. Times are written {"sec", "nsec"}; a key that the schema does not have, or whose value is of
  /// another kind, stops the program. Numbers keep every bit.
  [[nodiscard]] std::string encode(std::string_view type, const Json& message);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::replay::internal
