// JSON of structs: every bit comes back, and what does not fit is said with its path.
#include "snug/core/json_archive.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "snug/core/rng.hpp"

namespace snug {
namespace test {

enum class Colour { Red, Green };
const char* name_of(Colour colour) { return colour == Colour::Red ? "red" : "green"; }

struct Inner {
  double number = 0.0;
  std::optional<int> maybe;
  template <class Archive>
  void fields(Archive& a) {
    a("number", number);
    a("maybe", maybe);
  }
  bool operator==(const Inner&) const = default;
};

struct Outer {
  std::string text;
  bool flag = false;
  std::uint64_t seed = 0;
  int below = 0;
  Colour colour = Colour::Red;
  std::vector<Inner> parts;
  template <class Archive>
  void fields(Archive& a) {
    a("text", text);
    a("flag", flag);
    a("seed", seed);
    a("below", below);
    a("colour", colour);
    a("parts", parts);
  }
  bool operator==(const Outer&) const = default;
};

}  // namespace test

template <>
struct JsonEnum<test::Colour> {
  static constexpr std::array all{test::Colour::Red, test::Colour::Green};
};

namespace {

using test::Colour;
using test::Outer;

Outer read(const std::string& text) {
  const JsonValue value = parse_json(text, "file.json");
  return JsonReader(value, "file.json").as<Outer>();
}

TEST(JsonArchive, GivesBackEveryBit) {
  Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    Outer one{"quote \" \\ \n", i % 2 == 0, rng.next(), -i, i % 3 == 0 ? Colour::Green : Colour::Red, {}};
    one.parts.push_back({std::bit_cast<double>(rng.next()), i});
    one.parts.push_back({rng.normal() * std::pow(10.0, rng.uniform(-300.0, 300.0)), std::nullopt});
    if (std::isnan(one.parts[0].number)) one.parts[0].number = std::numeric_limits<double>::infinity();
    EXPECT_EQ(read(format_json(write_json(one))), one);
  }
}

TEST(JsonArchive, NumbersThatAreNotFiniteComeBack) {
  for (const double value : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(read(format_json(write_json(Outer{"", false, 0, 0, {}, {{value, {}}}}))).parts[0].number, value);
  }
  EXPECT_TRUE(
      std::isnan(read(format_json(write_json(Outer{"", false, 0, 0, {}, {{std::nan(""), {}}}}))).parts[0].number));
}

TEST(JsonArchive, SaysWhatIsWrongAndWhere) {
  const std::string good = format_json(write_json(Outer{"a", true, 1, -1, Colour::Red, {{0.5, 2}}}));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    try {
      (void)read(text);
    } catch (const InputError& error) {
      return error.key + ": " + error.got + ", " + error.expected;
    }
    return std::string("nothing");
  };
  EXPECT_EQ(changed("0.5", "\"half\""), "parts.[0].number: text, a number");
  EXPECT_EQ(changed("true", "1"), "flag: a number, true or false");
  EXPECT_EQ(changed("\"red\"", "\"blue\""), "colour: 'blue', one of 'red' 'green'");
  EXPECT_EQ(changed("\"seed\":1", "\"seed\":-1"), "seed: a number, a whole number, not below 0");
  EXPECT_EQ(changed("\"below\":-1", "\"below\":-1e30"), "below: a number, a whole number");
  EXPECT_EQ(changed("\"text\":\"a\",", ""), "text: nothing, this key");
  EXPECT_EQ(changed("\"flag\":true", "\"flag\":true,\"flags\":3"), "flags: an unknown key, flag");
}

TEST(JsonArchive, TextThatIsNoJsonIsSaidWithItsLine) {
  for (const std::string text : {"{\n\n!", "{\"a\": 1,\n\n}", "\n\n"}) {
    try {
      (void)parse_json(text, "file.json", 10);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_EQ(error.where, "file.json:12") << text;
    }
  }
}

TEST(JsonArchive, NumbersThatAreTooLargeAreSaid) {
  try {
    (void)parse_json(R"({"time": 1e999})", "file.json", 3);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "file.json:3");
    EXPECT_NE(error.got.find("double precision"), std::string::npos);
  }
}

TEST(JsonArchive, DeepTextIsRefusedAndLongTextIsNot) {
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') + std::string(static_cast<std::size_t>(depth), ']');
  };
  EXPECT_NO_THROW((void)parse_json(nested(kDeepestJson), "x"));
  EXPECT_THROW((void)parse_json(nested(kDeepestJson + 1), "x"), InputError);
  EXPECT_THROW((void)parse_json(nested(300000), "x"), InputError);
  EXPECT_NO_THROW((void)parse_json("\"" + std::string(1000, '[') + "\\\"" + std::string(1000, '{') + "\"", "x"));
  std::string list = "[";
  for (int i = 0; i < 1000; ++i) list += "[],{},";
  EXPECT_NO_THROW((void)parse_json(list + "0]", "x"));
}

}  // namespace
}  // namespace snug
