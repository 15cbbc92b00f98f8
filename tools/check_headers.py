#!/usr/bin/env python3
"""check_headers.py PROJECT [COMPILER]: every public header compiles without others before it.

Nothing of src/snug/*/*.hpp may need what only another file includes. Most headers begin with spatial/pose.hpp, directly or through
others: for those it is precompiled, which is half of the work and changes no answer, since they include all of it anyway."""
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

BASE = "snug/spatial/pose.hpp"
EIGEN = ("/usr/include/eigen3", "/usr/local/include/eigen3")


def headers_of(source):
    return sorted(str(path.relative_to(source)) for path in (source / "snug").glob("*/*.hpp"))


def closures(source, headers):
    """All of our own headers that each includes, directly or through others."""
    direct = {name: set(re.findall(r'^#include "(snug/[^"]+)"', (source / name).read_text(encoding="utf-8"), re.M)) for name in headers}
    found = {}
    for name in headers:
        seen, rest = set(), [name]
        while rest:
            more = direct.get(rest.pop(), set()) - seen
            seen |= more
            rest.extend(more)
        found[name] = seen
    return found


def check(source, compiler="c++"):
    """What the compiler says of each header that it refuses, by name."""
    is_gcc = "Free Software Foundation" in subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False).stdout
    memory = ["--param=ggc-min-expand=1000", "--param=ggc-min-heapsize=524288"] if is_gcc else []  # tidied less often: a seventh of the time
    command = [compiler, "-std=c++20", "-Werror", *memory, f"-I{source}", *(f"-isystem{path}" for path in EIGEN if Path(path).is_dir()), "-x"]
    headers = headers_of(source)
    includes = closures(source, headers)

    def compile_one(name, folder):
        before = ["-include", f"{folder}/base.hpp"] if BASE in includes[name] else []
        text = f'#include "{name}"\n'
        result = subprocess.run([*command, "c++", "-fsyntax-only", *before, "-"], input=text, capture_output=True, text=True, check=False)
        return None if result.returncode == 0 else result.stderr

    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder, "base.hpp")
        base.write_text(f'#include "{BASE}"\n', encoding="utf-8")
        if BASE in headers:
            subprocess.run([*command, "c++-header", str(base), "-o", f"{base}.gch"], capture_output=True, check=False)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            said = list(pool.map(lambda name: compile_one(name, folder), headers))
    return {name: errors for name, errors in zip(headers, said) if errors is not None}, len(headers)


def main(words):
    if not 2 <= len(words) <= 3:
        sys.exit(__doc__.splitlines()[0])
    refused, count = check(Path(words[1]) / "src", *words[2:])
    if count == 0:
        sys.exit(f"check_headers.py: no headers under {words[1]}/src/snug")
    for name, errors in refused.items():
        print(f"{name} does not compile alone:\n{errors}")
    print(f"{count - len(refused)} of {count} headers compile alone")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
