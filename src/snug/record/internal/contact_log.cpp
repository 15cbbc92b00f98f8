// ContactLog: stores contacts so that those that stay as they were cost nothing.
#include "snug/record/internal/contact_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "snug/record/internal/layout.hpp"

namespace snug::record::internal {
namespace {

/// Nearest multiple of the power of two `quantum`, to even. Values beyond 2^24 quanta are left to single precision,
/// whose spacing is coarser there; NaN and infinity pass.
float quantized(double value, double quantum) {
  if (!(std::abs(value) < 0x1.0p24 * quantum)) return static_cast<float>(value);
  // Adding 1.5 * 2^52 quanta leaves no bits below one quantum, so the sum is rounded to it.
  const double shift = 0x1.8p52 * quantum;
  return static_cast<float>((value + shift) - shift);
}

void quantize(const Vector3& value, double quantum, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = quantized(value[i], quantum);
}

PackedContact packed_from(const ContactSample& contact) {
  PackedContact packed;
  quantize(contact.p_WQ, kPointQuantum, packed.point);
  quantize(contact.n_AB_W, kPointQuantum, packed.normal);
  quantize(contact.force_B_W, kForceQuantum, packed.force);
  packed.gap = quantized(contact.phi, kGapQuantum);
  packed.state = static_cast<std::uint32_t>(contact.state);
  return packed;
}

/// Same bits, bodies included.
bool is_same(const ContactSample& a, const ContactSample& b) {
  const auto* begin = reinterpret_cast<const unsigned char*>(&a);
  const auto* end = reinterpret_cast<const unsigned char*>(&a.state);  // the last member; padding follows it
  return std::memcmp(begin, &b, static_cast<std::size_t>(end - begin)) == 0 && a.state == b.state;
}
static_assert(sizeof(ContactSample) == 2 * sizeof(int) + 11 * sizeof(double), "no padding before the state");

/// Number of contacts at the beginning that are the same in both.
std::size_t count_equal(const std::vector<ContactSample>& a, const std::vector<ContactSample>& b) {
  const std::size_t size = std::min(a.size(), b.size());
  std::size_t i = 0;
  while (i < size && is_same(a[i], b[i])) ++i;
  return i;
}

}  // namespace

ContactLog::ContactLog(hid_t file) {
  for (std::size_t i = 0; i < kContactColumnCount; ++i)
    columns_.emplace_back(file, contact_column(static_cast<ContactColumn>(i)));
}

ContactLog::Range ContactLog::append(const std::vector<ContactSample>& contacts) {
  const std::size_t kept = count_equal(contacts, contacts_);
  if (kept == contacts.size() && kept == contacts_.size()) return range_;
  std::swap(packed_, previous_packed_);
  std::swap(blocks_, previous_blocks_);
  pack(contacts);
  contacts_ = contacts;
  if (match_previous_blocks()) return range_;
  range_ = {list_rows_, static_cast<std::int32_t>(blocks_.size())};
  for (ContactBlock& block : blocks_) {
    if (block.row < 0) store_block(block);
    columns_[kFrameBlock].put(&block.row, 1);
  }
  list_rows_ += range_.count;
  return range_;
}

void ContactLog::pack(const std::vector<ContactSample>& contacts) {
  packed_.resize(contacts.size());
  blocks_.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactSample& contact = contacts[i];
    PackedContact& packed = packed_[i];
    if (i < contacts_.size() && is_same(contact, contacts_[i]))
      packed = previous_packed_[i];
    else
      packed = packed_from(contact);
    if (blocks_.empty() || blocks_.back().body_a != contact.body_a || blocks_.back().body_b != contact.body_b)
      blocks_.push_back({contact.body_a, contact.body_b, 0, -1, i});
    ++blocks_.back().count;
  }
}

/// Finds the blocks of this frame among those of the previous one; true when they are all there, in the same order.
bool ContactLog::match_previous_blocks() {
  bool is_same_list = blocks_.size() == previous_blocks_.size();
  std::size_t cursor = 0;  // the order of pairs rarely changes: look behind the last match first, then all around
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const std::size_t j = find_previous(blocks_[i], cursor);
    if (j == previous_blocks_.size()) {
      is_same_list = false;
      continue;
    }
    cursor = j + 1;
    if (is_equal(blocks_[i], previous_blocks_[j])) blocks_[i].row = previous_blocks_[j].row;
    is_same_list = is_same_list && i == j && blocks_[i].row >= 0;
  }
  return is_same_list;
}

/// The first block of the same pair in the previous frame, from `cursor` on and around; their number if there is none.
std::size_t ContactLog::find_previous(const ContactBlock& block, std::size_t cursor) const {
  const std::size_t count = previous_blocks_.size();
  for (std::size_t tried = 0; tried < count; ++tried) {
    const std::size_t j = (cursor + tried) % count;
    if (previous_blocks_[j].body_a == block.body_a && previous_blocks_[j].body_b == block.body_b) return j;
  }
  return count;
}

bool ContactLog::is_equal(const ContactBlock& block, const ContactBlock& previous) const {
  if (block.count != previous.count) return false;
  const std::size_t bytes = static_cast<std::size_t>(block.count) * sizeof(PackedContact);
  return std::memcmp(&packed_[block.first], &previous_packed_[previous.first], bytes) == 0;
}

void ContactLog::store_block(ContactBlock& block) {
  const std::int32_t bodies[2] = {block.body_a, block.body_b};
  columns_[kBlockBody].put(bodies, 1);
  columns_[kBlockFirst].put(&point_rows_, 1);
  columns_[kBlockCount].put(&block.count, 1);
  for (std::int32_t i = 0; i < block.count; ++i) {
    const PackedContact& contact = packed_[block.first + static_cast<std::size_t>(i)];
    const auto state = static_cast<std::uint8_t>(contact.state);
    columns_[kPoint].put(contact.point, 1);
    columns_[kNormal].put(contact.normal, 1);
    columns_[kForce].put(contact.force, 1);
    columns_[kGap].put(&contact.gap, 1);
    columns_[kState].put(&state, 1);
  }
  block.row = block_rows_++;
  point_rows_ += block.count;
}

void ContactLog::write() {
  for (FlatColumn& column : columns_) column.write();
}

}  // namespace snug::record::internal
