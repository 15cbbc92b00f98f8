#!/usr/bin/env python3
"""build_site.py OUT: the documentation site, static pages with a search that works from disk: open OUT/index.html.

Copies the Markdown files of the tree, what they link to and their pictures into a folder of its own and runs Debian's Sphinx with
MyST on it (packages python3-sphinx, python3-myst-parser, furo). A warning of Sphinx, such as a link that leads nowhere, fails.
"""
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
PAGES = ("README.md", "CHANGELOG.md", "docs/**/*.md", "viewer/README.md", "src/snug/*/README.md", "scenarios/examples/README.md")
NORMALIZE = Path("/usr/share/javascript/normalize.css/normalize.css")
INDEX = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=docs/index.html"><a href="docs/index.html">snug</a>\n'


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
    out = Path(arguments[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        source = Path(name) / "source"
        for page in pages():
            for file in (page, *linked_files(page)):
                copy(file, source)
        shutil.copyfile(ROOT / "docs" / "site" / "conf.py", source / "conf.py")
        words = [SPHINX, "-q", "-W", "--keep-going", "-b", "html", "-d", str(Path(name) / "doctrees"), str(source), str(out)]
        result = subprocess.run(words, check=False, env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "SNUG_SITE_VERSION": version()})
        if result.returncode != 0:
            return result.returncode
    mend_theme(out / "_static")
    (out / "index.html").write_text(INDEX)
    print(f"{len(pages())} pages: {out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
