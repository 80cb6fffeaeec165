"""Where this package keeps what is not Python (templates, comparisons, the live page), and files written whole."""

from pathlib import Path
from typing import Union

from aras_visual_servo import ArasError, ParameterError, package_path

#: File of a result folder with the whole scenario of a run in one process.
SCENARIO_FILE = "run.yaml"
#: Where Debian's libjs-three puts its files; a wheel has them in its own share.
THREE = Path("javascript") / "three"
#: Of three.js, what a page loads: the library, and what turns the view by mouse and finger.
THREE_FILES = ("three.min.js", "examples/js/controls/OrbitControls.js")


class ResultFolderError(ArasError):
    """The folder for the results cannot be made or written."""


def share_dir() -> Path:
    """Returns the folder with `config` and `web`: in the source tree, or PREFIX/share of the installed package."""
    return package_path("aras_visual_servo_study")  # type: ignore[return-value]


def three_file(name: str) -> Path:
    """Path of one of THREE_FILES. Raises ParameterError: libjs-three is not installed."""
    paths = [share / THREE / name for share in (share_dir().parent, Path("/usr/share"))]
    path = next(filter(Path.is_file, paths), paths[-1])
    if not path.is_file():
        raise ParameterError(f"three.js: no such file: {path}; on Debian: apt install libjs-three")
    return path


def write_whole(path: Path, content: Union[str, bytes]) -> Path:
    """Writes a whole file or none, so that none is left by half. Returns its path. Raises ResultFolderError."""
    partial = path.with_name(path.name + ".part")
    try:
        partial.write_bytes(content.encode() if isinstance(content, str) else content)
        partial.replace(path)
    except OSError as error:
        raise ResultFolderError(f"{path}: cannot be written: {error.strerror}") from error
    return path
