#!/usr/bin/env python3
"""check_headers.py PROJECT [COMPILER]: every public header compiles without others before it.

Nothing of src/snug/*/*.hpp may need what only another file includes. What a header includes anyway, directly or through others, may
stand before it and changes no answer. So headers are compiled in chains, each after one that it includes, with what many include
precompiled before chains of headers that all include it. Those of a chain that fails are compiled one by one."""
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

BASES = ("snug/model/scenario.hpp", "snug/spatial/pose.hpp")  # precompiled; the first of them that a header includes
EIGEN = ("/usr/include/eigen3", "/usr/local/include/eigen3")


def headers_of(source):
    return sorted(str(path.relative_to(source)) for path in (source / "snug").glob("*/*.hpp"))


def closures(source, headers):
    """All of these headers that each includes, directly or through others."""
    direct = {name: set(re.findall(r'^#include "(snug/[^"]+)"', (source / name).read_text(encoding="utf-8"), re.M)) for name in headers}
    found = {}
    for name in headers:
        seen, rest = set(), [name]
        while rest:
            more = direct.get(rest.pop(), set()) - seen
            seen |= more
            rest.extend(more)
        found[name] = seen & set(headers) - {name}
    return found


def chains(includes):
    """All headers, each in one list, in which it includes the one before it: as few lists as there can be (a bipartite matching)."""
    users = {name: [user for user in includes if name in includes[user]] for name in includes}
    before = {}  # the header before each, in its chain

    def give_user(name, seen):
        for user in users[name]:
            if user not in seen:
                seen.add(user)
                if user not in before or give_user(before[user], seen):
                    before[user] = name
                    return True
        return False

    for name in includes:
        give_user(name, set())
    after = {name: user for user, name in before.items()}
    found = [[name] for name in includes if name not in before]
    for chain in found:
        while chain[-1] in after:
            chain.append(after[chain[-1]])
    in_circle = set(includes) - {name for chain in found for name in chain}
    return found + [[name] for name in sorted(in_circle)]


def by_base(includes):
    """Headers with all of these headers that each includes, by the precompiled one that may stand before them ("": none)."""
    groups = {}
    for name in includes:
        base = next((base for base in BASES if base in includes[name]), "")
        groups.setdefault(base, {})[name] = includes[name]
    return groups


def check(source, compiler="c++"):
    """What the compiler says of each header that it refuses, by name."""
    is_gcc = "Free Software Foundation" in subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False).stdout
    memory = ["--param=ggc-min-expand=1000", "--param=ggc-min-heapsize=524288"] if is_gcc else []  # tidied less often: a seventh of the time
    command = [compiler, "-std=c++20", "-Werror", *memory, f"-I{source}", *(f"-isystem{path}" for path in EIGEN if Path(path).is_dir()), "-x"]
    headers = headers_of(source)
    includes = closures(source, headers)

    def compile_one(chain, precompiled):
        """What is said of those that do not compile alone."""
        before = ["-include", precompiled] if precompiled else []
        text = "".join(f'#include "{name}"\n' for name in chain)
        result = subprocess.run([*command, "c++", "-fsyntax-only", *before, "-"], input=text, capture_output=True, text=True, check=False)
        if result.returncode == 0:
            return {}
        if len(chain) == 1:
            return {chain[0]: result.stderr}
        one_by_one = {}
        for name in chain:
            one_by_one.update(compile_one([name], precompiled))
        return one_by_one or {chain[-1]: result.stderr}

    with tempfile.TemporaryDirectory() as folder:
        def precompile(base):
            header = Path(folder, base.replace("/", "_"))
            header.write_text(f'#include "{base}"\n', encoding="utf-8")
            subprocess.run([*command, "c++-header", str(header), "-o", f"{header}.gch"], capture_output=True, check=False)
            return str(header)

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            groups = by_base(includes)
            bases = [base for base in groups if base]
            precompiled = dict(zip(bases, pool.map(precompile, bases)))
            said = list(pool.map(lambda job: compile_one(*job), [(chain, precompiled.get(base, "")) for base, group in groups.items() for chain in chains(group)]))
    return {name: errors for chain in said for name, errors in chain.items()}, len(headers)


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
