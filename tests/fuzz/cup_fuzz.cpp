// Questions to the cup model, one JSON object: evaluate and settle, by the first byte. Answers are JSON again.
#include <nlohmann/json.hpp>

#include "fuzz.hpp"
#include "snug/cup/json_lines.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  if (size == 0) return 0;
  const std::string_view line = fuzz::text_of(data + 1, size - 1);
  fuzz::expect_answer([&] {
    const std::string answer =
        data[0] == 'e' ? cup::evaluate_json_line(line, 1, "x") : cup::settle_json_line(line, 1, "x");
    SNUG_CHECK(nlohmann::json::accept(answer), "an answer in JSON");
  });
  return 0;
}
