"""Builds the site of all pages and of the Python API reference. Run by script/docs and by debian/rules.

docs/index.md lists the pages by reader: each heading of it becomes a part of the site's navigation. A page keeps its
links to other files of the repository: links to pages lead to pages, links to other files to copies of them.
"""
import os
import re
import shutil
import sys
import urllib.parse
from collections import Counter
from pathlib import Path
from typing import Dict, Iterator, List, Tuple
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
INDEX = ROOT / "docs" / "index.md"
#: Packages whose modules have pages, and those that are compiled, of which only what they export is there.
PACKAGES = ("aras_visual_servo", "aras_visual_servo_controller", "aras_visual_servo_study",
            "aras_visual_servo_learning")
COMPILED = ("aras_visual_servo_common", "aras_visual_servo_sim", "aras_visual_servo_camera")
CODE = re.compile(r"^(`{3,}|~{3,}).*?^\1[`~]*$|(?<!`)(`+)(?!`).+?(?<!`)\2(?!`)", re.DOTALL | re.MULTILINE)
PICTURE = re.compile(r'(<img [^>]*?src=")([^"]+)(")')
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^()\s]+)\)")
HEADING = re.compile(r"^#{1,6} +(.*?)[ #]*$", re.MULTILINE)
TAG = re.compile(r"(?<!\\)</?(?!(?:a|br|details|img|kbd|sub|summary|sup)\b)[A-Za-z][\w-]*[^<>]*>")
ATTRIBUTE = re.compile(r'\s(href|src)="([^"]*)"|\sid="([^"]*)"')
PUBLIC = """Public API
==========

.. automodule:: aras_visual_servo
   :imported-members:
   :no-ignore-module-all:
   :noindex:
   :member-order: alphabetical
"""


class Broken(Exception):
    """Links that lead nowhere or pages that no list has, one a line."""


def pages(root: Path = ROOT) -> Dict[Path, str]:
    """Returns {file: name in the site} of the pages. Names have no suffix."""
    docs = root / "docs"
    found = {path: str(path.relative_to(docs).with_suffix("")) for path in sorted(docs.rglob("*.md"))}
    found.update({path: f"packages/{path.parent.name}" for path in sorted((root / "src").glob("*/README.md"))})
    found.update({path: f"project/{path.stem.lower()}" for path in sorted(root.glob("*.md"))})
    return {**found, docs / "api" / "index.rst": "api/index"}


def without_code(text: str) -> str:
    """Returns a page's text with blanks in place of its code: no link and no heading stands there."""
    return CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def links(text: str) -> Iterator[Tuple[re.Match, str, str]]:
    """Yields (match, path, anchor) of every link of a page into the repository; the path of one into the page is ""."""
    bare = without_code(text)
    for match in LINK.finditer(text):
        in_code = bare[match.end() - 2] != text[match.end() - 2]
        if not in_code and not re.match(r"[a-z]+:", match[3]):
            path, _, anchor = match[3].partition("#")
            yield match, urllib.parse.unquote(path), anchor


def anchors(text: str) -> set:
    """Returns the anchors of a page's headings, as code hosts make them."""
    fences = re.sub(r"^(`{3,}|~{3,}).*?^\1[`~]*$", "", text, flags=re.DOTALL | re.MULTILINE)
    seen: Counter = Counter()
    found = set(re.findall(r'<a (?:id|name)="([^"]+)"', fences))
    for title in HEADING.findall(fences):
        slug = re.sub(r"[^\w\- ]", "", LINK.sub(r"\2", title).strip().lower()).replace(" ", "-")
        found.add(f"{slug}-{seen[slug]}" if seen[slug] else slug)
        seen[slug] += 1
    return found


def link_faults(files: List[Path], root: Path = ROOT) -> List[str]:
    """Returns a line for each link of these Markdown files to a file or heading that does not exist.

    Words such as <name> outside code are faults too: a browser takes them for a tag and hides them.
    """
    faults, known = [], {}
    for page in files:
        text = page.read_text(encoding="utf-8")
        for tag in TAG.finditer(without_code(text)):
            line = text.count("\n", 0, tag.start()) + 1
            faults.append(f"{page.relative_to(root)}:{line}: found {tag[0]}, allowed `{tag[0]}` or \\{tag[0]}")
        for match, path, anchor in links(text):
            target = page if not path else Path(os.path.normpath(page.parent / path))
            where = f"{page.relative_to(root)}:{text.count(chr(10), 0, match.start()) + 1}: found {match[3]}, "
            if not target.exists() or root not in (target, *target.parents):
                faults.append(where + "allowed a file of this repository")
            elif anchor and target.suffix == ".md":
                if target not in known:
                    known[target] = anchors(target.read_text(encoding="utf-8"))
                if anchor not in known[target]:
                    faults.append(where + f"allowed {', '.join(sorted('#' + name for name in known[target]))}")
    return faults


def parts(root: Path = ROOT) -> Dict[str, List[Tuple[str, str]]]:
    """Returns {heading of docs/index.md: [(title, name in the site)]}.

    Raises: Broken: a page is not listed, or is listed twice.
    """
    names, found, folder = pages(root), {}, root / "docs"
    text = (root / "docs" / "index.md").read_text(encoding="utf-8")
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        heading, _, body = section.partition("\n")
        entries = re.findall(r"^- \[([^\]]*)\]\(([^)]*)\)", body, re.MULTILINE)
        files = [(title, Path(os.path.normpath(folder / path))) for title, path in entries]
        found[heading.strip()] = [(title, names[file]) for title, file in files if file in names]
    listed = Counter(name for entries in found.values() for _, name in entries)
    faults = [f"docs/index.md: found {listed[name]} lines for {path.relative_to(root)}, allowed one: "
              "'- [title](path): text'" for path, name in names.items() if name != "index" and listed[name] != 1]
    if faults:
        raise Broken("\n".join(faults))
    return found


def in_site(file: Path, root: Path = ROOT) -> str:
    """Returns where the copy of a file that is no page stands in the site."""
    return str(file.relative_to(root / "docs" if root / "docs" in file.parents else root))


def staged(page: Path, names: Dict[Path, str], copies: Dict[Path, str], root: Path = ROOT) -> str:
    """Returns a page's text with its links as the site has them. Adds {file: name in the site} of what it needs."""
    text, at, result = page.read_text(encoding="utf-8"), 0, []
    folder = os.path.dirname(names[page])
    for match, path, anchor in links(text):
        if not path:
            continue
        target = Path(os.path.normpath(page.parent / path))
        target = target / "README.md" if target / "README.md" in names else target
        if target.is_dir():
            new = match[2]
        else:
            if target not in names:
                copies[target] = in_site(target, root)
            name = f"{names[target]}{target.suffix}" if target in names else copies[target]
            new = f"{match[1]}[{match[2]}]({os.path.relpath(name, folder or '.')}{'#' * bool(anchor)}{anchor})"
        result += [text[at:match.start()], new]
        at = match.end()

    def picture(match: re.Match) -> str:
        file = Path(os.path.normpath(page.parent / match[2]))
        copies[file] = name = f"_static/{in_site(file, root)}"  # Sphinx copies pictures of HTML from nowhere else
        return f"{match[1]}{os.path.relpath(name, folder or '.')}{match[3]}"

    return PICTURE.sub(picture, "".join([*result, text[at:]]))


def stage(source: Path, root: Path = ROOT) -> None:
    """Writes what Sphinx reads. Raises Broken."""
    names, copies = pages(root), {}
    faults = link_faults([path for path in names if path.suffix == ".md"], root)
    if faults:
        raise Broken("\n".join(faults))
    contents = parts(root)
    for page, name in names.items():
        file = source / f"{name}{page.suffix}"
        file.parent.mkdir(parents=True, exist_ok=True)
        text = staged(page, names, copies, root) if page.suffix == ".md" else page.read_text(encoding="utf-8")
        if name == "index":
            for heading, entries in contents.items():
                lines = [f"{title} <{entry}>" for title, entry in entries]
                text += "\n".join(["\n```{toctree}", ":hidden:", f":caption: {heading}", "", *lines, "```", ""])
        file.write_text(text, encoding="utf-8")
    for file, name in copies.items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, source / name)
    (source / "_static").mkdir(exist_ok=True)
    shutil.copy(root / "docs" / "style.css", source / "_static")
    shutil.copy(root / "docs" / "conf.py", source)


def stage_api(folder: Path) -> None:
    """Writes the pages of the Python packages, which Sphinx fills from the docstrings."""
    from sphinx.ext import apidoc

    for package in PACKAGES:
        # The side of the relay that runs in ROS 2's Python cannot be imported here.
        modules = ROOT / "src" / package / "src" / package
        apidoc.main(["-q", "--module-first", "--no-toc", "-o", str(folder), str(modules), "*/ros2/door.py"])
    (folder / "public.rst").write_text(PUBLIC, encoding="utf-8")
    import aras_visual_servo_common

    errors = ", ".join(aras_visual_servo_common.__all__)  # all packages raise them; they stand on the page of common
    for package in COMPILED:
        lines = [package, "=" * len(package), "", f".. automodule:: {package}"]
        if package != COMPILED[0]:
            lines += ["   :imported-members:", f"   :exclude-members: {errors}"]
        (folder / f"{package}.rst").write_text("\n".join([*lines, ""]), encoding="utf-8")


def site_faults(site: Path) -> List[str]:
    """Returns a line for each link, picture or anchor of the built pages that leads nowhere in the site."""
    ids, targets, faults = {}, {}, []
    for page in sorted(site.rglob("*.html")):
        found = ATTRIBUTE.findall(page.read_text(encoding="utf-8"))
        ids[page] = {name for _, _, name in found if name}
        targets[page] = {target for kind, target, _ in found if kind and not re.match(r"[a-z]+:|//", target)}
    for page, wanted in targets.items():
        for target in sorted(wanted):
            path, _, anchor = urllib.parse.unquote(target).partition("#")
            file = page if not path else Path(os.path.normpath(page.parent / path.partition("?")[0]))
            if not file.is_file() or anchor and file in ids and anchor not in ids[file]:
                faults.append(f"{page.relative_to(site)}: found a link to {target}, which the site lacks")
    return faults


def build(folder: Path) -> Path:
    """Builds the site. Returns its first page.

    Raises: Broken: a link leads nowhere, a page is not listed, or Sphinx warns.
    """
    from sphinx.cmd.build import main as sphinx

    shutil.rmtree(folder, ignore_errors=True)
    source, site = folder / "source", folder / "html"
    (source / "api").mkdir(parents=True)
    stage(source)
    stage_api(source / "api")
    os.environ["ARAS_VERSION"] = ElementTree.parse(ROOT / "src/aras_visual_servo/package.xml").findtext("version") or ""
    if sphinx(["-q", "-W", "--keep-going", "-b", "html", "-d", str(folder / "doctrees"), str(source), str(site)]):
        raise Broken("Sphinx warned, see above")
    faults = site_faults(site)
    if faults:
        raise Broken("\n".join(faults))
    return site / "index.html"


if __name__ == "__main__":
    try:
        print(build(Path(sys.argv[1]).resolve()))
    except Broken as error:
        print(error, file=sys.stderr)
        sys.exit(1)
