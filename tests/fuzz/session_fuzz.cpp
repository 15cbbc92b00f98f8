// What sessions and studies leave and take again: logs of events, beliefs, results, inputs of rows, faults, orders of
// operators, profiles of shaking, keys with values, and the robot's description as a recording holds it, by the first
// byte.
#include "fuzz.hpp"
#include "snug/model/scenario_edit.hpp"
#include "snug/planning/belief_json.hpp"
#include "snug/robot/arm.hpp"
#include "snug/robot/link_tree.hpp"
#include "snug/robot/visuals.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/shake_profile.hpp"
#include "snug/session/operator.hpp"
#include "snug/session/resume.hpp"
#include "snug/simulated_plant/faults.hpp"
#include "snug/study/inputs.hpp"
#include "snug/workspace/run_progress.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  fuzz::expect_answer(data, size, [](char kind, const std::string& text) {
    switch (kind) {
      case 'b':
        (void)planning::parse_request(text, "x.json");
        break;
      case 'j':
        (void)runs::read_result(text);
        break;
      case 'i':
        (void)study::parse_inputs(text);
        break;
      case 'f':
        (void)simulated_plant::parse_faults(text);
        break;
      case 'o': {
        const auto order = session::parse_operator_order(text, "x.txt", 1);
        if (order)
          SNUG_CHECK(session::parse_operator_order(session::format_operator_order(*order), "x.txt", 1) == order,
                     "an order is read as written");
        break;
      }
      case 's':
        (void)runs::parse_shake_profile(text, "x.csv");
        break;
      case 'k':
        (void)model::parse_key_value(text, "command line");
        break;
      case 'u':
        (void)robot::parse_link_tree(text);
        (void)robot::parse_visuals(text, {});
        break;
      case 'l':
        (void)robot::parse_joint_limits(text, "x.yaml");
        break;
      case 'p':
        (void)workspace::read_progress(text, "x.jsonl");
        break;
      default:
        (void)session::find_resume_point(session::parse_log(text, "x.jsonl"), "x.jsonl");
    }
  });
  return 0;
}
