#!/usr/bin/env python3
"""study_test.py: studies as a user meets them: run, killed, gone on with, merged, reported, and as jobs of a cluster. SNUG names
the program."""
import csv
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
ONE_NODE = ROOT.parent / "shared" / "tools" / "slurm-one-node.sh"

STUDY = """
name: drops
verb: simulate
scenario: {scenario}
options: {{--until: 0.05}}
design: {design}
{rows}
factors:
  - {{set: gravity, values: [[0, 0, -9.81], [0, 0, -1.62]]}}
  - {{set: seed, values: [1, 2, 3]}}
repeat: {repeat}
chunk: {chunk}
"""


class Scratch(unittest.TestCase):
    """A folder that goes away, and studies in it."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a scheduler that ends may still write
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def snug(self, *words, code=0, **more):
        result = subprocess.run([SNUG, *map(str, words)], cwd=self.folder, capture_output=True, text=True, check=False,
                                timeout=1100, **more)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def write(self, name="study.yaml", design="grid", rows="", repeat=2, chunk=4, more=""):
        (self.folder / name).write_text(STUDY.format(scenario=ROOT / "scenarios" / "drop.yaml", design=design, rows=rows,
                                                     repeat=repeat, chunk=chunk) + more)
        return name

    def merged(self, name="study.yaml", *words):
        self.snug("study", "merge", name, "-o", "merged.csv", *words)
        return (self.folder / "merged.csv").read_text()


class Study(Scratch):
    def test_every_row_is_what_its_command_says(self):
        study = self.write()
        self.snug("study", study)
        rows = list(csv.DictReader(self.merged().splitlines()))
        self.assertEqual([int(row["row"]) for row in rows], list(range(12)))
        self.assertEqual({row["exit"] for row in rows}, {"0"})
        row = rows[7]
        alone = self.snug("simulate", ROOT / "scenarios" / "drop.yaml", "--until", "0.05", "--set", f"gravity={row['gravity']}",
                          "--set", f"seed={row['seed']}", "--seed", row["row_seed"], "--json")
        self.assertEqual(json.loads(alone.stdout)["state_hash"], row["state_hash"])

    def test_same_bytes_at_any_number_of_threads_and_nothing_is_done_twice(self):
        study = self.write()
        texts = []
        for threads in (1, 3):
            self.snug("study", study, "--dir", f"d{threads}", "--threads", threads)
            again = json.loads(self.snug("study", study, "--dir", f"d{threads}", "--json").stdout)
            self.assertEqual(again["done"], 0)
            texts.append(self.merged(study, "--dir", f"d{threads}"))
        self.assertEqual(*texts)

    def test_killed_and_gone_on_with_has_every_row_once(self):
        study = self.write(repeat=20, chunk=7)
        self.snug("study", study, "--dir", "whole")
        for round_ in range(20):
            process = subprocess.Popen([SNUG, "study", study, "--dir", "killed", "--threads", "2"], cwd=self.folder,
                                       stdout=subprocess.DEVNULL)
            time.sleep(0.15 + 0.05 * (round_ % 5))
            process.send_signal(signal.SIGKILL)
            process.wait()
        self.snug("study", study, "--dir", "killed")
        status = json.loads(self.snug("study", "status", study, "--dir", "killed", "--json").stdout)
        self.assertEqual((status["done"], status["rows"]), (120, 120))
        self.assertEqual(self.merged(study, "--dir", "killed"), self.merged(study, "--dir", "whole"))

    def test_a_scenario_that_changes_between_two_calls_is_refused_by_name(self):
        scenario = self.folder / "cell.yaml"
        scenario.write_text((ROOT / "scenarios" / "drop.yaml").read_text())
        study = self.write()
        (self.folder / study).write_text((self.folder / study).read_text().replace(str(ROOT / "scenarios" / "drop.yaml"), "cell.yaml"))
        self.snug("study", study, "--chunks", "0")
        before = scenario.read_text()
        scenario.write_text(before.replace("friction: 0.3", "friction: 0.7"))
        refused = self.snug("study", study, code=2)
        # The rows of a table end in any order; the one that ended first is named.
        self.assertRegex(refused.stderr, "cell.yaml: got not the file that row [0-3] was done with")
        self.assertEqual(json.loads(self.snug("study", "status", study, "--json").stdout)["done"], 4)
        scenario.write_text(before)
        self.snug("study", study)
        hashes = {row["inputs"] for row in csv.DictReader(self.merged().splitlines())}
        self.assertEqual(len(hashes), 1)
        self.assertRegex(hashes.pop(), "^[0-9a-f]{16}$")

    def test_page_has_effects_and_commands(self):
        study = self.write(more="outputs: [bodies.0.X_WB.p.2, duration_s]\n")
        self.snug("study", study)
        self.snug("study", "report", study, "-o", "page.html")
        page = (self.folder / "page.html").read_text()
        for text in ("Main effects", "Interactions", "Worst rows", "snug simulate", "gravity"):
            self.assertIn(text, page)
        self.assertNotIn("<script", page)

    def test_table_as_hdf5(self):
        study = self.write()
        self.snug("study", study)
        self.snug("study", "merge", study, "-o", "merged.h5")
        if shutil.which("h5dump"):
            dump = subprocess.run(["h5dump", "-d", "/row", self.folder / "merged.h5"], capture_output=True, text=True, check=True)
            self.assertIn("11", dump.stdout)

    def test_a_row_that_fails_is_a_result(self):
        self.write(more="")
        text = (self.folder / "study.yaml").read_text().replace("values: [1, 2, 3]", "values: [1, 2, x]")
        (self.folder / "study.yaml").write_text(text)
        summary = json.loads(self.snug("study", "study.yaml", "--json").stdout)
        self.assertEqual((summary["done"], summary["failed"]), (12, 4))
        failed = [row for row in csv.DictReader(self.merged().splitlines()) if row["exit"] != "0"]
        self.assertTrue(all("seed" in row["error"] for row in failed))

    def test_a_study_whose_first_row_cannot_be_run_leaves_nothing_and_can_be_corrected(self):
        right = (self.folder / self.write()).read_text()
        for wrong in (right.replace("set: gravity", "set: gravty"), right.replace("set: seed", "option: --sede")):
            (self.folder / "study.yaml").write_text(wrong)
            self.assertIn("row 0", self.snug("study", "study.yaml", "--threads", "3", code=2).stderr)
            self.snug("study", "study.yaml", "--chunks", "9", code=2)
            self.assertEqual([path.name for path in self.folder.iterdir()], ["study.yaml"])
        (self.folder / "study.yaml").write_text(right)
        self.assertEqual(json.loads(self.snug("study", "study.yaml", "--json").stdout)["failed"], 0)

    def test_what_cannot_be_run_is_refused_with_the_reason(self):
        for change, word in ((("verb: simulate", "verb: simulat"), "simulat"), (("--until", "--untill"), "untill"),
                             (("design: grid", "design: cube"), "cube"), (("chunk: 4", "chunk: 0"), "chunk")):
            with self.subTest(word=word):
                self.write()
                path = self.folder / "study.yaml"
                path.write_text(path.read_text().replace(*change))
                result = self.snug("study", "study.yaml", "--dir", f"d-{word}", code=2)
                self.assertIn(word, result.stderr)
        self.snug("study", code=2)
        self.snug("study", "status", self.write("other.yaml"), code=2)
        self.snug("study", "merge", "other.yaml", "-o", "x.txt", code=2)

    def test_a_changed_study_is_refused_in_the_folder_of_the_old(self):
        study = self.write()
        self.snug("study", study, "--chunks", "0")
        self.write(repeat=3)
        self.assertIn("study.study", self.snug("study", study, code=2).stderr)

    def test_script_for_slurm_has_what_is_missing(self):
        study = self.write(more="slurm: {time: '1:00:00'}\n")
        self.snug("study", study, "--chunks", "1")
        script = self.folder / self.snug("study", study, "--slurm", "--dry-run").stdout.strip()
        text = script.read_text()
        self.assertIn("#SBATCH --array=0-1\n", text)
        self.assertIn("set -- 0-0 2-2\n", text)
        self.assertIn("#SBATCH --time=1:00:00\n", text)
        subprocess.run(["sh", "-n", script], check=True)
        subprocess.run(["sh", script], check=True, cwd=self.folder, env=dict(os.environ, SLURM_ARRAY_TASK_ID="1"),
                       stdout=subprocess.DEVNULL)
        status = json.loads(self.snug("study", "status", study, "--json").stdout)
        self.assertEqual(status["done"], 8)

    def test_agents_written_in_python_pack_and_are_compared(self):
        (self.folder / "mine.py").write_text("class Lowest:\n  def decide(self, state, item, candidates):\n"
                                             "    print('not an answer')\n    return candidates[:4]\n"
                                             "class Broken:\n  def decide(self, *_):\n    raise ValueError('oh')\n")
        scenario = ROOT / "scenarios" / "box-demonstrator.yaml"
        words = ("--samples", "0", "--decision-time", "0.01", "--robot", "none", "--json")
        packed = json.loads(self.snug("pack", scenario, "--sequence", "1", "--agent", "mine:Lowest", *words).stdout)
        self.assertEqual(packed["agent"], "mine:Lowest")
        self.assertGreaterEqual(packed["executed_boxes"], 4)
        rows = json.loads(self.snug("compare", scenario, "--sequences", "1", "--agents", "margin,mine:Lowest", *words).stdout)
        self.assertEqual([row["agent"] for row in rows["rows"]], ["margin", "mine:Lowest"])
        self.assertIn("ValueError", self.snug("pack", scenario, "--sequence", "1", "--agent", "mine:Broken", *words, code=1).stderr)
        for agent, word in (("mine:None_", "None_"), ("nowhere:X", "nowhere"), ("margn", "margin")):
            said = self.snug("pack", scenario, "--sequence", "1", "--agent", agent, *words, code=2).stderr
            self.assertIn(word, said)
            self.assertNotIn("Traceback", said)


class Rows(Scratch):
    """The program's own comparisons are studies: the same runner, the same promises."""

    CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
    QUICK = ("--container", "220x220x120", "--samples", "0", "--decision-time", "0.01", "--robot", "none")
    COMPARE = ("compare", CELL, "--sequences", "1,2", "--agents", "margin,manual", "--plants", "2", *QUICK)

    @staticmethod
    def without_clock(text):
        rows = list(csv.DictReader(text.splitlines()))
        for row in rows:
            del row["decision_seconds_median"], row["boxes_per_hour_with_planning"]
        return rows

    def test_comparison_has_the_same_rows_at_any_number_of_threads(self):
        one, three = (self.without_clock(self.snug(*self.COMPARE, "--csv", "--threads", threads).stdout) for threads in (1, 3))
        self.assertEqual(len(one), 8)
        self.assertEqual(one, three)
        self.assertEqual([(row["agent"], row["sequence"], row["plant_seed"]) for row in one[:3]],
                         [("margin", "1", "1"), ("margin", "1", "2"), ("margin", "2", "1")])
        self.assertEqual(list(one[0])[-1], "failure")
        self.assertEqual({row["failure"] for row in one}, {""})

    def test_comparison_in_a_folder_goes_on_after_a_kill_and_is_a_study(self):
        words = (*self.COMPARE, "--csv", "--dir", "kept")
        study = self.folder / "kept" / "study.yaml"

        def done():
            return json.loads(self.snug("study", "status", study, "--dir", "kept", "--json").stdout)["done"]

        process = subprocess.Popen([SNUG, *map(str, words), "--threads", "1"], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        end = time.monotonic() + 100
        while not study.exists() or done() < 2:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)
        process.kill()
        process.wait()
        self.assertLess(done(), 8)
        whole = self.snug(*words).stdout
        self.assertEqual(self.without_clock(whole), self.without_clock(self.snug(*self.COMPARE, "--csv").stdout))
        self.assertEqual(self.snug(*words).stdout, whole, "nothing is done again: not even the clock differs")
        self.snug("study", "merge", study, "--dir", "kept", "-o", "merged.csv")
        merged = list(csv.DictReader((self.folder / "merged.csv").read_text().splitlines()))
        self.assertEqual([(row["agent"], row["sequence"], row["plant-seed"]) for row in merged],
                         [(row["agent"], row["sequence"], row["plant_seed"]) for row in csv.DictReader(whole.splitlines())])
        self.assertEqual(json.loads(self.snug("study", study, "--dir", "kept", "--json").stdout)["done"], 0)
        self.assertIn("not the study", self.snug(*words, "--skips", "1", code=2).stderr)

    def test_comparison_that_is_interrupted_keeps_whole_rows(self):
        process = subprocess.Popen([SNUG, *map(str, self.COMPARE), "--csv", "--threads", "2"], cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        head, first = process.stdout.readline(), process.stdout.readline()
        process.send_signal(signal.SIGINT)
        rest, said = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 1)
        self.assertIn("interrupted after", said)
        rows = list(csv.DictReader((head + first + rest).splitlines()))
        self.assertTrue(0 < len(rows) < 8)
        self.assertTrue(all(row["boxes_per_hour"] for row in rows))

    def test_sessions_that_were_interrupted_are_shown_and_not_counted(self):
        table = self.folder / "table.json"
        with table.open("w") as out:
            process = subprocess.Popen([SNUG, *map(str, self.COMPARE), "--json", "--threads", "2", "-o", "page.html"], text=True,
                                       cwd=self.folder, stdout=out, stderr=subprocess.PIPE)
            while "agent" not in table.read_text() and process.poll() is None:
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=100)[1]
        self.assertEqual(process.returncode, 1)
        self.assertEqual(said.count("interrupted"), 1, said)
        told = json.loads(table.read_text())
        whole = [row for row in told["rows"] if row["stop_reason"] != "interrupted"]
        self.assertEqual(told["interrupted"], len(told["rows"]) - len(whole))
        self.assertEqual(sum(mean["runs"] for mean in told["means"]), len(whole))
        self.assertIn(f"{len(whole)} sessions compared", (self.folder / "page.html").read_text())

    def test_session_that_is_interrupted_ends_with_exit_code_1_and_says_so(self):
        process = subprocess.Popen([SNUG, "pack", self.CELL, "--sequence", "1", *self.QUICK, "--program", "p.csv"], text=True,
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        while "box" not in process.stdout.readline().lower():  # the head of the table
            pass
        process.send_signal(signal.SIGINT)
        out, said = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 1, out)
        self.assertRegex(said, r"^snug: interrupted after \d+ items\n")
        self.assertIn("interrupted", out)

    def test_what_no_session_can_use_is_said_before_the_first(self):
        for words, reason in ((("--agents", "margin,nowhere:X"), "nowhere"), (("--fault", "fire@3"), "fire"),
                              (("--plants", "10000", "--agents", "all"), "at most 20000")):
            result = self.snug("compare", self.CELL, "--sequences", "1", *words, *self.QUICK, "--csv", code=2)
            self.assertIn(reason, result.stderr)
            self.assertEqual(result.stdout, "")

    def test_repeated_runs_are_the_draws_and_the_same_at_any_number_of_threads(self):
        self.snug("pack", self.CELL, "--sequence", "1", "--agent", "margin", *self.QUICK, "--program", "p.csv")
        run = ("simulate", self.CELL, "--program", "p.csv", "--sequence", "1", "--container", "220x220x120", "--seed", "5", "--json")
        texts = [self.snug(*run, "--monte-carlo", "3", "--threads", threads).stdout for threads in (1, 3)]
        self.assertEqual(*texts)
        runs = json.loads(texts[0])["runs"]
        self.assertEqual(len({one["state_hash"] for one in runs}), 3)
        alone = json.loads(self.snug(*run, "--draw", "2", "-o", "second.h5").stdout)
        self.assertEqual((alone["state_hash"], alone["filling_degree_percent"]),
                         (runs[1]["state_hash"], runs[1]["filling_degree_percent"]))
        self.assertTrue((self.folder / "second.h5").exists())
        self.assertIn("--draw", self.snug("simulate", self.CELL, "--draw", "2", code=2).stderr)

    def test_a_packed_program_repeated_is_the_same_at_any_number_of_threads(self):
        run = ("pack", self.CELL, "--sequence", "1", "--agent", "margin", *self.QUICK, "--monte-carlo", "3", "--json")
        one, two = (json.loads(self.snug(*run, "--threads", threads).stdout)["monte_carlo"] for threads in (1, 2))
        self.assertEqual(one, two)
        self.assertEqual(one["count"], 3)


@unittest.skipUnless(shutil.which("slurmctld") and shutil.which("munge") and os.geteuid() == 0 and ONE_NODE.exists(),
                     "Slurm is not installed (scripts/install-deps.sh cluster), or not root")
class Cluster(Scratch):
    """One node on loopback; the scheduler is killed and restarted, and so is a process on the node."""

    def test_every_row_once_though_scheduler_and_node_are_killed(self):
        study = self.write(repeat=334, chunk=100, more="")  # 2004 rows
        self.snug("study", study, "--dir", "here")
        state = self.folder / "slurm"
        self.addCleanup(subprocess.run, [ONE_NODE, "stop", state], check=False, capture_output=True)
        subprocess.run([ONE_NODE, "start", state], check=True, capture_output=True, timeout=120)
        environment = dict(os.environ, SLURM_CONF=str(state / "slurm.conf"))
        self.snug("study", study, "--dir", "cluster", "--slurm", env=environment)

        def done():
            return json.loads(self.snug("study", "status", study, "--dir", "cluster", "--json").stdout)["done"]

        def slurm(*words):
            return subprocess.run(words, env=environment, capture_output=True, text=True, check=False).stdout

        def wait_for(rows, seconds, or_nothing_queued=False):
            end = time.monotonic() + seconds
            while done() < rows and not (or_nothing_queued and not slurm("squeue", "-h").strip()):
                self.assertLess(time.monotonic(), end, slurm("squeue"))
                self.mend_node(slurm)
                time.sleep(0.5)

        wait_for(200, 200)
        scheduler = int((state / "slurmctld.pid").read_text())
        os.kill(scheduler, signal.SIGKILL)
        victims = [int(pid.name) for pid in Path("/proc").glob("[0-9]*") if self.is_row_of(pid, "cluster")]
        for victim in victims[:1]:
            os.kill(victim, signal.SIGKILL)
        subprocess.run(["slurmctld"], env=environment, check=True)
        wait_for(2004, 200, or_nothing_queued=True)
        if done() < 2004:  # the task whose process was killed has failed; what it left is submitted again
            self.snug("study", study, "--dir", "cluster", "--slurm", env=environment)
        wait_for(2004, 200)
        self.assertEqual(self.merged(study, "--dir", "cluster"), self.merged(study, "--dir", "here"))

    @staticmethod
    def mend_node(slurm):
        """What an administrator does after the kill: a scheduler that forgot the last task it started starts it again, is told by
        the node that it runs already ("Duplicate jobid"), and sets the node aside and holds the task."""
        if any(word in slurm("sinfo", "-h", "-o", "%T") for word in ("drain", "down")):
            slurm("scontrol", "update", "NodeName=ALL", "State=RESUME")
        for line in slurm("squeue", "-h", "-o", "%i %r").splitlines():
            job, _, reason = line.partition(" ")
            if "held" in reason.lower():
                slurm("scontrol", "release", job.partition("_")[0])

    @staticmethod
    def is_row_of(process, folder):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:
            return False
        return b"study" in words and folder.encode() in words and b"--chunks" in words


if __name__ == "__main__":
    unittest.main()
