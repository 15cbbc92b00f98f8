#!/usr/bin/env python3
"""check_modules.py [ROOT]: holds every #include to the dependencies that the CMakeLists.txt files declare.

What declares its dependencies is a unit:
  src/snug/<module>     snug_module(<module> ... DEPENDS modules... TEST_DEPENDS modules that only its tests may include)
  bench/<folder>        snug_app_library(<library> ... DEPENDS modules...)
  apps/snug/<folder>    snug_verb(<folder> ... USES folders beside it... DEPENDS modules and libraries...)
  python                target_link_libraries(... snug::<module>...) in python/CMakeLists.txt
A file may include its own unit, those that it declares and what those may use; headers under internal/ only from the same unit. Files
beside the folders of apps/snug may include all of these folders. Files under tests, bench and examples may include the public headers of
any unit and their own, from the folder they are in up to the top one. Prints `file:line: what is wrong` and exits with 1.
"""
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

CALL = re.compile(r"\b(snug_module|snug_app_library|snug_verb|target_link_libraries)\s*\(([^)]*)\)")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
OUTSIDE = ("tests", "bench", "examples")
PROGRAM = "apps/snug"


@dataclass
class Unit:
    """`prefix`: how includes of its headers start."""
    name: str
    folder: Path
    prefix: str
    path: Path
    line: int
    depends: list = field(default_factory=list)
    test_depends: list = field(default_factory=list)


def words_after(words, keyword):
    """The words that follow `keyword` up to the next one in capitals."""
    found, current = [], None
    for word in words:
        if re.fullmatch(r"[A-Z_]+", word):
            current = word
        elif current == keyword:
            found.append(word)
    return found


def calls_of(path):
    """(function, words, line) of each call that declares something."""
    text = re.sub(r"#[^\n]*", "", path.read_text())
    for call in CALL.finditer(text):
        yield call.group(1), call.group(2).split(), text[: call.start()].count("\n") + 1


def declared_units(root):
    """Units by name; a folder of the program is named by its path, a module or library by what DEPENDS calls it."""
    units = {}
    for path in [*sorted(root.glob("src/snug/*/CMakeLists.txt")), *sorted(root.glob("apps/**/CMakeLists.txt")),
                 *sorted(root.glob("bench/**/CMakeLists.txt")), *root.glob("python/CMakeLists.txt")]:
        folder = path.parent
        place = str(folder.relative_to(root))
        for function, words, line in calls_of(path):
            modules = words_after(words[1:], "DEPENDS")
            if function == "snug_module":
                units[words[0]] = Unit(words[0], folder, f"snug/{words[0]}", path, line, modules,
                                       words_after(words[1:], "TEST_DEPENDS"))
            elif function == "snug_app_library":
                units[words[0]] = Unit(words[0], folder, place, path, line, modules)
            elif function == "snug_verb":
                uses = [f"{PROGRAM}/{other}" for other in words_after(words[1:], "USES")]
                units[place] = Unit(place, folder, place, path, line, modules + uses)
            elif place == "python":
                unit = units.setdefault("python", Unit("python", folder, "python", path, line))
                unit.depends += [word[len("snug::"):] for word in words if word.startswith("snug::")]
    folders = [name for name in units if name.startswith(PROGRAM + "/")]
    main = root / PROGRAM / "CMakeLists.txt"
    if main.exists():
        units[PROGRAM] = Unit(PROGRAM, main.parent, PROGRAM, main, 1, folders)
    return units


def check_declarations(units, problems):
    """Reports unknown and circular dependencies; returns {name: every unit it may use}."""
    reachable = {}

    def visit(name, trail):
        unit = units[name]
        if name in trail:
            circle = trail[trail.index(name):] + [name]
            problems.append(f"{unit.path}:{unit.line}: circular modules: {' -> '.join(circle)}")
            return set()
        if name in reachable:
            return reachable[name]
        found = {name}
        for other in unit.test_depends:
            if other not in units:
                problems.append(f"{unit.path}:{unit.line}: the tests of '{name}' depend on '{other}', which no folder declares")
        for other in unit.depends:
            if other not in units:
                problems.append(f"{unit.path}:{unit.line}: module '{name}' depends on '{other}', which no folder declares")
                continue
            found |= visit(other, trail + [name])
        reachable[name] = found
        return found

    for name in sorted(units):
        visit(name, [])
    return reachable


class Checker:
    def __init__(self, root):
        self.root = root
        self.problems = []
        self.count = 0
        self.units = declared_units(root)
        self.allowed = check_declarations(self.units, self.problems)
        self.by_prefix = {unit.prefix: unit for unit in self.units.values()}

    def unit_of_file(self, path):
        """The unit with the innermost folder around `path`, or None."""
        around = [unit for unit in self.units.values() if unit.folder in path.parents]
        return max(around, key=lambda unit: len(unit.folder.parts), default=None)

    def unit_of_include(self, parts):
        for end in range(len(parts) - 1, 0, -1):
            unit = self.by_prefix.get("/".join(parts[:end]))
            if unit is not None:
                return unit
        return None

    def allowed_of(self, path, unit):
        allowed = self.allowed[unit.name]
        if unit.folder / "test" in path.parents:
            allowed = allowed.union(*(self.allowed.get(name, set()) for name in unit.test_depends))
        return allowed

    def check_file(self, path):
        unit = self.unit_of_file(path)
        if unit is None and path.relative_to(self.root).parts[0] not in OUTSIDE:
            self.problems.append(f"{path}:1: folder '{path.parent.name}' declares no module")
            return
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                self.count += 1
                for text in self.check_include(path, unit, match.group(1), match.group(2)):
                    self.problems.append(f"{path}:{number}: {text}")

    def check_include(self, path, unit, quote, target):
        parts = Path(target).parts
        if parts[0] not in ("snug", "apps", "bench"):
            if quote == '"':
                yield from self.check_beside(path, unit, target)
            return
        if quote == "<":
            yield f"<{target}>: headers of modules are included in quotes"
        other = self.unit_of_include(parts)
        if other is None:
            yield f"\"{target}\": no module '{parts[1] if len(parts) > 2 else ''}' is declared"
            return
        if not (self.root / ("src" if parts[0] == "snug" else ".") / target).exists():
            yield f'"{target}": no such file'
        if other is not unit and "internal" in parts:
            yield f"\"{target}\": internal headers are for module '{other.name}' only"
        if unit and other.name not in self.allowed_of(path, unit):
            may = ", ".join(sorted(self.allowed_of(path, unit) - {unit.name})) or "no other module"
            yield f"\"{target}\": module '{unit.name}' does not declare '{other.name}' (it may use {may})"

    def check_beside(self, path, unit, target):
        """Of an include that names no unit: it stays in its folder, outside of units in the folders up to the top."""
        beside = path.parent / target
        bases = [path.parent] if unit else [path.parent, *path.parents[: path.parents.index(self.root)]]
        if not any((base / target).exists() for base in bases):
            yield f'"{target}": includes start at src/ ("snug/module/file.hpp") or name a file beside this one'
        elif unit and unit.folder not in beside.resolve().parents:
            yield f"\"{target}\": leaves module '{unit.name}' by a relative path"


def source_files(root):
    for folder in ("src/snug", "apps", "python") + OUTSIDE:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".h", ".inl"):
                yield path


def check(root):
    checker = Checker(root.resolve())
    if not any(unit.prefix.startswith("snug/") for unit in checker.units.values()):
        return [f"{root}: no snug_module() found"], 0
    for path in source_files(checker.root):
        checker.check_file(path)
    return checker.problems, checker.count


def main(arguments):
    root = Path(arguments[1]) if len(arguments) > 1 else Path(__file__).resolve().parent.parent
    problems, count = check(root)
    for problem in problems:
        print(problem)
    if not problems:
        print(f"{count} includes follow the declared modules")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
