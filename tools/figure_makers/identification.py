"""Tables of what identification, validation and the camera find on data with a known truth, and on recordings of others."""
import json
import re
import sys
import tempfile
from pathlib import Path

from figure_makers.common import ROOT, Values, bench, bench_rows, others, power, run, table, timed, with_origin


def identification(words):
    """Stiffness, damping and load of a cup from reference data and from virtual experiments."""
    value = Values({name.removeprefix("identification."): number for part in ("compliance", "errors_in_variables", "wrench", "damping", "payload")
                    for name, number in bench(words, f"identification.{part}").items()})
    return {"identification": with_origin(table(
        ("what", "measured", "target"),
        ("compliance fit: worst stiffness, coupling", f"{value['compliance.worst_percent']:.1f} %, {value['compliance.coupling_percent']:.1f} %", "3 %, 10 %"),
        ("errors in variables: the same", f"{value['errors_in_variables.worst_percent']:.1f} %, {value['errors_in_variables.coupling_percent']:.1f} %", "2 %, 6 %"),
        ("chi2 per degree of freedom: compliance, errors in variables", f"{value['compliance.chi2_per_dof']:.3f}, {value['errors_in_variables.chi2_per_dof']:.3f}",
         "0.9 to 1.1"),
        ("wrench fit without noise, relative", power(value["wrench.noise_free_relative"]), "1e-6"),
        ("95 % intervals hold the truth, 200 sets: compliance, errors in variables",
         f"{value['compliance.coverage_percent']:.1f} %, {value['errors_in_variables.coverage_percent']:.1f} %", "90 to 98 %"),
        ("decays: d_lat, d_bend, d_tors (worst of five)", ", ".join(f"{value[f'damping.{name}_percent']:.1f} %" for name in ("d_lat", "d_bend", "d_tors")), "12 %, 3 %, 12 %"),
        ("standard error of d_ax: three swings, three plucks",
         f"{value['damping.d_ax_error_of_3_swings_percent']:.0f} %, {value['damping.d_ax_error_of_3_plucks_percent']:.1f} %", "say so, 5 %"),
        ("60 lifts: worst mass, worst centre of mass", f"{value['payload.worst_mass_percent']:.1f} %, {value['payload.worst_com_mm']:.1f} mm", "2 %, 5 mm"),
        ("95 % intervals of these lifts hold the truth", f"{value['payload.coverage_percent']:.0f} %", "90 to 100 %")),
        "`snug bench identification`")}


EXPERIMENTS = {"held": "20 s of sequence 1, one box, cup that holds; three seeds", "packed": "120 s of sequence 1, five boxes, cup that holds; three seeds",
               "released": "80 s of sequence 1, four boxes, one set down on the bench, cup with phases; three seeds",
               "whole": "sequence 1, 12 boxes, cup with phases; one seed"}
# Name, factor from SI to what is shown, decimals.
NUMBERS = {"cup_lateral": ("`cup.stiffness.lateral`, N/m", 1, 0), "cup_axial": ("`cup.stiffness.axial`, N/m", 1, 0), "cup_bend": ("`cup.stiffness.bend`, Nm/rad", 1, 3),
           "cup_torsion": ("`cup.stiffness.torsion`, Nm/rad", 1, 3), "com_x": ("centre of mass, mm", 1e3, 2), "friction": ("friction of box and container", 1, 4),
           "bench_friction": ("friction of box and workbench", 1, 4), "restitution": ("restitution of box and workbench", 1, 4),
           "clearance": ("`parcel_clearance`, mm", 1e3, 3), "release_push": ("`cup.release_push`", 1, 4), "vent_time": ("`cup.vacuum.vent_time`, ms", 1e3, 2)}


def planted(words):
    """Numbers that are put into virtual experiments of a program, and what is found of them."""
    figures = bench_rows(words, "identification.planted")
    value = {name: row["value"] for name, row in figures.items()}
    rows = []
    for experiment, what in EXPERIMENTS.items():
        prefix = f"identification.planted.{experiment}."
        rows.append((f"*{what}; {value[prefix + 'seconds']:.0f} s of computing*", "", "", "", "", ""))
        for name, (label, factor, decimals) in NUMBERS.items():
            if f"{prefix}{name}_error" not in value:
                continue
            start, truth, error = (factor * value[f"{prefix}{name}_{part}"] for part in ("start", "truth", "error"))
            aim = factor * float(figures[f"{prefix}{name}_error"]["target"].removeprefix("<= "))
            rows.append((label, f"{start:g}", f"{truth:g}", f"{error:.{decimals}f}", f"{aim:.3g}", f"{value[f'{prefix}{name}_error_over_its_standard_error']:.1f}"))
    return {"planted": timed(table(("planted", "starts at", "truth", "largest error", "aim", "over its standard error, at most"), *rows),
                             "`snug bench identification.planted`, seeds 31 to 33")}


def cases(words):
    """Tasks whose truth is known and whose parts are collinear, out of reach, or wrong."""
    text = run([sys.executable, ROOT / "tools" / "identify_cases.py", "--count", "50", "--seed", "701"])
    found = [(int(count), float(worst)) for count, worst in re.findall(r"(\d+) identified, at most ([0-9.]+) errors off", text)]
    return {"cases": f"{sum(count for count, _ in found)} numbers are called identified; none is more than {max(worst for _, worst in found):.1f} standard errors off."}


def packed(words):
    """Numbers that are planted in the plant of a packed program."""
    text = run([sys.executable, ROOT / "tools" / "identify_packed.py", "--seed", "71", "--count", "20", "--threads", "2"])
    spread, count, worst = re.search(r"root mean square ([0-9.]+) of (\d+), at most ([0-9.]+)", text).groups()
    verdict = "all found" if "all found" in text else "not all found"
    return {"packed": f"Seeds 71 to 90: {count} numbers, {verdict}; over their standard errors {spread} (root mean square), at most {worst}."}


def releases(words):
    """How a cup lets go, fitted to recorded releases."""
    recordings = others(words, "releases/releases.csv")
    fit = json.loads(run([words.snug, "identify", "release", recordings, "--json"]))
    older = json.loads(run([words.snug, "identify", "release", recordings, "--evaluate", "--json"]))
    masses = sorted(fit["held_back"]["masses"], key=lambda mass: mass["mass_kg"])
    first, *between, last = (mass["rms_mm"] for mass in masses)
    scatter = [mass["scatter_mm"] for mass in masses]
    return {"releases": with_origin(table(
        ("", "height of the box, rms", "time of opening, rms"),
        ("fitted to all", f"{fit['rms_mm']:.2f} mm", f"{fit['opening_ms_error']:.1f} ms"),
        (f"all {len(masses)} masses left out in turn (aim 0.8 mm{'' if fit['held_back']['rms_mm'] <= 0.8 else ', **not reached**'})", f"{fit['held_back']['rms_mm']:.2f} mm",
         f"{fit['held_back']['opening_ms_error']:.1f} ms"),
        (f"of these: the lightest ({masses[0]['mass_kg']} kg, the next {masses[1]['mass_kg']})", f"{first:.2f} mm", ""),
        ("those between", f"{min(between):.2f} to {max(between):.2f} mm", ""),
        (f"the heaviest ({masses[-1]['mass_kg']} kg, the next {masses[-2]['mass_kg']})", f"{last:.2f} mm", ""),
        ("the phases of the demonstrator's scenario, not fitted", f"{older['rms_mm']:.1f} mm", ""),
        ("repetitions of one mass about their mean", f"{min(scatter):.2f} to {max(scatter):.2f} mm", "")),
        f"`snug identify release`, {sum(mass['recordings'] for mass in masses)} recordings")}


def split_tosses(recordings, folder):
    """Each fifth toss, which was held back, and the others: (what, file)."""
    head, *lines = recordings.read_text(encoding="utf-8").splitlines()
    order = {toss: place for place, toss in enumerate(dict.fromkeys(line.split(",", 1)[0] for line in lines))}
    parts = []
    for what, is_held_back in (("fitted", False), ("held back", True)):
        path = folder / f"{what.replace(' ', '-')}.csv"
        path.write_text("\n".join([head, *(line for line in lines if (order[line.split(",", 1)[0]] % 5 == 4) == is_held_back)]) + "\n", encoding="utf-8")
        parts.append((what, path))
    return parts


def tosses(words):
    """Tosses of a cube with the numbers of scenarios/tosses/task.yaml."""
    recordings = others(words, "tosses/train.csv")
    task = ["scenarios/tosses/task.yaml", "--json"]

    def row(what, *more):
        error = json.loads(run([words.snug, "identify", "scene", *task, *more]))
        return (what, f"{error['position_mm']:.2f} mm", f"{error['rotation_deg']:.2f} degrees", f"{error['right_orientation_percent']:.1f} %", str(error["recordings"]))
    with tempfile.TemporaryDirectory() as name:
        parts = split_tosses(recordings, Path(name))
        rows = [row(what, "--recordings", file, "--evaluate") for what, file in (("all", recordings), *parts)]
    return {"tosses": with_origin(table(
        ("", "position", "rotation", "right orientation", "tosses"), *rows, row("floor that noise of the start sets", "--recordings", recordings, "--floor"),
        ("target", "11.5 mm", "12.5 degrees", "86 %", "")), "`snug identify scene scenarios/tosses/task.yaml`, `--evaluate` and `--floor`")}


def validation(words):
    """What the two forms of validation give where the physics of both sides is the same."""
    value = bench(words, "validation")
    return {"validation": with_origin(table(
        ("means over boxes of sequence 1, three virtual repetitions", "true parameters", "every parameter off by one standard error", "means of the report's tables"),
        ("at rest, `clean`", f"{value['validation.true.rest_mm']:.2f} mm", f"{value['validation.off_by_one.rest_mm']:.1f} mm, {value['validation.off_by_one.rest_deg']:.1f} degrees",
         "8.5 mm, 1.8 degrees"),
        ("over the motion, `clean`", f"{value['validation.true.rms_mm']:.2f} mm", f"{value['validation.off_by_one.rms_mm']:.1f} mm, {value['validation.off_by_one.rms_deg']:.1f} degrees",
         "23.5 mm, 3.1 degrees"),
        ("over the motion, `report`", f"{value['validation.true.rms_mm.report']:.1f} mm, {value['validation.true.rms_deg.report']:.1f} degrees",
         f"{value['validation.off_by_one.rms_mm.report']:.1f} mm, {value['validation.off_by_one.rms_deg.report']:.1f} degrees", "23.5 mm, 3.1 degrees"),
        ("wrench, `report`", "", f"{value['validation.off_by_one.rms_N.report']:.1f} N, {value['validation.off_by_one.rms_Nm.report']:.1f} Nm", "20.2 N, 1.5 Nm")),
        "`snug bench validation`")}


def camera(words):
    """Boxes in frames of simulated cameras."""
    value = Values({name.removeprefix("camera."): number for name, number in bench(words, "camera").items()})

    def pair(what, form):
        return tuple(form(lambda name, of=of: value[f"{of}.{name}"]) for of in what)

    def both(label, target, form):
        return (label, target, *pair(("rest", "active_stereo"), form))
    wrong = sum(int(value[f"{kind}.more_than_20mm_off"]) for kind in ("moved", "tipped", "taken"))
    return {"camera": timed(table(
        ("", "target", "structured_light", "active_stereo"),
        both("frame of 972 x 600 pixels (848 x 480), one core", "50 ms", lambda of: f"{of('frame_ms'):.0f} ms"),
        both("estimate, one core", "300 ms", lambda of: f"{of('estimate_ms'):.0f} ms"),
        both("visible boxes", "", lambda of: f"{of('visible_boxes'):.0f}"),
        both("their position, median / 95th percentile", "1.0 / 2.5 mm", lambda of: f"{of('position_median_mm'):.2f} / {of('position_p95_mm'):.2f} mm"),
        both("their angle, median / 95th percentile", "0.3 / 0.7 deg", lambda of: f"{of('angle_median_deg'):.3f} / {of('angle_p95_deg'):.3f} deg"),
        ("one box alone in the tote, root mean square", "", f"{value['alone.position_rms_mm']:.2f} mm, {value['alone.angle_rms_deg']:.3f} deg of {value['alone.visible_boxes']:.0f}",
         ""),
        both("hidden boxes reported as seen", "0.1 %", lambda of: f"{of('hidden_seen_percent'):.1f} % of {of('hidden_boxes'):.0f}"),
        both("chi-square per degree of freedom", "0.9 .. 1.1", lambda of: f"{of('chi_square_per_degree'):.3g}"),
        ("moved / tipped / taken boxes found", "99 %", " / ".join(f"{value[f'{kind}.found_percent']:.0f}" for kind in ("moved", "tipped", "taken")) + " %", ""),
        ("boxes of those 300 frames that are reported seen and more than 20 mm off", "", str(wrong), "")),
        "`snug bench camera`, 200 scenes at rest, 3 x 100 disturbed")}


MAKERS = {"identification": identification, "planted": planted, "cases": cases, "packed": packed, "releases": releases, "tosses": tosses, "validation": validation,
          "camera": camera}
