"""Files that a page is made of: this package's `web` folder, and three.js as Debian ships it."""

from pathlib import Path

from ...files import share_dir
from aras_visual_servo import ParameterError

#: Where Debian's libjs-three puts its files.
THREE = Path("/usr/share/javascript/three")
#: Of three.js, what a page loads: the library, and what turns the view by mouse and finger.
THREE_FILES = ("three.min.js", "examples/js/controls/OrbitControls.js")


def web_dir() -> Path:
    """Folder of the pages' own files."""
    return share_dir() / "web"


def three_file(name: str) -> Path:
    """Path of one of THREE_FILES. Raises ParameterError: libjs-three is not installed."""
    path = THREE / name
    if not path.is_file():
        raise ParameterError(f"three.js: no such file: {path}; on Debian: apt install libjs-three")
    return path
