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


# Names that code had, as whole words of identifiers; words that may mean something else there are left to readers.
REPLACED_NAMES = {
    "faithful": "lagged", "happening": "event, or what it is", "heed": "observe", "heeds": "observe", "who_sticks_out": "find_...",
    "k_in_the_air": "held", "journey": "item events", "hopeless": "infeasible", "dislike": "cost",
}
NAMES = re.compile(r"(?<![a-z0-9])(" + "|".join(sorted(REPLACED_NAMES, key=len, reverse=True)) + r")(?![a-z0-9])")
# What reads old programs knows the old words.
KNOWS_OLD_WORDS = {"src/snug/motion/test/program_tracking_test.cpp"}


def texts():
    """Documents and the sources of the program, which hold its help; decision records are not edited."""
    for path in sorted([*(ROOT / "docs").rglob("*.md"), *(ROOT / "src").rglob("README.md"), *(ROOT / "apps").rglob("*.[ch]pp")]):
        if "decisions" not in path.parts:
            yield path


def sources():
    for folder in ("src", "apps", "python"):
        for path in sorted((ROOT / folder).rglob("*.[ch]pp")):
            if str(path.relative_to(ROOT)) not in KNOWS_OLD_WORDS:
                yield path


def find_words(text):
    """(line number, word) of each replaced word."""
    for number, line in enumerate(text.splitlines(), 1):
        for word in REPLACED:
            if re.search(rf"\b{word}s?\b", line, re.I):
                yield number, word


def find_names(text):
    """(line number, name) of each identifier with a replaced name in it: SomeName, kSomeName, some_name, someName_."""
    for number, line in enumerate(text.splitlines(), 1):
        snake = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", line).lower()
        for match in NAMES.finditer(snake):
            yield number, match.group(1)


class Words(unittest.TestCase):
    def test_replaced_words_stay_out_of_documents_and_help(self):
        found = [f"{path.relative_to(ROOT)}:{number}: '{word}', say '{REPLACED[word]}'"
                 for path in texts() for number, word in find_words(path.read_text(encoding="utf-8"))]
        self.assertGreater(len(list(texts())), 50)
        self.assertEqual(found, [])

    def test_replaced_names_stay_out_of_code(self):
        found = [f"{path.relative_to(ROOT)}:{number}: '{name}', say '{REPLACED_NAMES[name]}'"
                 for path in sources() for number, name in find_names(path.read_text(encoding="utf-8"))]
        self.assertGreater(len(list(sources())), 500)
        self.assertEqual(found, [])

    def test_a_replaced_name_would_be_found(self):
        for line in ("class Happening {", "who_sticks_out(load);", "constexpr double kInTheAir = 1;", "HeedsWhatElse", "// who heed each other"):
            self.assertEqual(len(list(find_names(line))), 1, line)
        self.assertEqual(list(find_names("unheeded settings.in_the_air")), [])

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
