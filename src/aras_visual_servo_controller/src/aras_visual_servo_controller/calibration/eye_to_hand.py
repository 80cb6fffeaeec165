"""Where a camera stands that sees the board on a link of the arm: hand-eye calibration with the inverse poses."""

from aras_visual_servo.spatial import inverse
from .family import CALIBRATIONS, Calibrated, Request
from .hand_eye import calibrate_hand_eye, hand_eye_result, hand_eye_section
from .samples import FILES, ArmSamples


@CALIBRATIONS.register("eye_to_hand", about="where a camera stands that sees the board in the hand, for robot.hand_eye "
                       "and robot.target_link", files=FILES)
def eye_to_hand(request: Request) -> Calibrated:
    """The calibration `eye_to_hand`."""
    samples, camera = ArmSamples(request), request.calibrated_camera()
    found = calibrate_hand_eye(list(map(inverse, samples.poses)), samples.views, request.board, camera, samples.names)
    base = samples.scenario.robot["base_link"]
    return hand_eye_result(found, samples, camera, request,
                           {"target_link": request.link, "hand_eye": hand_eye_section(found, base)})
