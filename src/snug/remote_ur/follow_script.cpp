// follow_script: the program of ours on the robot.
#include "snug/remote_ur/follow_script.hpp"

#include <fmt/format.h>

#include "snug/remote_ur/robot_link.hpp"

namespace snug::remote_ur {
namespace {

// As the maker's client library has them: s, and without unit.
constexpr double kServoLookAhead = 0.03;
constexpr int kServoGain = 2000;
// rad, in a joint: targets that come back farther away than this are not followed.
constexpr double kFarAway = 0.06;
// s, in which the difference to targets that came back falls to a third.
constexpr double kReturnTime = 0.16;
// rad/s^2: of what is left of a joint's speed when the targets have come to rest.
constexpr double kBraking = 20.0;

std::string read_six(int first) {
  std::string text = "[";
  for (int j = 0; j < 6; ++j) text += fmt::format("{}read_input_float_register({})", j > 0 ? ", " : "", first + j);
  return text + "]";
}

}  // namespace

std::string follow_script(const served_ur::UrArm& arm, bool zeroes, std::int32_t number) {
  constexpr int kR = kFirstRegister;
  const ur::Values6 tcp = served_ur::to_values(arm.tool());
  const SpatialInertia& load = arm.tool_load();
  std::string text = "def snug_follow():\n";
  text += fmt::format("  set_tcp(p[{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}])\n", tcp[0], tcp[1], tcp[2], tcp[3],
                      tcp[4], tcp[5]);
  text += fmt::format("  set_payload({:.4f}, [{:.5f}, {:.5f}, {:.5f}])\n", load.mass, load.com.x(), load.com.y(),
                      load.com.z());
  if (zeroes) text += "  sleep(0.1)\n  zero_ftsensor()\n";
  text += fmt::format(
      R"(  global period = get_steptime()
  keep = 1.0 - period / {return_time}
  zero = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
  global target = get_target_joint_positions()
  speed = zero
  offset = zero
  count = read_input_integer_register({count})
  load = read_input_integer_register({load})
  played = count
  silent = 0.0
  late = 0
  rate = 1.0
  is_late = False
  is_lost = False
  has_begun = False
  state = 1
  thread follow():
    while True:
      servoj(target, t=period, lookahead_time={look_ahead}, gain={gain})
    end
  end
  write_output_integer_register({late}, 0)
  write_output_integer_register({state}, {word} + 1)
  follower = run follow()
  while state == 1:
    now = read_input_integer_register({count})
    mode = read_input_integer_register({mode})
    is_new = now != count
    count = now
    if is_new:
      silent = 0.0
      has_begun = True
    else:
      silent = silent + period
    end
    played = played + 1
    if mode == 0 or now - played > 2:
      played = now
    end
    if played - now > 2 and is_new:
      played = now + 2
      is_late = True
    end
    if silent > {limit}:
      state = 3
    elif has_begun == False:
      played = now
    elif mode == 2:
      state = 2
    elif is_lost or (played > now and is_new == False):
      late = late + 1
      is_late = True
      if is_lost or silent > {coast}:
        rate = rate - period / {fade}
      end
      if rate < 0.0:
        rate = 0.0
        state = 3
      end
      target = target + rate * speed
    else:
      newest = {newest}
      before = {before}
      q = newest
      if played == now - 1:
        q = before
      elif played == now - 2:
        q = {oldest}
      elif played > now:
        q = newest + (played - now) * (newest + (-1.0) * before)
      end
      if is_late:
        is_late = False
        write_output_integer_register({late}, late)
        offset = target + speed + (-1.0) * q
        j = 0
        while j < 6:
          if offset[j] > {far} or offset[j] < -{far}:
            is_lost = True
          end
          j = j + 1
        end
      end
      if is_lost:
        target = target + rate * speed
      else:
        rate = 1.0
        offset = keep * offset
        goal = q + offset
        speed = goal + (-1.0) * target
        target = goal
      end
    end
    changed = read_input_integer_register({load})
    if changed != load:
      load = changed
      set_payload(read_input_float_register({mass}), [read_input_float_register({mass}+1), read_input_float_register({mass}+2), read_input_float_register({mass}+3)])
    end
    if state == 1:
      sync()
    end
  end
  kill follower
  stopj({braking})
  write_output_integer_register({late}, late)
  write_output_integer_register({state}, {word} + state)
end
)",
      fmt::arg("return_time", kReturnTime), fmt::arg("count", kR), fmt::arg("mode", kR + 1), fmt::arg("load", kR + 2),
      fmt::arg("state", kR), fmt::arg("word", 10 * number), fmt::arg("late", kR + 1), fmt::arg("limit", kCoast + kFade),
      fmt::arg("coast", kCoast), fmt::arg("fade", kFade), fmt::arg("newest", read_six(kR)),
      fmt::arg("before", read_six(kR + 6)), fmt::arg("oldest", read_six(kR + 12)), fmt::arg("mass", kR + 18),
      fmt::arg("far", kFarAway), fmt::arg("look_ahead", kServoLookAhead), fmt::arg("gain", kServoGain),
      fmt::arg("braking", kBraking));
  return text;
}

}  // namespace snug::remote_ur
