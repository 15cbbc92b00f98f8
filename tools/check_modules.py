#!/usr/bin/env python3
"""check_modules.py [ROOT]: holds every #include to the module dependencies that the CMakeLists.txt files declare.

A file under src/snug/<module> may include its own module, the modules its snug_module(... DEPENDS ...) names and what those may use;
headers under internal/ only from the same module. Files under apps, tests, bench and examples may include any module's public
headers and their own, from the folder they are in up to the top one. Module tests (src/snug/<module>/test) follow the rule of
their module. Prints `file:line: what is wrong` and exits with 1.
"""
import re
import sys
from pathlib import Path

KEYWORDS = {"HEADERS", "SOURCES", "DEPENDS", "LINK", "TESTS", "SLOW_TESTS"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
OUTSIDE = ("apps", "tests", "bench", "examples")


def declared_modules(source):
    """{module: ([modules it depends on], file, line)} from the snug_module calls."""
    modules = {}
    for path in sorted(source.glob("*/CMakeLists.txt")):
        text = re.sub(r"#[^\n]*", "", path.read_text())
        for call in re.finditer(r"\bsnug_module\s*\(([^)]*)\)", text):
            words = call.group(1).split()
            depends, keyword = [], None
            for word in words[1:]:
                if word in KEYWORDS:
                    keyword = word
                elif keyword == "DEPENDS":
                    depends.append(word)
            modules[words[0]] = (depends, path, text[: call.start()].count("\n") + 1)
    return modules


def check_declarations(modules, problems):
    """Reports unknown and circular dependencies; returns {module: every module it may use}."""
    reachable = {}

    def visit(module, trail):
        if module in trail:
            circle = trail[trail.index(module):] + [module]
            _, path, line = modules[module]
            problems.append(f"{path}:{line}: circular modules: {' -> '.join(circle)}")
            return set()
        if module in reachable:
            return reachable[module]
        depends, path, line = modules[module]
        found = {module}
        for other in depends:
            if other not in modules:
                problems.append(f"{path}:{line}: module '{module}' depends on '{other}', which no folder declares")
                continue
            found |= visit(other, trail + [module])
        reachable[module] = found
        return found

    for module in sorted(modules):
        visit(module, [])
    return reachable


def check_include(path, number, quote, target, module, modules, allowed, source, problems):
    def report(text):
        problems.append(f"{path}:{number}: {text}")

    parts = Path(target).parts
    if parts[:1] != ("snug",):
        beside = path.parent / target
        bases = [path.parent] if module else [path.parent, *path.parents[: path.parents.index(source.parent.parent)]]
        if quote == '"' and not any((base / target).exists() for base in bases):
            report(f'"{target}": includes start at src/ ("snug/module/file.hpp") or name a file beside this one')
        elif quote == '"' and module and (source / module) not in beside.resolve().parents:
            report(f'"{target}": leaves module \'{module}\' by a relative path')
        return
    if quote == "<":
        report(f"<{target}>: headers of modules are included in quotes")
    if len(parts) < 3 or parts[1] not in modules:
        report(f'"{target}": no module \'{parts[1] if len(parts) > 1 else ""}\' is declared')
        return
    other = parts[1]
    if not (source.parent / target).exists():
        report(f'"{target}": no such file')
    if other != module and "internal" in parts:
        report(f'"{target}": internal headers are for module \'{other}\' only')
    if module and other not in allowed[module]:
        may = ", ".join(sorted(allowed[module] - {module})) or "no other module"
        report(f'"{target}": module \'{module}\' does not declare \'{other}\' (it may use {may})')


def source_files(root):
    for folder in ("src/snug",) + OUTSIDE:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".h", ".inl"):
                yield path


def check(root):
    root = root.resolve()
    source = root / "src" / "snug"
    problems = []
    modules = declared_modules(source)
    if not modules:
        return [f"{source}: no snug_module() found"], 0
    allowed = check_declarations(modules, problems)
    count = 0
    for path in source_files(root):
        module = path.relative_to(source).parts[0] if source in path.parents else None
        if module is not None and module not in modules:
            problems.append(f"{path}:1: folder '{module}' declares no module")
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                count += 1
                check_include(path, number, match.group(1), match.group(2), module, modules, allowed, source, problems)
    return problems, count


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
