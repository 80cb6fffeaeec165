"""Section `sweep` of a scenario: variations of a sweep of many runs (docs/sweeps.md)."""

from dataclasses import dataclass
from math import pi
from typing import Any, Dict, Optional, Tuple

from ..config.settings import keys_of, setting

METHODS = ("latin_hypercube", "grid", "random")
SPACES = ("camera", "joint", "ball", "view")
#: Half the width of the ranges of the joints about the goal if the scenario does not say [m, rad].
JOINT_HALF_WIDTH = 0.2
Range = Tuple[float, ...]
RANGE: Dict[str, Any] = {"size": 2, "condition": ("[low, high] with low <= high", lambda ends: ends[0] <= ends[1])}


class _Ranges:
    """Ranges [low, high] by axis; None: that axis stays where it is at the goal."""

    def as_dict(self):
        """Returns axis -> (low, high) of the varying axes."""
        values = {key.name: getattr(self, key.name) for key in keys_of(type(self))}
        return {axis: ends for axis, ends in values.items() if ends is not None}


@dataclass(frozen=True)
class CameraRanges(_Ranges):
    """Section `sweep.camera`: displacement along the axes of the goal camera, and its rotation vector."""

    x_m: Optional[Range] = setting(None, **RANGE, unit="m", help="To the right in the image at the goal.")
    y_m: Optional[Range] = setting(None, **RANGE, unit="m", help="Down in the image at the goal.")
    z_m: Optional[Range] = setting(None, **RANGE, unit="m", help="Along the view; negative ones are further away.")
    rx_rad: Optional[Range] = setting(None, **RANGE, unit="rad", help="Rotation about x.")
    ry_rad: Optional[Range] = setting(None, **RANGE, unit="rad", help="Rotation about y.")
    rz_rad: Optional[Range] = setting(None, **RANGE, unit="rad", help="Rotation about z, the optical axis.")


@dataclass(frozen=True)
class BallRanges(_Ranges):
    """Section `sweep.ball`: within a distance and an angle of the goal, uniformly in both balls."""

    distance_m: Range = setting((0.0, 0.2), **RANGE, unit="m", at_least=0, help="Distance from the goal.")
    angle_rad: Range = setting(
        (0.0, pi / 6.0), **RANGE, unit="rad", at_least=0, below=3.14159,
        help="Angle of the rotation from the goal.")


@dataclass(frozen=True)
class ViewRanges(_Ranges):
    """Section `sweep.view`: place of the target in the image, and its distance."""

    u: Range = setting(
        (-1.0, 1.0), **RANGE, at_least=-1, at_most=1,
        help="Along the rows of the image: -1 touches the left border, 1 the right one.")
    v: Range = setting(
        (-1.0, 1.0), **RANGE, at_least=-1, at_most=1,
        help="Along the columns of the image: -1 touches the upper border, 1 the lower one.")
    depth_m: Range = setting((0.4, 0.6), **RANGE, unit="m", above=0, help="Distance of the target along the view.")
    rz_rad: Range = setting(
        (-pi, pi), **RANGE, unit="rad", at_least=-3.1416, at_most=3.1416,
        help="Rotation of the camera about its optical axis.")


@dataclass(frozen=True)
class GoalRanges(_Ranges):
    """Section `sweep.goal`: the goal camera on a sphere about the target, which it keeps in its place of the image."""

    tilt_rad: Optional[Range] = setting(
        None, **RANGE, unit="rad", at_least=0, below=1.5707,
        help="By how much the goal is tilted.")
    about_rad: Optional[Range] = setting(
        None, **RANGE, unit="rad",
        help="About which axis of the image plane it is tilted; 0: x.")


CAMERA_AXES, BALL_AXES, GOAL_AXES = (tuple(key.name for key in keys_of(ranges))
                                     for ranges in (CameraRanges, BallRanges, GoalRanges))


@dataclass(frozen=True)
class SweepSection:
    """Section `sweep`: every key may be left out, and the command line goes first."""

    starts: int = setting(100, at_least=1, at_most=1000000, help="Number of runs.")
    method: str = setting(
        "latin_hypercube", choices=METHODS,
        help="How starts are drawn; a grid has the cell centres of the largest one that fits.")
    space: str = setting("camera", choices=SPACES, help="What is drawn: see the table of spaces.")
    seed: int = setting(0, at_least=0, help="Seed of all that is drawn.")
    drive_to_start: bool = setting(False, help="The arm is driven to goal and start as `run` does, not placed there.")
    abort_factor: Optional[float] = setting(
        None, above=1,
        help="A run has failed once the camera is farther from the goal than this many times its distance at the "
             "start. Without: no distance is too far.")
    camera: CameraRanges = setting(
        CameraRanges((-0.15, 0.15), (-0.2, 0.2), (-0.2, -0.03), rz_rad=(-0.7, 0.7)), not_empty=True,
        help="Ranges of space `camera`; an axis that is left out stays at the goal.")
    ball: BallRanges = setting(BallRanges(), not_empty=True, help="Ranges of space `ball`.")
    view: ViewRanges = setting(ViewRanges(), not_empty=True, help="Ranges of space `view`.")
    joints: Optional[Dict[str, Range]] = setting(
        None, **RANGE, unit="m, rad", by="joint", not_empty=True,
        help="Ranges of space `joint` by the names of the joints, e.g. `{gantry: [-0.2, 0.2]}`; the others stay at the "
             f"goal. Without: {JOINT_HALF_WIDTH} to either side of the goal, for all of them.")
    goal: Optional[GoalRanges] = setting(
        None, not_empty=True,
        help="Every run has a goal of its own; `servo.target_normal_C` follows. Without: the scenario's goal.")
    perturb: Dict[str, object] = setting(
        {},
        help="What else varies: a name of the table of perturbations, or the dotted path of a value, with its range "
             "`[low, high]` or `{values: [...]}`.")


@dataclass(frozen=True)
class Perturbations:
    """Section `sweep.perturb`: named perturbations; other values have a path."""

    z_star_error: object = setting(
        None, at_least=-0.95,
        help="Relative error of the depth estimate: z_star_m times 1 + value.")
    pid_gain_scale: object = setting(None, at_least=0, help="Factor on p, i and d of every joint controller.")
    friction_scale: object = setting(None, at_least=0, help="Factor on the dry friction of every joint.")
    damping_scale: object = setting(None, at_least=0, help="Factor on the viscous damping of every joint.")
    noise_stddev: object = setting(None, at_least=0, help="Noise of every camera, in grey levels.")
    focal_error: object = setting(
        None, at_least=-0.9,
        help="Relative error of the focal length that the moments are computed with.")
    principal_point_error_px: object = setting(
        None, unit="px", at_least=-1000,
        help="Error of the principal point that they are computed with, in u and in v.")
    latency_images: object = setting(
        None, at_least=0,
        help="Images by which every image is delivered late, rounded down: added to the cameras' latency_s.")
    latency_s: object = setting(
        None, unit="s", at_least=0,
        help="By how much later every image is delivered: added to the cameras' latency_s.")
    target: object = setting(None, help="Shape: name of a file of aras_description/targets, or its URI.")
    picture: object = setting(
        None, help="File of a picture that takes the place of the target's when the goal has been taught.")
    clutter: object = setting(
        None, help="YAML file of `solids` and `lights` that come into the scene when the goal has been taught.")
    scene: object = setting(
        None, help="YAML file of `solids` and `lights` that come into the scene before the goal is taught.")
    target_scale: object = setting(
        None, at_least=0.01,
        help="Factor on the size of every model of the scene that has outlines or an image.")
