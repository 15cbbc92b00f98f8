// ContactLog: stores contacts so that those that stay as they were cost nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "snug/record/internal/column.hpp"
#include "snug/record/recording.hpp"

namespace snug::record::internal {

/// A run of consecutive contacts between the same two bodies, as it lies in the file.
struct ContactBlock {
  std::int32_t body_a = 0;
  std::int32_t body_b = 0;
  std::int32_t count = 0;
  std::int32_t row = -1;  ///< of the file's block table; -1: not stored yet
  std::size_t first = 0;  ///< into the packed contacts of its frame
};

/// A contact as it is stored, rounded.
struct PackedContact {
  float point[3];
  float normal[3];
  float force[3];
  float gap;
  std::uint32_t state;
};

/// Splits each frame's contacts into blocks of one pair of bodies. A block equal to one of the previous frame is
/// stored by reference to that; a frame whose blocks are all those of the previous frame refers to its whole list.
class ContactLog {
 public:
  explicit ContactLog(hid_t file);
  struct Range {
    std::int64_t first = 0;
    std::int32_t count = 0;
  };
  /// Where the frame's block numbers lie in /contacts/frame_block. `contacts` have valid body indices.
  Range append(const std::vector<ContactSample>& contacts);
  /// Writes what was appended since the last call.
  void write();

 private:
  void pack(const std::vector<ContactSample>& contacts);
  [[nodiscard]] bool match_previous_blocks();
  [[nodiscard]] std::size_t find_previous(const ContactBlock& block, std::size_t cursor) const;
  [[nodiscard]] bool is_equal(const ContactBlock& block, const ContactBlock& previous) const;
  void store_block(ContactBlock& block);

  std::vector<FlatColumn> columns_;
  std::vector<ContactSample> contacts_;  ///< of the previous frame, as given
  std::vector<PackedContact> packed_, previous_packed_;
  std::vector<ContactBlock> blocks_, previous_blocks_;
  Range range_;                  ///< of the previous frame
  std::int64_t list_rows_ = 0;   ///< rows of frame_block so far
  std::int32_t block_rows_ = 0;  ///< rows of the block table so far
  std::int64_t point_rows_ = 0;  ///< rows of the point tables so far
};

}  // namespace snug::record::internal
