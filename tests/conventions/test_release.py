"""What a release needs: one version, valid metadata, a bill of materials, pinned actions, links that lead somewhere."""
import importlib.machinery
import importlib.util
import pathlib
import re
import shutil
import sys

import pytest

import aras_visual_servo as avs
from aras_visual_servo.cli.main import main
from aras_visual_servo.config.files import package_version

ROOT = pathlib.Path(__file__).resolve().parents[2]


def script(name):
    """A program of script/ as a module."""
    loader = importlib.machinery.SourceFileLoader(f"script_{name.partition('.')[0]}", str(ROOT / "script" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = written
    return module


release, sbom, site, wheel = script("release"), script("sbom"), script("site.py"), script("wheel_backend.py")
VERSION = release.version_of()


@pytest.mark.parametrize("check", release.ALWAYS, ids=lambda check: check.__name__)
def test_it_holds_for_every_commit(check):
    assert check(ROOT) == []


def test_programs_state_the_version_of_package_xml(capsys):
    assert avs.__version__ == wheel.project()["version"] == VERSION
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out.split() == ["aras-servo", VERSION]


@pytest.mark.parametrize("text, version", [("<package><version> 1.2.3 </version></package>", "1.2.3"),
                                           ("<package/>", "unknown"), ("<package>", "unknown"), (None, "unknown")])
def test_the_version_of_a_package_is_that_of_its_file(tmp_path, text, version):
    if text is not None:
        (tmp_path / "package.xml").write_text(text)
    assert package_version(tmp_path / "package.xml") == version


@pytest.fixture
def copy(tmp_path):
    """A copy of the files that the checks of a release read, without git."""
    for path in [*release.manifests(ROOT), *release.REQUIRED, *map(str, (ROOT / ".github").rglob("*.yml"))]:
        target = tmp_path / pathlib.Path(path).relative_to(ROOT) if path.startswith("/") else tmp_path / path
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, target)
    return tmp_path


#: check -> (file, what stands there, what takes its place, what a fault names)
BROKEN = [
    ("versions", "gazebo/xacro/package.xml", f"<version>{VERSION}", "<version>0.9.9", "gazebo/xacro/package.xml"),
    ("versions", release.SOURCE, f"<version>{VERSION}", "<version>1.0", "MAJOR.MINOR.PATCH"),
    ("versions", "CITATION.cff", f"\nversion: {VERSION}", "\nversion: 0.9.9", "CITATION.cff"),
    ("metadata", "src/aras_visual_servo_msgs/package.xml", "BSD-3-Clause", "GPL", "license 'GPL'"),
    ("files", "SECURITY.md", None, "", "SECURITY.md"),
    ("citation", "CITATION.cff", "type: software", "typ: software", "'typ'"),
    ("citation", "CITATION.cff", "date-released: 20", "date-released: 2", "date-released"),
    ("citation", "CITATION.cff", "authors:\n  - name", "authors:\n  - nam", "authors.0"),
    ("paper", "paper/paper.md", "# State of the field", "# Others", "State of the field"),
    ("paper", "paper/paper.md", "@gans2003", "@gans2004", "gans2004"),
    ("paper", "paper/paper.bib", "doi = {10.1109/MRA.2006.250573}", "", "chaumette2006"),
    ("workflows", ".github/workflows/ci.yml", "permissions:\n  contents: read\njobs", "jobs", "permissions"),
    ("workflows", ".github/workflows/ci.yml", "@3d3c42e5aac5ba805825da76410c181273ba90b1  # v7.0.1", "@v7", "@v7"),
    ("workflows", ".github/workflows/ci.yml", "    permissions:\n      contents: read\n    strategy", "    strategy",
     "job debian")]


@pytest.mark.parametrize("check, file, there, instead, named", BROKEN, ids=lambda value: str(value)[:30])
def test_a_check_names_what_is_wrong(copy, check, file, there, instead, named):
    text = (copy / file).read_text()
    assert getattr(release, check)(copy) == [] and (there is None or there in text)
    (copy / file).write_text("" if there is None else text.replace(there, instead, 1))
    faults = getattr(release, check)(copy)
    assert faults and any(named in fault for fault in faults), faults


def test_the_version_is_set_everywhere_and_a_release_needs_its_section_of_the_changelog(copy):
    release.set_version("12.3.4", copy)
    assert release.versions(copy) == release.citation(copy) == [] and release.version_of(copy) == "12.3.4"
    assert "12.3.4" in release.changelog(copy)[0]
    day = re.search(r"date-released: (\S+)", (copy / "CITATION.cff").read_text())[1]
    (copy / "CHANGELOG.md").write_text(f"# Changelog\n\n## 12.3.4 - {day}\n\n## {VERSION} - 2026-01-01\n")
    assert release.changelog(copy) == []
    with pytest.raises(ValueError, match="1.2"):
        release.set_version("1.2", copy)


def test_the_bill_of_materials_names_what_runs_with_its_version():
    there = {"libbullet-dev": {"version": "3.24+dfsg-2", "arch": "amd64"}}
    made = sbom.bill(ROOT, "12", there, "c0ffee", 86400)
    assert made == sbom.bill(ROOT, "12", there, "c0ffee", 86400) != sbom.bill(ROOT, "12", {}, "c0ffee", 86400)
    assert (made["bomFormat"], made["specVersion"], made["metadata"]["timestamp"]) == \
        ("CycloneDX", "1.5", "1970-01-02T00:00:00Z")
    assert re.fullmatch(r"urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", made["serialNumber"])
    components = {each["name"]: each for each in made["components"]}
    references = [each["bom-ref"] for each in made["components"]]
    assert len(set(references)) == len(references) > 150 and references == sorted(references)
    assert all(each["scope"] in ("required", "optional", "excluded") for each in made["components"])
    bullet = components["libbullet-dev"]
    assert bullet["purl"] == "pkg:deb/debian/libbullet-dev@3.24%2Bdfsg-2?arch=amd64&distro=debian-12"
    assert bullet["scope"] == "required" and bullet["bom-ref"] in made["dependencies"][0]["dependsOn"]
    assert components["cmake"]["scope"] == "excluded" and "version" not in components["cmake"]
    assert components["ffmpeg"]["scope"] == "optional" and "libclang-rt-19-dev" not in components
    xacro = components["xacro"]
    assert xacro["purl"] == "pkg:pypi/xacro@2.1.1" and xacro["hashes"][0]["alg"] == "SHA-256"


PAGE = """# A title: `code` & (more)
## Again
## Again
A [page](other.md#part-two), a [gone](gone.md), [nothing](other.md#none), [here](#again-1), ![a picture](a.png),
`[code](no.md)` and [a folder](../folder), <a id="own"></a> [own](#own).
```
[fence](no.md)
# no heading
```
"""


@pytest.fixture
def pages(tmp_path):
    """A repository of a few pages."""
    index = "# I\n## T\n- [P](page.md): p\n- [O](other.md): o\n- [A](api/index.rst): a\n"
    for path, text in {"docs/page.md": PAGE, "docs/other.md": "# Other\n## Part two\n", "docs/a.png": "",
                       "folder/file.txt": "", "docs/api/index.rst": "", "docs/index.md": index}.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def test_links_and_anchors_of_a_page_are_those_that_code_hosts_show(pages):
    assert site.anchors(PAGE) == {"a-title-code--more", "again", "again-1", "own"}
    faults = site.link_faults([pages / "docs" / "page.md"], pages)
    assert [fault.split(": ")[0] for fault in faults] == ["docs/page.md:4"] * 2
    assert "gone.md" in faults[0] and "#none" in faults[1] and "#part-two" in faults[1]


def test_words_that_a_browser_takes_for_a_tag_are_named(pages):
    (pages / "docs" / "other.md").write_text("# Other\n`<code>` \\<name> <img src='a.png'>\n<name>/image\n")
    faults = site.link_faults([pages / "docs" / "other.md"], pages)
    assert len(faults) == 1 and faults[0].startswith("docs/other.md:3: found <name>")


def test_a_page_is_staged_with_the_links_of_the_site(pages):
    (pages / "README.md").write_text("See [the page](docs/page.md#again) in [a file](folder/file.txt) of [it](folder).")
    copies = {}
    text = site.staged(pages / "README.md", site.pages(pages), copies, pages)
    assert text == "See [the page](../page.md#again) in [a file](../folder/file.txt) of it."
    assert copies == {pages / "folder" / "file.txt": "folder/file.txt"}


def test_a_page_that_no_list_has_is_named(pages):
    assert site.parts(pages) == {"T": [("P", "page"), ("O", "other"), ("A", "api/index")]}
    (pages / "docs" / "new.md").write_text("# New\n")
    with pytest.raises(site.Broken, match="docs/new.md"):
        site.parts(pages)


def test_every_page_of_the_repository_is_listed_by_reader():
    parts = site.parts()
    assert list(parts)[:4] == ["Tutorials", "How-to guides", "Reference", "Explanation"] and all(parts.values())


def test_a_built_page_with_a_broken_link_is_named(tmp_path):
    (tmp_path / "a.html").write_text('<p id="x"><a href="b.html#y"></a><a href="#x"></a><img src="no.png"></p>')
    (tmp_path / "b.html").write_text('<a href="a.html#x"></a><a href="https://example.org/none"></a>')
    faults = site.site_faults(tmp_path)
    assert len(faults) == 2 and " b.html#y," in faults[0] and " no.png," in faults[1]
