#!/usr/bin/env python3
"""reproducible.py [--modules LIST]: builds the packages twice, in folders of different names and lengths, some seconds apart and with different
numbers of jobs, and compares them byte by byte. With --modules only those libraries, no program and no packages. Exit code 1 where they differ."""
import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def run(folder, *words, **more):
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        raise SystemExit(f"reproducible.py: {' '.join(str(word) for word in words)}:\n{done.stdout}{done.stderr}")
    return done.stdout


def copy_sources(folder):
    folder.mkdir(parents=True)
    listed = run(ROOT, "git", "ls-files", "-z", "--cached", "--others", "--exclude-standard")
    present = "\0".join(name for name in listed.split("\0") if name and (ROOT / name).exists())
    subprocess.run(f"tar -cf - --null -T - | tar -xf - -C '{folder}'", shell=True, cwd=ROOT, input=present, text=True, check=True)
    if (ROOT / "viewer" / "node_modules").is_dir():
        (folder / "viewer" / "node_modules").symlink_to(ROOT / "viewer" / "node_modules")


def build(folder, modules, jobs):
    """{file: SHA-256} of packages and libraries."""
    copy_sources(folder)
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "CCACHE_DISABLE": "1"}
    more = [f"-DSNUG_MODULES={modules}", "-DSNUG_PROGRAM=OFF"] if modules else []
    run(folder, "cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSNUG_TESTS=OFF", "-DSNUG_PYTHON_MODULE=OFF",
        *more, env=environment)
    run(folder, "cmake", "--build", "build", "-j", jobs, env=environment)
    if not modules:
        run(folder / "build", "cpack", "-G", "DEB", env=environment)
    made = [*(folder / "build").glob("*.deb"), *(folder / "build" / "src").rglob("*.a"), *(folder / "build").glob("snug")]
    return {path.relative_to(folder / "build").as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in made}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--modules", default="")
    words = parser.parse_args()
    jobs = os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as folder:
        first = build(Path(folder) / "a", words.modules, jobs)
        time.sleep(2.0)  # no time stamp of the one is that of the other
        second = build(Path(folder) / "another" / "folder", words.modules, 1 if words.modules else jobs + 1)
    different = sorted(name for name in first.keys() | second.keys() if first.get(name) != second.get(name))
    for name in different:
        print(f"differs: {name}")
    print(f"{len(first) - len(different)} of {len(first)} files are the same")
    sys.exit(1 if different or not first else 0)


if __name__ == "__main__":
    main()
