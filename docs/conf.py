"""Sphinx's settings for the site of all pages. `script/docs` stages the pages and builds it; warnings are errors."""
import os
import re

project = "ARAS Visual Servo"
author = copyright = "ARAS Visual Servo developers"
release = version = os.environ["ARAS_VERSION"]
extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = f"{project} {release}"
html_static_path = ["_static"]
html_css_files = ["style.css"]
html_show_sourcelink = html_copy_source = False
html_use_index = False   # the search finds names faster than a list of thousands
highlight_language = "none"   # blocks without a language are output, formulas and sentences
suppress_warnings = ["misc.highlighting_failure"]   # lines with "..." are no program
myst_heading_anchors = 6
autodoc_default_options = {"members": True, "undoc-members": True, "ignore-module-all": True, "show-inheritance": True,
                           "member-order": "bysource"}
#: Thousands of names, copied into the navigation of every page, would double the time to build.
toc_object_entries = False
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
#: What only some programs need is not needed to read about them.
autodoc_mock_imports = ["gymnasium", "mcap", "h5py", "cv2", "distributed"]
SECTION = re.compile(r"\s*(Args|Returns|Raises|Attributes|References?|Yields):")
MARKUP = re.compile(r"([\\*_|`]|(?<=\w):(?=[^\s/]))")   # FILE:LINE is no address


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
        elif SECTION.match(line) or line.startswith(" ") or block and block[-1]:
            if paragraph:
                flush()
            block.append(line)
        else:
            if block:
                flush()
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
