#!/usr/bin/env python3
"""shell_test.py: the manual and the completion in shells say what --help says. SNUG names the program."""
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))


def run(*words, stdin=""):
    return subprocess.run(words, input=stdin, capture_output=True, text=True, check=False, timeout=60)


def complete(*words):
    """What bash offers for the last of the words."""
    script = run(SNUG, "completion", "bash").stdout
    quoted = " ".join(f"'{word}'" for word in words)
    script += f'COMP_WORDS=(snug {quoted}); COMP_CWORD={len(words)}; _snug; printf "%s\\n" "${{COMPREPLY[@]}}"\n'
    result = run("bash", "-u", stdin=script)
    assert result.returncode == 0, result.stderr
    return result.stdout.split()


def verbs():
    """Each verb with its parts, as --help lists them: ("pack",), ("cup", "evaluate")."""
    def below(*words):
        found = re.search(r"\nSubcommands:\n((?:  .*\n)+)", run(SNUG, *words, "--help").stdout)
        for name in re.findall(r"^  (\S+)", found.group(1), re.MULTILINE) if found else ():
            yield (*words, name)
            yield from below(*words, name)
    return list(below())


class Shell(unittest.TestCase):
    def test_bash_offers_verbs_parts_options_and_choices(self):
        self.assertIn("simulate", complete("sim"))
        self.assertEqual(sorted(complete("cup", "")), ["catalogue", "estimate", "evaluate", "settle"])
        self.assertEqual(complete("pack", "scenario.yaml", "--sequ"), ["--sequence"])
        self.assertEqual(complete("pack", "--agent", "mar"), ["margin"])
        self.assertEqual(complete("pack", "--agent", "margin", "--perc"), ["--perception"])

    def test_bash_offers_what_may_follow_a_flag(self):
        self.assertIn("--csv", complete("simulate", "--json", "--c"))
        self.assertIn("pack", complete("--help", "pa"))

    def test_bash_leaves_names_of_files_to_the_shell(self):
        self.assertEqual(complete("pack", "--program", ""), [])
        self.assertEqual(complete("report", ""), [])

    def test_every_verb_and_option_of_the_help_is_in_each(self):
        texts = {shell: run(SNUG, "completion", shell).stdout for shell in ("bash", "zsh", "fish")}
        texts["manual"] = run(SNUG, "manual").stdout.replace("\\-", "-")
        self.assertGreater(len(verbs()), 15)
        for words in verbs():
            options = re.findall(r"^  (?:-\w,)?--([a-z-]+)", run(SNUG, *words, "--help").stdout, re.MULTILINE)
            self.assertIn("help", options, words)
            for name, text in texts.items():
                self.assertIn(" ".join(words), text, name)
                for option in options:
                    self.assertIn(f"-l {option}" if name == "fish" else f"--{option}", text, (name, words))

    def test_an_option_that_verbs_share_says_the_same_in_each(self):
        said = {"--json": {}, "--set": {}}
        for words in verbs():
            if words[0] in ("items", "compare"):
                continue  # of lists of results
            for option, about in re.findall(r"^  (--json|--set)\b.*?  +(\S.*)$", run(SNUG, *words, "--help").stdout, re.MULTILINE):
                said[option].setdefault(about, []).append(words)
        for option, texts in said.items():
            self.assertEqual(len(texts), 1, (option, texts))
            self.assertGreater(len(next(iter(texts.values()))), 5, option)

    def test_each_script_is_read_by_its_shell(self):
        for shell in ("bash", "zsh", "fish"):
            with self.subTest(shell=shell):
                if not shutil.which(shell):
                    continue
                result = run(shell, "-n", stdin=run(SNUG, "completion", shell).stdout)
                self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_unknown_shell_is_refused(self):
        result = run(SNUG, "completion", "csh")
        self.assertEqual(result.returncode, 2)
        self.assertIn("bash, zsh, fish", result.stderr)

    def test_manual_is_read_without_a_complaint(self):
        if not shutil.which("man"):
            self.skipTest("man is not installed")
        page = subprocess.run(["man", "--warnings", "-l", "-"], input=run(SNUG, "manual").stdout, capture_output=True,
                              text=True, check=False, env={**os.environ, "MANWIDTH": "100", "LC_ALL": "C.UTF-8"})
        self.assertEqual((page.returncode, page.stderr), (0, ""))
        for text in ("NAME", "snug pack", "--decision-time", "of margin, contact-aware", "snug cup evaluate scenarios/examples/"):
            self.assertIn(text, " ".join(page.stdout.split()))  # lines end elsewhere in another release of groff


if __name__ == "__main__":
    unittest.main()
