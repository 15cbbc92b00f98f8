"""What all makers of tables use: the program, its tests, files of others, and where a table comes from."""
import functools
import json
import os
import platform
import re
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SCENARIO = "scenarios/box-demonstrator.yaml"
SEQUENCES = ("1", "2", "3", "4", "5")


class CannotMake(Exception):
    """Why a figure cannot be made here."""


class Timed(str):
    """A text in which times were measured. It differs from another only where something else differs, or a time by more than a factor of 1.5."""


def run(words, *more):
    done = subprocess.run([*map(str, words), *map(str, more)], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode not in (0, 1) or not done.stdout:  # 1: it ran, and the robot could not do all
        raise CannotMake(f"{' '.join(map(str, words))}: exit code {done.returncode}")
    return done.stdout


class Values(dict):
    """Numbers by their names. One that is not there was not measured: its data are not here."""

    def __missing__(self, name):
        raise CannotMake(f"there is no '{name}': its data are not here")


def bench_rows(words, name):
    """What `snug bench NAME` prints, by the names of the figures."""
    rows = json.loads(run([words.snug, "bench", name, "--json"]))["results"]
    return Values({row["name"]: row for row in rows if not row.get("skipped")})


def bench(words, name):
    return Values({figure: row["value"] for figure, row in bench_rows(words, name).items()})


def recorded(words, module, *tests):
    """What tests of a module record beside their verdict: {test: {name: number}}. They have to pass."""
    program = words.snug.parent / "src" / "snug" / module / f"{module}_test"
    if not program.is_file():
        raise CannotMake(f"{program} is not built (`make test` builds it)")
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        done = subprocess.run([program, f"--gtest_filter={':'.join(tests)}", f"--gtest_output=json:{report}"], cwd=ROOT, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise CannotMake(f"{module}_test: {done.stdout[-500:]}")
        suites = json.loads(report.read_text(encoding="utf-8"))["testsuites"]
    cases = {f"{suite['name']}.{case['name']}": case for suite in suites for case in suite["testsuite"]}
    if missing := [test for test in tests if cases.get(test, {}).get("result") != "COMPLETED"]:
        raise CannotMake(f"{module}_test: {missing[0]} was not run: its data are not here")
    return {test: {name: float(value) for name, value in cases[test].items() if re.fullmatch(r"-?[0-9.]+(e[+-]?[0-9]+)?", str(value))} for test in tests}


def others(words, name):
    """A file of the data that others made, which are beside the project and not in it."""
    path = words.data / name
    if not path.is_file():
        raise CannotMake(f"there is no file '{path}' (--data)")
    return path


@functools.cache  # of the program that the figures were begun with
def commit():
    """The last one that changed the program or what it reads."""
    done = subprocess.run(["git", "log", "-1", "--format=%h", "--", "src", "apps", "scenarios", ":!*.md", ":!*/test/*"], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def machine():
    return f"{platform.machine().replace('_', '-')}, {os.cpu_count()} cores"


def clock():
    """Of a core, as the system states it."""
    try:
        found = re.search(r"^cpu MHz\s*:\s*([0-9.]+)", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        found = None
    return f" of {float(found[1]) / 1000:.1f} GHz" if found else ""


def origin(what, is_timed=False):
    """What a table was made from, on what."""
    return f"*{what}; commit {commit()}, {machine()}{clock() if is_timed else ''} (`make figures`).*"


def table(head, *rows):
    """`head` and `rows`: cells."""
    return "\n".join(["| " + " | ".join(head) + " |", "|---" * len(head) + "|", *("| " + " | ".join(cells) + " |" for cells in rows)])


def with_origin(text, what):
    return text + "\n\n" + origin(what)


def timed(text, what):
    return Timed(text + "\n\n" + origin(what, True))


def power(value):
    """2.3e-16 as 2e-16."""
    digits, exponent = f"{value:.0e}".split("e")
    return f"{digits}e{int(exponent)}" if value else "0"
