"""Tables of how accurate contact, cup and arm are: scenes with a known answer, reference data, and what tests record."""
import json

from figure_makers.common import SCENARIO, CannotMake, bench, others, power, recorded, run, table, timed, with_origin


def scenes(words):
    """How accurate the physics is on scenes with a known answer; speeds depend on the machine and are not among them."""
    value = bench(words, "s")
    slides = max(value[f"s3.{heading}.error_percent"] for heading in (0, 22, 45))
    return {"bench": with_origin(table(
        ("scene", "snug", "target"),
        ("14 stacked boxes, 10 s, all awake: deepest overlap; drift", f"{value['s1.awake.penetration_mm']:.4f} mm; {value['s1.awake.drift_mm']:.4f} mm", "0.01 mm; 0.001 mm"),
        ("12 boxes dropped at random, five seeds: deepest overlap", f"{value['s2.worst_penetration_mm']:.2f} mm", "1 mm"),
        ("distance of a sliding box, at 0, 22.5 and 45 degrees", f"{slides:.4f} % off", "0.05 %"),
        ("height of a rebound", f"{value['s4.error_percent']:.3f} % off", "0.5 %"),
        ("tilted insertion into a gap that is 5 mm too narrow", f"{'in' if value['s6b.completes'] == 1 else 'not in'}, with {value['s6b.peak_force_N']:.0f} N", "70 N")),
        "`snug bench`")}


def turning(words):
    """What rolls on, or rides on, something that turns."""
    disc, ball, box = (f"SecondOrder.{name}" for name in ("EulersDiscKeepsItsEnergyAndItsInclination", "AnEccentricBallSpinsOnNearItsUprightAxis",
                                                          "ABoxOnATurntableStaysInItsPlace"))
    found = recorded(words, "physics", disc, ball, box)
    return {"turning": with_origin(table(
        ("at 1 ms", "measured", "by"),
        ("Euler's disc at 30 degrees: energy kept after 1 s (exact: 1)", f"{found[disc]['energy_kept']:.4f}", f"`{disc}`"),
        ("eccentric ball at 200 rad/s: tilt of its axis after 1.5 s (exact: 2.4 degrees)", f"{found[ball]['tilt_deg']:.1f} degrees", f"`{ball}`"),
        ("box at 1 m on a table of 1 rad/s: drift in 10 s (exact: 0)", f"{found[box]['drift_um']:.0f} um", f"`{box}`")),
        "tests of `physics`")}


def cup(words):
    """The law of the cup beside reference data."""
    law, equilibria, rest, energy, paths = ("CupLaw.AgreesWithTheReferenceVectors", "Settle.AgreesWithTheReferenceEquilibria", "CupDecay.ComesToRestWhereStaticsSays",
                                            "CupDecay.NeverGainsEnergyAtAnyStepUpTo20Milliseconds", "CupDecay.FollowsTheReferenceTrajectories")
    found = recorded(words, "cup", law, equilibria, rest, energy, paths)

    def places(test):
        return f"{power(found[test]['position_m'])} m, {power(found[test]['turn_rad'])} rad"
    return {"cup": with_origin(table(
        ("what", "largest error", "allowed", "by"),
        ("100 reference wrenches: energy, wrench, relative", f"{power(found[law]['energy'])}, {power(found[law]['wrench'])}", "1e-10, 1e-9", f"`{law}`"),
        ("15 reference equilibria", places(equilibria), "1e-7 m, 1e-6 rad", f"`{equilibria}`"),
        ("the same, by simulation at 4 ms", places(rest), "1e-7 m, 1e-6 rad", f"`{rest}`"),
        ("energy of 5 decays, steps of 1, 4, 8, 12, 20 ms: gain in a step", f"{power(found[energy]['gain_J'])} J", "1e-12 J", f"`{energy}`"),
        ("5 reference trajectories of 1.5 s, steps of 0.1 ms", places(paths), "1e-6 m, 1e-5 rad, second order", f"`{paths}`")),
        "tests of `cup`")}


def calibration(words):
    """Frames of arms from the deviations that controllers store."""
    rows = []
    for what, name in (("a real UR10", "ur10_real_calibration.conf"), ("one with deviations of hundreds of metres", "ur10_large_delta_calibration.conf")):
        found = json.loads(run([words.snug, "calibrate", "kinematics", "--deltas", others(words, f"ur10/{name}"), "--json"]))
        rows.append((what, f"{found['max_end_effector_error_m']:.1e}", f"{found['max_end_effector_error_rad']:.1e}", f"{found['max_frame_shift_m']:.5f}",
                     f"{found['max_deviation_in_base_m']:.4f}"))
    return {"calibration": with_origin(table(("file", "end, m", "end, rad", "joint origins in their parents, m", "joint frames in the base, m"), *rows),
                                       "`snug calibrate kinematics --deltas`, largest of 1000 configurations")}


def arm(words):
    """What an arm's kinematics cost."""
    value = bench(words, "arm")
    return {"arm": timed(table(
        ("UR10, one call", "time", "target"),
        ("pose of the tool", f"{value['arm.forward_us']:.2f} us", "5 us"),
        ("Jacobian", f"{value['arm.jacobian_us']:.2f} us", ""),
        ("inverse dynamics", f"{value['arm.inverse_dynamics_us']:.2f} us", ""),
        ("all branches of the inverse", f"{value['arm.inverse_us']:.0f} us", "20 us"),
        ("the same, an arm with deviations", f"{value['arm.calibrated_inverse_us']:.0f} us", "")), "`snug bench arm`, processor time")}


def durations(words):
    """How long the demonstrator's own programs take, computed without physics."""
    rows, jumps = [], []
    for sequence, reported in (("1", 248), ("2", 232), ("3", 292)):
        suite = "Motion/DemonstratorSequence"
        lagged, plain, reference = (f"{suite}.{name}/{sequence}" for name in (
            "TakesAsLongAsReported", "IsAboutTwoSecondsShorterWithoutCorrectionsAndSampledCoast", "SpendsLessThanHalfOfItsTimeOnTheReferenceMotions"))
        found = recorded(words, "motion", lagged, plain, reference)
        rows.append((sequence, str(reported), *(f"{seconds:.1f}" for seconds in (found[lagged]["duration_s"], found[plain]["duration_s"], found[reference]["trapezoids_s"]))))
        jumps.append(found[reference]["worst_jump_mm"])
    return {"durations": with_origin(table(("sequence", "report", "lagged", "without corrections and sampled coast", "trapezoids alone"), *rows)
                                     + f"\n\nThe largest jump of the reference is {max(jumps):.1f} mm.", "tests of `motion` (`DemonstratorSequence`), s")}


def arm_durations(words):
    """How long the demonstrator's own programs take with the arm and without it."""
    seconds = {}
    for sequence in ("1", "2", "3"):
        program = words.programs / f"poses{sequence}real.csv"
        if not program.is_file():
            raise CannotMake(f"there is no file '{program}' (--programs)")
        for robot in ((), ("--robot", "ur10")):
            command = [words.snug, "simulate", SCENARIO, "--program", program, "--sequence", sequence, "--corrections", "none", *robot, "--json"]
            seconds[sequence, bool(robot)] = json.loads(run(command))["duration_s"]
    with_arm = " and ".join(f"{seconds[sequence, True]:.1f} s instead of {seconds[sequence, False]:.1f} s" for sequence in ("2", "3"))
    return {"arm-durations": f"takes {seconds['1', True]:.1f} s instead of {seconds['1', False]:.1f} s (without corrections). Sequences 2 and 3 take {with_arm}."}


MAKERS = {"bench": scenes, "turning": turning, "cup": cup, "calibration": calibration, "arm": arm, "durations": durations,
          "arm-durations": arm_durations}
