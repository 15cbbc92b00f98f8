#!/usr/bin/env python3
"""build_site.py OUT: the documentation site, static pages with a search that works from disk: open OUT/index.html.

Copies the Markdown files of the tree, what they link to and their pictures into a folder of its own and runs Debian's Sphinx with
MyST on it (packages python3-sphinx, python3-myst-parser, furo). A warning of Sphinx, such as a link that leads nowhere, fails.

Two pages are made here: every verb with its options, as the built program prints them, and a gallery of the report pages that
`make demo` left in out/.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
from check_docs import LINK, prose_lines  # noqa: E402  # pylint: disable=wrong-import-position

SPHINX = "/usr/bin/sphinx-build"  # with the system's Python, whatever other is first on the path
PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "bench/README.md", "docs/**/*.md", "viewer/README.md", "src/snug/*/README.md", "scenarios/examples/README.md")
NORMALIZE = Path("/usr/share/javascript/normalize.css/normalize.css")
INDEX = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=docs/index.html"><a href="docs/index.html">snug</a>\n'


SNUG = Path(os.environ.get("SNUG", ROOT / "build" / "snug"))
DEMO = ROOT / "out"
SEQUENCES = range(1, 6)


def help_of(words):
    return subprocess.run([SNUG, *words, "--help"], capture_output=True, text=True, check=True).stdout


def parts_of(text):
    """Verbs, or parts of a verb, that a help text lists."""
    found = re.search(r"^(?:SUBCOMMANDS|Subcommands):\n(.*?)(?:\n\n|\Z)", text, re.S | re.M)
    return re.findall(r"^  (\w[\w-]*)", found.group(1), re.M) if found else []


def options_page():
    """Every verb with its options: what the program prints, so that it is what the program takes."""
    lines = ["# Verbs and their options", "", "What `snug VERB --help` prints, of the program that was built with these pages.", ""]
    for verb in parts_of(help_of([])):
        text = help_of([verb])
        for words, said in [([verb], text), *(([verb, part], help_of([verb, part])) for part in parts_of(text))]:
            lines += [f"{'#' * (1 + len(words))} snug {' '.join(words)}", "", "```text", said.rstrip(), "```", ""]
    return "\n".join(lines)


def gallery_page():
    """The report pages of `make demo`, to click."""
    lines = ["# Gallery", ""]
    shown = [n for n in SEQUENCES if (DEMO / f"sequence-{n}.html").exists()]
    if not shown:
        return "\n".join([*lines, "`make demo` packs the five sequences of the report; `make docs` then shows their report pages here.", ""])
    lines += ["The five sequences of the report as `make demo` packed them. Each link opens a report page: replay in 3D, events of every box, plots.", ""]
    for n in shown:
        lines += [f'- <a href="../gallery/sequence-{n}.html">Sequence {n}</a> ({(DEMO / f"sequence-{n}.html").stat().st_size / 1e6:.1f} MB)']
    return "\n".join([*lines, "", "![Sequence 2 packed, from above](img/packed-sequence-2.png)", ""])


def copy_gallery(out):
    for page in DEMO.glob("sequence-*.html"):
        (out / "gallery").mkdir(parents=True, exist_ok=True)
        shutil.copyfile(page, out / "gallery" / page.name)


def pages():
    return sorted({path for pattern in PAGES for path in ROOT.glob(pattern)})


def linked_files(page):
    """Files of the tree, no pages, that a page links to."""
    for _, line in prose_lines(page):
        for target in LINK.findall(line):
            if re.match(r"[a-z][a-z0-9+.-]*:", target):
                continue
            file = (page.parent / unquote(target.partition("#")[0])).resolve()
            if file.is_file() and file.suffix != ".md" and ROOT in file.parents:
                yield file


def copy(file, folder):
    place = folder / file.relative_to(ROOT)
    place.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(file, place)


def version():
    return re.search(r"project\(snug[^)]*VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.S).group(1)


def mend_theme(static):
    """Debian's furo imports a style from the root of a web server, and a script as a module: neither is found from disk."""
    style = static / "styles" / "furo.css"
    style.write_text(re.sub(r"@import url\(/javascript/[^)]*\);", lambda _: NORMALIZE.read_text(), style.read_text()))
    script, module = static / "scripts" / "furo.js", static / "scripts" / "gumshoe-patched.js"
    text, count = re.subn(r'^import Gumshoe from "[^"]*";\n', "", script.read_text())
    if count:
        script.write_text(module.read_text() + text)


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if not Path(SPHINX).exists():
        print("build_site.py: no sphinx-build: run scripts/install-deps.sh docs", file=sys.stderr)
        return 1
    if not SNUG.exists():
        print(f"build_site.py: no program '{SNUG}': run make build", file=sys.stderr)
        return 1
    out = Path(arguments[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        source = Path(name) / "source"
        for page in pages():
            for file in (page, *linked_files(page)):
                copy(file, source)
        shutil.copyfile(ROOT / "docs" / "site" / "conf.py", source / "conf.py")
        (source / "docs" / "options.md").write_text(options_page(), encoding="utf-8")
        (source / "docs" / "gallery.md").write_text(gallery_page(), encoding="utf-8")
        words = [SPHINX, "-q", "-W", "--keep-going", "-b", "html", "-d", str(Path(name) / "doctrees"), str(source), str(out)]
        result = subprocess.run(words, check=False, env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "SNUG_SITE_VERSION": version()})
        if result.returncode != 0:
            return result.returncode
    copy_gallery(out)
    mend_theme(out / "_static")
    (out / "index.html").write_text(INDEX)
    print(f"{len(pages())} pages: {out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
