#!/usr/bin/env python3
"""ray_test.py: studies and vector environments on a Ray cluster of a head and two workers, each in a network namespace of its own, one of
which is killed midway. scripts/test-ray.sh runs it. Skipped in part where no namespaces can be made (not root). SNUG names the program."""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
import ray

import snug
import snug.env

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
RAY = Path(sys.executable).with_name("ray")
ROWS = int(os.environ.get("SNUG_RAY_ROWS", "480"))
WAIT = 240 + ROWS // 5  # s
NET = "10.213.77"
PORT = 6391
# A node that is killed refuses its checks at once and is lost after five; one that is slow may take its time.
ENVIRONMENT = {**os.environ, "SNUG_PYTHON": sys.executable, "RAY_DISABLE_IMPORT_WARNING": "1", "RAY_USAGE_STATS_ENABLED": "0", "RAY_AUTH_MODE": "disabled",
               "RAY_health_check_period_ms": "1000", "RAY_health_check_timeout_ms": "30000", "RAY_health_check_failure_threshold": "5",
               "RAY_health_check_initial_delay_ms": "5000"}


def run(*words, code=0, **more):
    done = subprocess.run([str(word) for word in words], text=True, capture_output=True, timeout=WAIT, check=False, env=ENVIRONMENT, **more)
    assert code is None or done.returncode == code, (words, done.returncode, done.stdout[-2000:], done.stderr[-2000:])
    return done


def can_make_namespaces():
    if os.geteuid() != 0 or not shutil.which("ip"):
        return False
    name = f"snug-try-{os.getpid()}"
    made = subprocess.run(["ip", "netns", "add", name], capture_output=True, check=False).returncode == 0
    subprocess.run(["ip", "netns", "delete", name], capture_output=True, check=False)
    return made


class Cluster:
    """A bridge with a head and two workers, each in its own namespace."""

    def __init__(self):
        self.tag = f"snug{os.getpid() % 10000}"
        self.folder = Path(tempfile.mkdtemp(prefix="ray", dir="/tmp"))  # short: it holds the paths of sockets
        run("ip", "link", "add", self.tag, "type", "bridge")
        run("ip", "address", "add", f"{NET}.1/24", "dev", self.tag)
        run("ip", "link", "set", self.tag, "up")
        self.nodes = []
        for number in (2, 3, 4):
            self.add_node(number)
        self.address = f"{NET}.2:{PORT}"

    def add_node(self, number):
        name, link = f"{self.tag}-{number}", f"{self.tag}v{number}"
        run("ip", "netns", "add", name)
        run("ip", "link", "add", link, "type", "veth", "peer", "name", "eth0", "netns", name)
        run("ip", "link", "set", link, "master", self.tag, "up")
        run("ip", "-n", name, "address", "add", f"{NET}.{number}/24", "dev", "eth0")
        for device in ("lo", "eth0"):
            run("ip", "-n", name, "link", "set", device, "up")
        words = ["--head", f"--port={PORT}", "--num-cpus=0", "--include-dashboard=false"] if number == 2 else [
            f"--address={NET}.2:{PORT}", "--num-cpus=2"]
        with open(self.folder / f"{number}.log", "w", encoding="utf-8") as log:
            node = subprocess.Popen(["ip", "netns", "exec", name, RAY, "start", *words, f"--node-ip-address={NET}.{number}", "--block",
                                     "--disable-usage-stats", "--object-store-memory=100000000",
                                     *([f"--temp-dir={self.folder}/r"] if number == 2 else [])],
                                    stdout=log, stderr=log, env=ENVIRONMENT, start_new_session=True)
        self.nodes.append((name, node))
        # One after the other: nodes that start at a time on one file system take each other's names of sockets.
        self.wait_until(lambda: "will now block" in (self.folder / f"{number}.log").read_text())

    @staticmethod
    def wait_until(is_true, seconds=90.0):
        end = time.monotonic() + seconds
        while not is_true():
            assert time.monotonic() < end, "a node of the cluster does not start"
            time.sleep(0.1)

    def inside(self, *words, **more):
        """Runs where the head is."""
        return run("ip", "netns", "exec", self.nodes[0][0], *words, **more)

    def kill(self, index):
        """Everything in a namespace, at once."""
        name, node = self.nodes[index]
        for process in run("ip", "netns", "pids", name).stdout.split():
            try:
                os.kill(int(process), signal.SIGKILL)
            except ProcessLookupError:
                pass
        node.wait()

    def close(self):
        for index in range(len(self.nodes)):
            self.kill(index)
            run("ip", "netns", "delete", self.nodes[index][0], code=None)
        run("ip", "link", "delete", self.tag, code=None)
        shutil.rmtree(self.folder, ignore_errors=True)


@unittest.skipUnless(can_make_namespaces(), "network namespaces cannot be made here")
class ANodeIsKilled(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = Cluster()
        cls.folder = Path(tempfile.mkdtemp())

    @classmethod
    def tearDownClass(cls):
        cls.cluster.close()
        shutil.rmtree(cls.folder, ignore_errors=True)

    def test_a_study_loses_nothing_and_an_environment_goes_on(self):
        study = self.folder / "slide.yaml"
        study.write_text((ROOT / "scenarios/examples/friction.yaml").read_text() + f"repeat: {ROWS // 12}\nchunk: 10\n")
        run(SNUG, "study", study, "--dir", "here", cwd=self.folder)
        run(SNUG, "study", "merge", study, "--dir", "here", "-o", "here.csv", cwd=self.folder)
        words = ["ip", "netns", "exec", self.cluster.nodes[0][0], SNUG, "study", study, "--dir", "there", "--ray", self.cluster.address]
        with subprocess.Popen([str(word) for word in words], cwd=self.folder, env=ENVIRONMENT, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as driver:
            end = time.monotonic() + 120
            while len(list((self.folder / "there").glob("chunk-*"))) < 3 and time.monotonic() < end and driver.poll() is None:
                time.sleep(0.05)
            self.cluster.kill(2)
            said = driver.communicate(timeout=WAIT)
        self.assertEqual(driver.returncode, 0, said)
        run(SNUG, "study", "merge", study, "--dir", "there", "-o", "there.csv", cwd=self.folder)
        self.assertEqual((self.folder / "there.csv").read_bytes(), (self.folder / "here.csv").read_bytes())

        self.cluster.add_node(5)
        program = self.folder / "environment.py"
        program.write_text(ENVIRONMENT_PROGRAM)
        result = self.cluster.inside(sys.executable, program, self.cluster.address,
                                     " ".join(run("ip", "netns", "pids", self.cluster.nodes[3][0]).stdout.split()))
        self.assertIn("the same", result.stdout, result.stderr)


# Kills the processes that it is told of (a node) after some steps.
ENVIRONMENT_PROGRAM = """
import os, signal, sys
import numpy as np
import snug, snug.env
scenario = snug.load_scenario("box-demonstrator")
there = snug.env.RayVectorPacking(scenario, 6, workers=2, sequence=None, address=sys.argv[1])
here = snug.env.VectorPacking(scenario, 6, sequence=None)
a, _ = there.reset(seed=7)
b, _ = here.reset(seed=7)
for step in range(60):
    assert all(np.array_equal(a[key], b[key]) for key in b), step
    assert there.hashes == here.hashes, step
    assert np.array_equal(there.action_masks(), here.action_masks()), step
    if step == 20:
        for one in sys.argv[2].split():
            try:
                os.kill(int(one), signal.SIGKILL)
            except ProcessLookupError:
                pass
    actions = [step % max(1, int(n)) for n in here.action_masks().sum(1)]
    a, *rest = there.step(actions)
    b, *other = here.step(actions)
    for left, right in zip(rest[:3], other[:3]):
        assert np.array_equal(left, right), step
print("the same")
"""


class Local(unittest.TestCase):
    @classmethod
    def tearDownClass(cls):
        ray.shutdown()

    def test_words_that_cannot_be(self):
        with tempfile.TemporaryDirectory() as folder:
            study = ROOT / "scenarios/examples/friction.yaml"
            script = run(SNUG, "study", study, "--ray", "local", "--dry-run", cwd=folder).stdout.strip()
            compile((Path(folder) / script).read_text(), script, "exec")
            said = run(SNUG, "study", study, "--dir", "no", "--ray", "127.0.0.1:1", cwd=folder, code=2).stderr
            self.assertIn("--ray 127.0.0.1:1", said)
            bare = subprocess.run([SNUG, "study", str(study), "--dir", "no", "--ray", "local"], cwd=folder, text=True, capture_output=True,
                                  check=False, env={**ENVIRONMENT, "SNUG_PYTHON": "/usr/bin/python3"})
            self.assertEqual(bare.returncode, 2)
            self.assertIn("pip install ray", bare.stderr)

    def test_environments_are_those_of_one_process(self):
        scenario = snug.load_scenario("box-demonstrator")
        modes = {"autoreset_mode": "same_step"}
        there = snug.env.RayVectorPacking(scenario, 5, workers=2, **modes)
        here = snug.env.VectorPacking(scenario, 5, **modes)
        a, b = there.reset(seed=[1, 2, 3, 4, 5])[0], here.reset(seed=[1, 2, 3, 4, 5])[0]
        for step in range(40):
            for key in b:
                np.testing.assert_array_equal(a[key], b[key], str(step))
            a, *rest, info = there.step(np.zeros(5, int))
            b, *other, told = here.step(np.zeros(5, int))
            for left, right in zip(rest, other):
                np.testing.assert_array_equal(left, right)
            if told:
                np.testing.assert_array_equal(info["_reason"], told["_reason"])
                np.testing.assert_array_equal(info["reason"][told["_reason"]], told["reason"][told["_reason"]])
                np.testing.assert_array_equal(info["packed_percent"][told["_reason"]], told["packed_percent"][told["_reason"]])
        self.assertEqual(there.hashes, here.hashes)
        with self.assertRaises(snug.InputError):
            snug.env.RayVectorPacking(scenario, 2, workers=3)
        there.close()


if __name__ == "__main__":
    unittest.main()
