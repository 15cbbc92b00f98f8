#!/usr/bin/env python3
"""check_rooms.py [ROOT]: holds every #include to the room dependencies that the CMakeLists.txt files declare.

A file under src/snug/<room> may include its own room, the rooms its snug_room(... DEPENDS ...) names and what those may use;
headers under internal/ only from the same room. Files under apps, tests, bench and examples may include any room's public
headers and their own, from the folder they are in up to the top one. Room tests (src/snug/<room>/test) follow the rule of
their room. Prints `file:line: what is wrong` and exits with 1.
"""
import re
import sys
from pathlib import Path

KEYWORDS = {"HEADERS", "SOURCES", "DEPENDS", "LINK", "TESTS", "SLOW_TESTS"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
OUTSIDE = ("apps", "tests", "bench", "examples")


def declared_rooms(source):
    """{room: ([rooms it depends on], file, line)} from the snug_room calls."""
    rooms = {}
    for path in sorted(source.glob("*/CMakeLists.txt")):
        text = re.sub(r"#[^\n]*", "", path.read_text())
        for call in re.finditer(r"\bsnug_room\s*\(([^)]*)\)", text):
            words = call.group(1).split()
            depends, keyword = [], None
            for word in words[1:]:
                if word in KEYWORDS:
                    keyword = word
                elif keyword == "DEPENDS":
                    depends.append(word)
            rooms[words[0]] = (depends, path, text[: call.start()].count("\n") + 1)
    return rooms


def check_declarations(rooms, problems):
    """Reports unknown and circular dependencies; returns {room: every room it may use}."""
    reachable = {}

    def visit(room, trail):
        if room in trail:
            circle = trail[trail.index(room):] + [room]
            _, path, line = rooms[room]
            problems.append(f"{path}:{line}: circular rooms: {' -> '.join(circle)}")
            return set()
        if room in reachable:
            return reachable[room]
        depends, path, line = rooms[room]
        found = {room}
        for other in depends:
            if other not in rooms:
                problems.append(f"{path}:{line}: room '{room}' depends on '{other}', which no folder declares")
                continue
            found |= visit(other, trail + [room])
        reachable[room] = found
        return found

    for room in sorted(rooms):
        visit(room, [])
    return reachable


def check_include(path, number, quote, target, room, rooms, allowed, source, problems):
    def report(text):
        problems.append(f"{path}:{number}: {text}")

    parts = Path(target).parts
    if parts[:1] != ("snug",):
        beside = path.parent / target
        bases = [path.parent] if room else [path.parent, *path.parents[: path.parents.index(source.parent.parent)]]
        if quote == '"' and not any((base / target).exists() for base in bases):
            report(f'"{target}": includes start at src/ ("snug/room/file.hpp") or name a file beside this one')
        elif quote == '"' and room and (source / room) not in beside.resolve().parents:
            report(f'"{target}": leaves room \'{room}\' by a relative path')
        return
    if quote == "<":
        report(f"<{target}>: headers of rooms are included in quotes")
    if len(parts) < 3 or parts[1] not in rooms:
        report(f'"{target}": no room \'{parts[1] if len(parts) > 1 else ""}\' is declared')
        return
    other = parts[1]
    if not (source.parent / target).exists():
        report(f'"{target}": no such file')
    if other != room and "internal" in parts:
        report(f'"{target}": internal headers are for room \'{other}\' only')
    if room and other not in allowed[room]:
        may = ", ".join(sorted(allowed[room] - {room})) or "no other room"
        report(f'"{target}": room \'{room}\' does not declare \'{other}\' (it may use {may})')


def source_files(root):
    for folder in ("src/snug",) + OUTSIDE:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".h", ".inl"):
                yield path


def check(root):
    root = root.resolve()
    source = root / "src" / "snug"
    problems = []
    rooms = declared_rooms(source)
    if not rooms:
        return [f"{source}: no snug_room() found"], 0
    allowed = check_declarations(rooms, problems)
    count = 0
    for path in source_files(root):
        room = path.relative_to(source).parts[0] if source in path.parents else None
        if room is not None and room not in rooms:
            problems.append(f"{path}:1: folder '{room}' declares no room")
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                count += 1
                check_include(path, number, match.group(1), match.group(2), room, rooms, allowed, source, problems)
    return problems, count


def main(arguments):
    root = Path(arguments[1]) if len(arguments) > 1 else Path(__file__).resolve().parent.parent
    problems, count = check(root)
    for problem in problems:
        print(problem)
    if not problems:
        print(f"{count} includes follow the declared rooms")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
