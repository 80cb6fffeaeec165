"""The word `robot check`: everything that a URDF lacks for visual servoing."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from . import EXIT_FAILED, EXIT_PASSED, Command, file
from ..ground.errors import ParameterError


def add_urdf(parser: ArgumentParser) -> None:
    """Adds URDF, --tip and --camera."""
    parser.add_argument("urdf", metavar="URDF", type=file, help="path of the robot's URDF; expand xacro first")
    parser.add_argument("--tip", required=True, metavar="LINK", help="the arm's flange, which carries the camera")
    parser.add_argument("--camera", default="camera_optical_frame", metavar="LINK",
                        help="optical frame of the camera: z along the view, x to the right of the image (default: "
                             "camera_optical_frame)")


def text_of(path: str) -> str:
    """Returns the text of a URDF. Raises ParameterError: it cannot be read."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ParameterError(f"URDF: found {path}, allowed a file of text: {error}") from error


def _work(arguments: Namespace) -> int:
    from ..arm.urdf_check import shortcomings
    faults = shortcomings(text_of(arguments.urdf), arguments.tip, arguments.camera, Path(arguments.urdf).parent)
    print("\n".join(f"{arguments.urdf}: {fault}" for fault in faults or ["ok"]))
    return EXIT_FAILED if faults else EXIT_PASSED


COMMAND = Command("Print everything that a URDF lacks: limits, inertias, meshes, the camera's frame, a home that is "
                  "not singular.", [("my_arm.urdf --tip flange --camera camera_optical_frame", "an arm of your own")],
                  add_urdf, _work)
