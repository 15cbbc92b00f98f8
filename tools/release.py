#!/usr/bin/env python3
"""release.py [--check]: makes what a release consists of, from its tag, in build/release: sources, Debian packages, wheel, bill of materials, notes, sums.

The tag is v and the version that CMakeLists.txt, CITATION.cff and the newest section of CHANGELOG.md agree on; the sources are those of the tag, in a
folder of their own, whatever else has changed here. --check ends before anything is built. Exit code 2: there is no such tag, or they do not agree."""
import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class NotReady(Exception):
    """Why there can be no release yet."""


def git(root, *words):
    done = subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise NotReady(f"git {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def find(pattern, text, where):
    match = re.search(pattern, text, re.M)
    if not match:
        raise NotReady(f"{where}: expected a line like '{pattern}'")
    return match


def notes_of(changelog, version):
    """The newest section, without its heading."""
    head = find(r"^## (\S+) \((.*)\)$", changelog, "CHANGELOG.md")
    if head[1] != version:
        raise NotReady(f"CHANGELOG.md: the newest section is {head[1]}; expected {version}, as CMakeLists.txt says")
    if not re.fullmatch(r"\d{4}-\d\d-\d\d", head[2]):
        raise NotReady(f"CHANGELOG.md: {version} has '{head[2]}'; expected the day of the release, as 2026-11-28")
    rest = changelog[head.end():]
    following = re.search(r"^## ", rest, re.M)
    return rest[:following.start() if following else len(rest)].strip() + "\n"


def check(root):
    """Version, tag and notes of the release that the tag makes."""
    version = find(r"^project\(snug VERSION (\S+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"), "CMakeLists.txt")[1]
    tag = f"v{version}"
    if tag not in git(root, "tag", "--list", tag).split():
        raise NotReady(f"there is no tag {tag}; expected `git tag -a {tag}` on the commit to release")
    at_tag = {name: git(root, "show", f"{tag}:{name}") for name in ("CMakeLists.txt", "CITATION.cff", "CHANGELOG.md")}
    if (built := find(r"^project\(snug VERSION (\S+)", at_tag["CMakeLists.txt"], "CMakeLists.txt")[1]) != version:
        raise NotReady(f"{tag} has version {built} in CMakeLists.txt")
    if (cited := find(r"^version: (\S+)$", at_tag["CITATION.cff"], "CITATION.cff")[1]) != version:
        raise NotReady(f"CITATION.cff: version {cited}; expected {version}, as CMakeLists.txt says")
    return version, tag, notes_of(at_tag["CHANGELOG.md"], version)


def make(root, version, tag, notes, folder):
    """Everything into a folder beside, which then takes the other's place."""
    environment = {**os.environ, "SOURCE_DATE_EPOCH": git(root, "log", "-1", "--format=%ct", tag).strip()}
    beside = folder.with_name(folder.name + ".new")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as name:
        sources = Path(name) / f"snug-{version}"
        subprocess.run(["git", "clone", "--quiet", "--branch", tag, "--config", "advice.detachedHead=false", str(root), str(sources)], check=True)
        subprocess.run(["git", "-C", str(sources), "archive", "--format=tar.gz", f"--prefix=snug-{version}/", "-o", str(beside / f"snug-{version}.tar.gz"), tag],
                       check=True)
        for verb in ("package", "wheel"):
            subprocess.run(["make", verb], cwd=sources, env=environment, check=True)
        for pattern in ("build/*.deb", "build/snug.spdx.json", "build/wheel/*.whl"):
            found = sorted(sources.glob(pattern))
            if not found:
                raise NotReady(f"the build left no {pattern}")
            for file in found:
                shutil.copy(file, beside)
    (beside / "NOTES.md").write_text(notes, encoding="utf-8")
    sums = "".join(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in sorted(beside.iterdir()))
    (beside / "SHA256SUMS").write_text(sums, encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    beside.rename(folder)
    return sorted(file.name for file in folder.iterdir())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only whether version, tag and notes agree")
    parser.add_argument("--root", type=Path, default=ROOT, help=argparse.SUPPRESS)
    words = parser.parse_args()
    try:
        version, tag, notes = check(words.root)
        print(f"{tag}: version {version}, notes of {len(notes.split())} words")
        if words.check:
            return
        folder = words.root / "build" / "release"
        for name in make(words.root, version, tag, notes, folder):
            print(f"build/release/{name}")
    except NotReady as why:
        print(f"release.py: {why}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
