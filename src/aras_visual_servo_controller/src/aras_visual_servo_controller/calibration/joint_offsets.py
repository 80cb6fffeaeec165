"""Offsets of the joints together with the camera's place on the arm, from views of a board that rests.

A joint reports its position from a zero of its own. An offset turns everything beyond the joint, which no place of the
camera explains. The offsets are fitted with X_FC and X_BO to the pixels of all views. Each has a prior standard
deviation, so that an offset which the views do not tell stays at zero. That of the first joint about a fixed axis is
one with X_BO, and that of the last one with X_FC.
"""

from dataclasses import dataclass
from typing import Dict, Optional, Sequence, Tuple

import numpy as np

from aras_visual_servo import ParameterError, RobotKinematics
from .boards import Board
from .camera_model import CameraCalibration
from .family import CALIBRATIONS, Calibrated, Request, Value
from .hand_eye import LEAST_VIEWS, HandEye, check_turns, first_guess, fit_chain, hand_eye_result, hand_eye_section
from .samples import FILES, ArmSamples

#: Standard deviation of an offset before the fit [m or rad]; offsets are rarely larger than a few degrees.
PRIOR = 0.05
#: An offset is told if its standard deviation after the fit is below this part of PRIOR.
TOLD = 0.2
#: Each joint must move by this [m or rad].
LEAST_MOTION = 0.1


@dataclass(frozen=True)
class JointOffsets:
    """Attributes:
        hand_eye: `HandEye` with these offsets.  offsets: joint -> (true minus reported position, standard deviation)
        [m or rad], of those that the views tell.  unknown: joints whose offsets they do not tell, taken as zero.
    """

    hand_eye: HandEye
    offsets: Dict[str, Tuple[float, float]]
    unknown: Tuple[str, ...]


@CALIBRATIONS.register("joint_offsets", about="offsets of the joints together with the camera's place, for "
                       "robot.joint_offsets and robot.hand_eye",
                       files=FILES)
def joint_offsets(request: Request) -> Calibrated:
    """The calibration `joint_offsets`."""
    samples, camera = ArmSamples(request), request.calibrated_camera()
    found = calibrate_joint_offsets(samples.arm, samples.joints, samples.views, request.board, camera, samples.names)
    more = [Value(f"{name}.offset", value, stddev, "m or rad") for name, (value, stddev) in found.offsets.items()]
    section = {"joint_offsets": {name: float(round(value, 6)) for name, (value, _) in found.offsets.items()},
               "hand_eye": hand_eye_section(found.hand_eye, request.link)}
    unknown = tuple((f"{name}.offset", "no motion of the arm tells it from the places of camera and board")
                    for name in found.unknown)
    return hand_eye_result(found.hand_eye, samples, camera, request, section, more, unknown=unknown,
                           advice="lengths of the arm that are not those of the URDF, a board that is not flat, or "
                                  "images taken in motion")


def calibrate_joint_offsets(arm: RobotKinematics, joints: np.ndarray, views: Sequence[np.ndarray], board: Board,
                            camera: CameraCalibration, names: Optional[Sequence[str]] = None) -> JointOffsets:
    """Returns the offsets of the joints and where the camera is.

    Args:
        arm: kinematics to the link that carries the camera.  joints: (k, n) positions as reported, in the order of
            arm.joint_names [m or rad].  views: list of k (n, 2) pixels.  names: of the samples, for errors.
    Raises: ParameterError: too few views, joints that hardly moved (each is named), an arm that did not turn about two
        axes, or a residual far above that of the camera.
    """
    joints, least = np.asarray(joints, dtype=float), max(LEAST_VIEWS, joints.shape[1])
    faults = []
    if len(views) < least or len(views) != len(joints):
        faults.append(f"views of the board: found {len(views)} with {len(joints)} postures, allowed >= {least}, one "
                      "posture each")
    if len(joints):
        faults += [f"{name}: found a motion of {span:.3g} (m, rad) between the views, allowed >= {LEAST_MOTION:g}"
                   for name, span in zip(arm.joint_names, np.ptp(joints, axis=0)) if not span >= LEAST_MOTION]
    if faults:
        raise ParameterError(faults)
    poses = [arm.pose(q) for q in joints]
    check_turns(poses)
    guess = first_guess(poses, [camera.pose_of(view, board) for view in views])
    told = np.ones(joints.shape[1], dtype=bool)

    def fit():
        chosen = np.flatnonzero(told)

        def poses_of(values):
            offset = np.zeros(len(told))
            offset[chosen] = values
            return [arm.pose(q + offset) for q in joints]
        return fit_chain(poses_of, np.full(len(chosen), PRIOR), views, board, camera, *guess)

    found = fit()
    told &= found.more_stddev < TOLD * PRIOR
    found = fit()
    if not max(found.hand_eye.view_residuals_px) < camera.residual_limit_px:
        worst = int(np.argmax(found.hand_eye.view_residuals_px))
        name = worst if names is None else names[worst]
        most = found.hand_eye.view_residuals_px[worst]
        raise ParameterError(f"samples: found a residual of {most:.3g} px in {name}, allowed below "
                             f"{camera.residual_limit_px:.3g}: offsets do not explain it; `calibrate "
                             "hand_eye` names samples that do not fit")
    known = [name for name, is_told in zip(arm.joint_names, told) if is_told]
    return JointOffsets(found.hand_eye, {name: (float(value), float(stddev)) for name, value, stddev
                                         in zip(known, found.more, found.more_stddev)},
                        tuple(name for name, is_told in zip(arm.joint_names, told) if not is_told))
