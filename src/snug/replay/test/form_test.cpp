// Tests of the form itself: numbers survive within half a quantum, damage is refused.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <limits>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/replay/form.hpp"

namespace snug::replay {
namespace {

constexpr const char* kHeader = R"({"format": "snug replay", "version": 1})";

Form round_trip(std::span<const ChannelWriter> channels) { return decode_form(encode_form(kHeader, channels), "test"); }

TEST(Form, KeepsEachValueWithinHalfAQuantum) {
  Rng rng = Rng(3).split("form");
  for (const Encoding encoding : {Encoding::Delta, Encoding::Raw}) {
    for (const double quantum : {1.0, 1.0e-5, 0.25, 7.0e3}) {
      ChannelWriter writer({"x", {"a", "b"}, "m", "W", quantum, encoding});
      std::vector<double> values;
      for (int i = 0; i < 500; ++i) {
        const double scale = quantum * std::pow(10.0, rng.uniform(-1.0, 13.0));
        values.push_back(rng.normal() * scale);
        values.push_back(i % 7 == 0 ? values[static_cast<std::size_t>(i)] : 0.1 * i);
        writer.put({values[values.size() - 2], values.back()});
      }
      const Form form = round_trip({&writer, 1});
      ASSERT_EQ(form.channels.size(), 1u);
      EXPECT_EQ(form.channels[0].spec, writer.spec());
      ASSERT_EQ(form.channels[0].values.size(), values.size());
      for (std::size_t i = 0; i < values.size(); ++i) {
        // Half a quantum by rounding; one part in 2^52 more where value / quantum itself rounds.
        EXPECT_NEAR(form.channels[0].values[i], values[i], 0.5 * quantum + 1e-15 * std::abs(values[i])) << i;
      }
    }
  }
}

TEST(Form, TellsValuesThatItCannotHoldFromOthers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  ChannelWriter writer({"x", {"a"}, "", "", 1.0, Encoding::Delta});
  const double largest = 0x1.0p50 - 1.0;
  const std::vector<double> values = {nan, 5.0, nan, 6.0, infinity, -infinity, 1e300, -largest, largest, -largest, 0.0};
  for (const double value : values) writer.put({value});
  const Form form = round_trip({&writer, 1});
  const std::vector<double> expected = {nan, 5.0, nan, 6.0, nan, nan, nan, -largest, largest, -largest, 0.0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(expected[i])) {
      EXPECT_TRUE(std::isnan(form.channels[0].values[i])) << i;
    } else {
      EXPECT_EQ(form.channels[0].values[i], expected[i]) << i;
    }
  }
}

TEST(Form, FindsChannelsByNameAndKeepsEmptyOnes) {
  const std::vector<ChannelWriter> writers = {ChannelWriter({"none", {"a"}, "", "", 1.0, Encoding::Delta}),
                                              ChannelWriter({"also none", {}, "", "", 1.0, Encoding::Raw})};
  const Form form = round_trip(writers);
  ASSERT_NE(find_channel(form, "none"), nullptr);
  EXPECT_EQ(find_channel(form, "none")->rows, 0u);
  EXPECT_EQ(find_channel(form, "nothing"), nullptr);
}

std::string complaint(std::string_view bytes, std::size_t max_bytes = 1U << 20U) {
  try {
    (void)decode_form(bytes, "x.replay", max_bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A form of any header and data, as a forger would write it.
std::string forged(const std::string& header, const std::string& data, std::size_t claimed_length) {
  std::string plain;
  for (unsigned shift = 0; shift < 32; shift += 8)
    plain.push_back(static_cast<char>((claimed_length >> shift) & 0xFFU));
  plain += header + data;
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
           static_cast<uLong>(plain.size()));
  return "SNUGRPL1" + packed.substr(0, size);
}

std::string forged_channel(const std::string& fields, const std::string& data) {
  const std::string header =
      R"({"format": "snug replay", "version": 1, "channels": [{"name": "x", "columns": ["a"], "unit": "", "frame": "", )" +
      fields + "}]}";
  return forged(header, data, header.size());
}

TEST(Form, RefusesDamageWithAMessage) {
  ChannelWriter writer({"x", {"a"}, "", "", 1.0, Encoding::Delta});
  for (int i = 0; i < 1000; ++i) writer.put({std::sin(i) * 1e6});
  const std::string whole = encode_form(kHeader, {&writer, 1});
  EXPECT_EQ(complaint(whole), "");
  EXPECT_NE(complaint(""), "");
  EXPECT_NE(complaint("SNUGRPL1"), "");
  EXPECT_NE(complaint("SNUGRPL2" + whole.substr(8)), "");
  for (std::size_t cut = 9; cut < whole.size(); cut += 97) EXPECT_NE(complaint(whole.substr(0, cut)), "") << cut;
  Rng rng = Rng(5).split("damage");
  for (int i = 0; i < 300; ++i) {  // zlib's checksum finds each single damaged byte
    std::string damaged = whole;
    char& byte = damaged[8 + static_cast<std::size_t>(rng.index(static_cast<int>(whole.size()) - 8))];
    byte = static_cast<char>(byte ^ (1 + rng.index(255)));
    EXPECT_NE(complaint(damaged), "") << i;
  }
}

TEST(Form, RefusesForgeriesThatInflateWell) {
  EXPECT_NE(complaint(forged("{}", "", 2)), "");
  EXPECT_NE(complaint(forged("{}", "", 4000000000U)), "");
  EXPECT_NE(complaint(forged("[1", "", 2)), "");
  const std::string newer = R"({"format": "snug replay", "version": 2, "channels": []})";
  EXPECT_NE(complaint(forged(newer, "", newer.size())).find("version"), std::string::npos);
  const std::string good = R"("quantum": 1, "rows": 2, "offset": 0, "bytes": 2, "encoding": "delta")";
  EXPECT_EQ(complaint(forged_channel(good, "\x01\x01")), "");
  EXPECT_NE(complaint(forged_channel(good, "\x01")), "");
  EXPECT_NE(complaint(forged_channel(good, "\x01\x81")), "");
  const std::string many = R"("quantum": 1, "rows": 99999999999, "offset": 0, "bytes": 2, "encoding": "delta")";
  EXPECT_NE(complaint(forged_channel(many, "\x01\x01")), "");
  const std::string outside =
      R"("quantum": 1, "rows": 1, "offset": 18446744073709551615, "bytes": 2, "encoding": "raw")";
  EXPECT_NE(complaint(forged_channel(outside, "\x01\x01")), "");
  const std::string negative = R"("quantum": 1, "rows": -1, "offset": 0, "bytes": 2, "encoding": "raw")";
  EXPECT_NE(complaint(forged_channel(negative, "\x01\x01")), "");
  EXPECT_NE(complaint(forged("{}", std::string(1U << 21U, ' '), 2)).find("more than"), std::string::npos);
}

}  // namespace
}  // namespace snug::replay
