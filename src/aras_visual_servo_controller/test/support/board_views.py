"""Images of a calibration board, drawn by the simulator's own renderer from the true arm, camera and lens."""

import numpy as np
import yaml
from toy_plant import GOAL

from aras_visual_servo import load_scenario, ServoLoop

WIDTH, HEIGHT, FOV_RAD = 640, 480, 1.2
#: The lens of the paper's camera.
LENS = [-0.3306, 0.117, 0.0, 0.0, 0.0]
#: How far joints go from where the camera looks straight down on the board [m, rad].
SPREAD = {"gantry": 0.08, "J1": 0.45, "J2": 0.15, "J3": 0.15, "J5": 0.45, "J6": 1.2}


def lay_down(board, folder):
    """File of a simulator's target that is the board, centred."""
    centre = board.points_m.mean(axis=0)[:2]
    outlines = [[[float(x - centre[0]), float(centre[1] - y)] for x, y in outline[::-1]]
                for outline in board.outlines()]  # the simulator has y up
    extent = np.ptp(np.concatenate([np.array(outline) for outline in outlines]), axis=0) + 4.0 * board.size_m
    path = folder / "board.yaml"
    path.write_text(yaml.safe_dump({"name": "board", "color_rgb": [20, 20, 20], "outlines_m": outlines,
                                    "board": {"size_m": extent.tolist(), "color_rgb": [235, 235, 235]}}))
    return path


class BoardViews:
    """Attributes: images, joints (dicts by name), cameras (true X_WC), X_WO: the board's points in the world."""

    def __init__(self, board, folder, count, noise=1.0, seed=0):
        camera = {"name": "camera", "frame": "camera_optical_frame", "width": WIDTH, "height": HEIGHT, "rate_hz": 30.0,
                  "horizontal_fov_rad": FOV_RAD, "distortion_model": "plumb_bob", "distortion": LENS,
                  "sampling": "coverage", "noise_stddev": noise}
        model = {"name": "target", "file": str(lay_down(board, folder)), "position_m": [0.03, 0.05, 0.25],
                 "rpy_rad": [0.05, -0.03, 0.2]}
        loop = ServoLoop(load_scenario("experiment_1", {"sim.cameras": [camera], "sim.scene.models": [model]}))
        turned = np.diag([1.0, -1.0, -1.0, 1.0])
        turned[:3, 3] = -turned[:3, :3] @ board.points_m.mean(axis=0)
        self.X_WO = loop.target_pose() @ turned
        self.arm, self.scenario, self.info = loop.kinematics, loop.scenario, loop.camera_info
        self.images, self.joints, self.cameras = [], [], []
        random = np.random.default_rng(seed)
        for _ in range(20 * count):
            joints = {name: at + SPREAD[name] * random.uniform(-1.0, 1.0) for name, at in GOAL.items()}
            loop.place(joints, settle_s=0.3)
            _, image, q = loop.take()
            if board.find(np.array(image)) is not None:
                self.images.append(np.array(image))
                self.joints.append(loop.kinematics.by_name(q))
                self.cameras.append(loop.camera_pose())
            if len(self.images) == count:
                return
        raise AssertionError(f"the board was in {len(self.images)} views of {20 * count}")
