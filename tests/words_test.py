#!/usr/bin/env python3
"""words_test.py: words that are not ours do not come back into documents and help; tools/check_commits.py knows a good subject."""
import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import check_commits  # noqa: E402

# What was said once, and what is said now (docs/style.md, docs/glossary.md).
REPLACED = {
    "faithful": "lagged", "journey": "item events", "happening": "event", "turn manner": "reorientation", "place manner": "insertion skill",
    "squeeze": "planned interference", "dislike": "cost", "heed": "observe", "take in": "update the belief",
    "on paper": "planned only", "hopeless": "infeasible", "ensemble": "Monte Carlo",
}


def texts():
    """Documents and the files that declare options; decision records are not edited."""
    for path in sorted([*(ROOT / "docs").rglob("*.md"), *(ROOT / "src").rglob("README.md"), *(ROOT / "apps").rglob("*_options.cpp")]):
        if "decisions" not in path.parts:
            yield path


def find_words(text):
    """(line number, word) of each replaced word."""
    for number, line in enumerate(text.splitlines(), 1):
        for word in REPLACED:
            if re.search(rf"\b{word}s?\b", line, re.I):
                yield number, word


class Words(unittest.TestCase):
    def test_replaced_words_stay_out_of_documents_and_help(self):
        found = [f"{path.relative_to(ROOT)}:{number}: '{word}', say '{REPLACED[word]}'"
                 for path in texts() for number, word in find_words(path.read_text(encoding="utf-8"))]
        self.assertGreater(len(list(texts())), 50)
        self.assertEqual(found, [])

    def test_a_replaced_word_would_be_found(self):
        self.assertEqual(list(find_words("fine\n--controller Faithful\nunfaithfully\n")), [(2, "faithful")])


class Commits(unittest.TestCase):
    def setUp(self):
        self.names = check_commits.names_of(ROOT)

    def test_module_and_effect_are_accepted(self):
        for subject in ("session: plan ahead on a belief snapshot", "numerics, tests: one tolerance", "pack: refuse a folder"):
            self.assertIsNone(check_commits.find_fault(subject, self.names), subject)

    def test_others_are_refused_with_the_reason(self):
        for subject, reason in (("Read again", "expected 'module: effect'"), ("moon: rises", "no module or folder 'moon'"),
                                ("cup: " + "a" * 60, "at most 60"), ("cup: holds.", "full stop")):
            self.assertIn(reason, check_commits.find_fault(subject, self.names) or "", subject)


if __name__ == "__main__":
    unittest.main()
