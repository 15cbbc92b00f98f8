#!/usr/bin/env python3
"""check_headers.py PROJECT [COMPILER]: public headers that no source file includes first compile without others before them.

Nothing of src/snug/*/*.hpp may need what only another file includes. Those that stand first in a source file of their module are
compiled so by `make clang`, which precompiles no headers."""
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

EIGEN = ("/usr/include/eigen3", "/usr/local/include/eigen3")


def headers_to_check(source):
    """Names relative to `source`, as they are included, of the headers that are first in no source file beside them."""
    first = set()
    for path in (source / "snug").glob("*/*.cpp"):
        found = re.search(r'^#include ["<]([^">]+)', path.read_text(encoding="utf-8"), re.M)
        if found:
            first.add(found.group(1))
    headers = {str(path.relative_to(source)) for path in (source / "snug").glob("*/*.hpp")}
    return sorted(headers - first)


def check(source, headers, compiler="c++"):
    """What the compiler says of each header that it refuses, by name."""
    command = [compiler, "-std=c++20", "-Werror", f"-I{source}", *(f"-isystem{path}" for path in EIGEN if Path(path).is_dir()),
               "-x", "c++", "-fsyntax-only", "-"]

    def compile_one(name):
        return subprocess.run(command, input=f'#include "{name}"\n', capture_output=True, text=True, check=False)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(compile_one, headers))
    return {name: result.stderr for name, result in zip(headers, results) if result.returncode != 0}


def main(words):
    if not 2 <= len(words) <= 3:
        sys.exit(__doc__.splitlines()[0])
    source = Path(words[1]) / "src"
    headers = headers_to_check(source)
    if not headers:
        sys.exit(f"check_headers.py: no headers under {words[1]}/src/snug that no source file includes first")
    refused = check(source, headers, *words[2:])
    for name, errors in refused.items():
        print(f"{name} does not compile alone:\n{errors}")
    print(f"{len(headers) - len(refused)} of {len(headers)} headers compile alone")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
