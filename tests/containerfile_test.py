#!/usr/bin/env python3
"""containerfile_test.py: the steps of the Containerfile are run without a container engine, each stage in a copy of a Debian 12 folder,
and the program that they leave packs. SNUG_DEBIAN_FOLDER names the folder (`debootstrap --variant=minbase bookworm FOLDER`); without it,
or without being root, the steps are read only, and said so."""
import json
import os
import shlex
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEBIAN = os.environ.get("SNUG_DEBIAN_FOLDER", "")
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
VERBS = {"RUN", "COPY", "WORKDIR", "ENV", "ENTRYPOINT"}


def read_stages(text):
    """[(name, base, [(verb, rest)])] of a Containerfile."""
    stages = []
    for line in text.replace("\\\n", " ").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        verb, rest = line.split(maxsplit=1)
        if verb == "FROM":
            words = rest.split()
            stages.append((words[2] if words[1:2] == ["AS"] else "", words[0], []))
        else:
            stages[-1][2].append((verb, rest))
    return stages


class Stage:
    """A folder that stands for the file system of a stage."""

    def __init__(self, base, folder):
        self.folder, self.work, self.environment, self.entry = Path(folder), "/", {}, []
        subprocess.run(["cp", "-a", "--reflink=auto", f"{base}/.", folder], check=True)
        shutil.copy("/etc/resolv.conf", self.folder / "etc" / "resolv.conf")

    def run(self, *command):
        """In the folder as root, with the certificates that this machine trusts beside those of the folder."""
        certificates = os.environ.get("NODE_EXTRA_CA_CERTS", "")
        if certificates:
            shutil.copy(certificates, self.folder / "run" / "certificates.crt")
            self.environment.setdefault("NODE_EXTRA_CA_CERTS", "/run/certificates.crt")
        words = ["env", "-i", "HOME=/root", *(f"{key}={value}" for key, value in
                 {"PATH": PATH, **self.environment}.items()), *command]
        mounts = (f"mount -t proc proc {self.folder}/proc && mount --rbind /dev {self.folder}/dev && mkdir -p {self.folder}{self.work} && "
                  f"exec chroot {self.folder} sh -c {shlex.quote(f'cd {self.work} && exec ' + shlex.join(words))}")
        return subprocess.run(["unshare", "--mount", "sh", "-c", mounts], capture_output=True, text=True, check=False)

    def step(self, verb, rest, stages):
        if verb == "RUN":
            result = self.run("sh", "-c", rest)
            if result.returncode:
                raise AssertionError(f"RUN {rest}\n{result.stdout[-2000:]}\n{result.stderr[-2000:]}")
        elif verb == "WORKDIR":
            self.work = rest
            (self.folder / rest.lstrip("/")).mkdir(parents=True, exist_ok=True)
        elif verb == "ENV":
            key, value = rest.split("=", 1)
            self.environment[key] = shlex.split(value)[0].replace("$PATH", PATH)
        elif verb == "ENTRYPOINT":
            self.entry = json.loads(rest)
        elif verb == "COPY":
            words = rest.split()
            source = stages[words.pop(0).removeprefix("--from=")].folder if words[0].startswith("--from=") else ROOT
            target = self.folder / words[1].lstrip("/")
            target.mkdir(parents=True, exist_ok=True)
            if source == ROOT:  # what git has: .dockerignore leaves out what builds make
                files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
                packed = subprocess.run(["tar", "--null", "-T", "-", "-cf", "-"], cwd=ROOT, input=files, capture_output=True, check=True).stdout
                subprocess.run(["tar", "-C", str(target), "-xf", "-"], input=packed, check=True)
            else:
                subprocess.run(["cp", "-a", f"{source}/{words[0].lstrip('/')}/.", str(target)], check=True)


class Containerfile(unittest.TestCase):
    stages = read_stages((ROOT / "Containerfile").read_text(encoding="utf-8"))

    def test_every_step_is_one_that_is_run_here(self):
        self.assertEqual([base for _, base, _ in self.stages], ["docker.io/library/debian:12"] * 2)
        names = {name for name, _, _ in self.stages if name}
        for _, _, steps in self.stages:
            for verb, rest in steps:
                self.assertIn(verb, VERBS)
                if verb == "COPY" and rest.startswith("--from="):
                    self.assertIn(rest.split()[0].removeprefix("--from="), names)

    def test_steps_leave_a_program_that_packs(self):
        if not DEBIAN or os.geteuid() != 0 or not (ROOT / ".git").exists():
            self.skipTest("no folder of Debian 12 (SNUG_DEBIAN_FOLDER), not root, or no clone: the steps of the Containerfile are not run")
        with tempfile.TemporaryDirectory(prefix="snug-container-", dir=Path(DEBIAN).parent) as scratch:
            made = {}
            for number, (name, _, steps) in enumerate(self.stages):
                stage = made[name] = Stage(DEBIAN, f"{scratch}/{number}")
                for verb, rest in steps:
                    stage.step(verb, rest, made)
            shutil.copytree(ROOT / "scenarios", stage.folder / "work" / "scenarios")
            result = stage.run(*stage.entry, "pack", "scenarios/box-demonstrator.yaml", "--sequence", "1", "--robot", "none", "--samples", "0",
                               "-o", "run.h5")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertTrue((stage.folder / "work" / "run.h5").is_file())


if __name__ == "__main__":
    unittest.main()
