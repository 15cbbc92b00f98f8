// URScript: programs of files and of clients, cut from a stream, read, and run for some periods on an arm that follows.
#include "fuzz.hpp"
#include "snug/urscript/test/fake_host.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug::urscript;
  const std::string_view text = snug::fuzz::text_of(data, size);
  SNUG_CHECK(find_program_end(text) <= text.size(), "the end of a program is within what came");
  snug::Expected<Program, ScriptError> program = parse(text);
  if (!program) {
    const ScriptError& error = program.error();
    SNUG_CHECK(!error.text.empty() && error.line >= 0 && error.column >= 0, "a mistake is told, with its place");
    return 0;
  }
  MachineLimits limits;
  limits.instructions_per_step = 2000;
  limits.memory = 100'000;
  limits.value_size = 10'000;
  Machine machine(std::move(*program), limits);
  test::FakeHost host;
  for (int i = 0; i < 20 && machine.status().is_active(); ++i) {
    machine.step(host);
    for (std::size_t j = 0; j < kJoints; ++j) {
      SNUG_CHECK(std::isfinite(host.state_.target.q[j]) && std::isfinite(host.state_.target.qd[j]),
                 "the arm is told numbers");
    }
    host.state_.q = host.state_.target.q;
    host.state_.qd = host.state_.target.qd;
  }
  return 0;
}
