#!/usr/bin/env python3
"""words_test.py: words that are not ours do not come back into documents, help, messages and comments; tools/check_commits.py knows a good subject."""
import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import check_commits  # noqa: E402

# What was said once, and what is said now (docs/style.md, docs/glossary.md). Words with an ordinary meaning of their own (way, share, look, room, bench, row)
# are left to readers.
REPLACED = {
    "faithful": "lagged", "journey": "item events", "happening": "event", "turn manner": "reorientation", "place manner": "insertion skill",
    "squeeze": "planned interference", "dislike": "cost", "heed": "observe", "take in": "update the belief", "set aside": "reorientation",
    "on paper": "planned only", "hopeless": "infeasible", "ensemble": "Monte Carlo", "course of events": "rollout", "teeth": "local minima",
    "stance": "orientation", "take a picture": "perceive", "how-manieth": "number of",
}
# Where such a word is meant literally.
MEANT = re.compile(r"`squeeze`|\"squeeze\"|\bname=\"stance\"|\bstance of \[ctl\]|\bsecond opinions?\b")
# Parts of sentences that needed a second reading.
SENTENCES = ("let come and", "no contact without touch", "gives way in all six", "their means were known", "which balance say", "who looks on", "who watches it",
             "is not as it has to be", "goes on without it", "that is there already", "the words that repeat", "the same words go on", "what became of every",
             "by what is felt", "knows whom it meets", "whatever it does;", "end in order", "says more than can be")


# Names that code had, as whole words of identifiers; words that may mean something else there are left to readers.
REPLACED_NAMES = {
    "faithful": "lagged", "happening": "event, or what it is", "heed": "observe", "heeds": "observe", "who_sticks_out": "find_...",
    "k_in_the_air": "held", "journey": "item events", "hopeless": "infeasible", "dislike": "cost",
}
NAMES = re.compile(r"(?<![a-z0-9])(" + "|".join(sorted(REPLACED_NAMES, key=len, reverse=True)) + r")(?![a-z0-9])")
# What reads old programs knows the old words.
KNOWS_OLD_WORDS = {"src/snug/motion/test/program_tracking_test.cpp"}


READ = ("*.md", "docs/**/*.md", "src/**/README.md", "viewer/README.md", "bench/README.md", "scenarios/**/*.yaml", "scenarios/**/*.md", "apps/**/*.[ch]pp", "src/**/*.[ch]pp",
        "viewer/src/**/*.ts", "python/**/*.py", "python/**/*.pyi", "python/src/*.cpp", "examples/**/*.py", "tools/**/*.py")


def texts():
    """Documents, help, messages and comments: all files that have any; decision records are not edited, tests hold old words on purpose."""
    for path in sorted({path for pattern in READ for path in ROOT.glob(pattern)}):
        if not {"decisions", "test", "tests"} & set(path.relative_to(ROOT).parts) and str(path.relative_to(ROOT)) not in KNOWS_OLD_WORDS:
            yield path


def sources():
    for folder in ("src", "apps", "python"):
        for path in sorted((ROOT / folder).rglob("*.[ch]pp")):
            if str(path.relative_to(ROOT)) not in KNOWS_OLD_WORDS:
                yield path


WORDS = re.compile(r"\b(" + "|".join(REPLACED) + r")s?\b", re.I)


def find_words(text):
    """(line number, word) of each replaced word."""
    for number, line in enumerate(text.splitlines(), 1):
        for match in WORDS.finditer(MEANT.sub("", line)):
            yield number, match[1].lower()


def find_sentences(text):
    """(line number, part) of each sentence that was hard; a line's end is a blank, as are quotes. Comments of code are not read."""
    flat = re.sub(r"[\s\"]+", " ", re.sub(r"(?m)(^|\s)//.*$", " ", text))
    for part in SENTENCES:
        if part in flat:
            yield text[:text.find(part.split()[0])].count("\n") + 1, part


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
        self.assertGreater(len(list(texts())), 500)
        self.assertEqual(found, [])

    def test_hard_sentences_stay_out_of_documents_help_and_messages(self):
        found = [f"{path.relative_to(ROOT)}: '{part}'" for path in texts() for _, part in find_sentences(path.read_text(encoding="utf-8"))]
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
        self.assertEqual(list(find_words("`squeeze` in earlier scripts, a second opinion, an instance\nA stance")), [(2, "stance")])

    def test_a_hard_sentence_would_be_found_across_lines_and_literals(self):
        self.assertEqual([part for _, part in find_sentences('"the next item is let come "\n    "and seen"')], ["let come and"])


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
