#!/usr/bin/env python3
"""cli_test.py: the command line as a user or a script meets it. SNUG names the program."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CUP_DATA = ROOT.parent / "shared" / "data" / "cup"


def snug(*words, stdin=""):
    return subprocess.run([SNUG, *map(str, words)], input=stdin, capture_output=True, text=True, check=False,
                          timeout=240)


def offers(verb):
    return snug(verb, "--help").returncode == 0


class CommandLine(unittest.TestCase):
    def assert_refused(self, result, *expected):
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "", "messages belong on stderr")
        self.assertTrue(result.stderr.startswith("snug: error: "), result.stderr)
        for text in expected:
            self.assertIn(text, result.stderr)

    def test_version_is_printed_on_stdout(self):
        result = snug("--version")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"^snug \d+\.\d+\.\d+\n$")

    def test_version_is_that_of_the_changelog(self):
        newest = next(line for line in (ROOT / "CHANGELOG.md").read_text().splitlines() if line.startswith("## "))
        self.assertIn(snug("--version").stdout.split()[1], newest)

    def test_help_has_examples(self):
        result = snug("--help")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("Examples:", result.stdout)

    def test_no_words_print_the_help(self):
        self.assertEqual(snug().stdout, snug("--help").stdout)

    def test_unknown_verb_is_refused_and_the_verbs_are_named(self):
        self.assert_refused(snug("jump"), "'jump'", "expected one of")

    def test_unknown_option_is_refused(self):
        self.assert_refused(snug("--jump"), "--jump", "--help")
