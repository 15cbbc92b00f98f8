"""Settings of the documentation site: Sphinx reads the Markdown that is on GitHub too. Run by tools/build_site.py (`make docs`)."""
import os

project = "snug"
author = "the snug project"
version = os.environ.get("SNUG_SITE_VERSION", "")
extensions = ["myst_parser"]
root_doc = "docs/index"
source_suffix = {".md": "markdown"}
myst_heading_anchors = 4  # links to headings as GitHub makes them
html_theme = "furo"
html_title = f"snug {version}".strip()
html_theme_options = {"navigation_with_keys": True}
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
# Headings may begin below the first level in module READMEs.
suppress_warnings = ["myst.header"]


def setup(app):
    """Diagrams of a language that the highlighter does not know stand as they are written."""
    from pygments.lexers.special import TextLexer  # pylint: disable=import-outside-toplevel

    for language in ("mermaid", "csv"):
        app.add_lexer(language, TextLexer)
