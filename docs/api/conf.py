"""Sphinx's settings for the API reference. Built by script/docs/api; warnings are errors there."""
import re

project = "ARAS Visual Servo"
extensions = ["sphinx.ext.autodoc"]
html_theme = "alabaster"
html_theme_options = {"description": "API reference, from the docstrings", "page_width": "1420px",
                      "body_max_width": "1180px"}
html_show_sourcelink = False
highlight_language = "none"   # blocks of docstrings are sentences and formulas
#: A page lists what stands on it. The list of all modules beside each would take a quarter of the time to build.
html_sidebars = {"**": ["about.html", "localtoc.html", "relations.html", "searchbox.html"]}
autodoc_default_options = {"members": True, "undoc-members": True, "ignore-module-all": True, "show-inheritance": True,
                           "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
#: What only PyPI has is not needed to read about it.
autodoc_mock_imports = ["gymnasium", "mcap", "h5py"]
SECTION = re.compile(r"\s*(Args|Returns|Raises|Attributes|References?|Yields)[^:]*:")
MARKUP = re.compile(r"([\\*_|`])")


def as_text(app, what, name, thing, options, lines):
    """Our docstrings are plain text with columns and formulas, not reStructuredText. Paragraphs stay paragraphs, with
    `names` set apart; what is indented, and what sections list, keeps its lines."""
    result, paragraph, block = [], [], []

    def flush():
        if paragraph:
            result.extend([_inline(" ".join(paragraph)), ""])
            paragraph.clear()
        if block:
            indent = min(len(line) - len(line.lstrip()) for line in block if line.strip())
            result.extend(["::", "", *("    " + line[indent:] for line in block), ""])
            block.clear()
    for line in lines:
        if not line.strip():
            if block:
                block.append("")
            else:
                flush()
        elif SECTION.match(line) or block or line.startswith(" "):
            if paragraph:
                flush()
            block.append(line)
        else:
            paragraph.append(line.strip())
    flush()
    lines[:] = result


def _inline(text):
    parts = re.split(r"``?([^`]+)``?", text)
    return "".join(f"``{part}``" + " " * (not re.match(r"[\s.,:;)\]]|$", parts[i + 1])) if i % 2 else
                   MARKUP.sub(r"\\\1", part) for i, part in enumerate(parts))


def setup(app):
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", as_text)
