"""What this project answers, asked of programs of the workspace: the peers live in a Python without ROS."""
import json
import os
import pathlib
import subprocess

import numpy as np

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
ROBOTS = {
    "chain": "src/aras_visual_servo_sim/test/urdf/tilted_chain.urdf",
    "gantry": "src/aras_description/urdf/aras_arm.urdf",
    "six axes": "src/aras_description/urdf/aras_arm_6axis.urdf",
}
#: The named arms: name -> URDF.
ARMS = {path.parent.name: str(path.relative_to(WORKSPACE))
        for path in sorted((WORKSPACE / "src/aras_description/arms").glob("*/arm.urdf"))}


def _ask(command, asked):
    text = json.dumps(asked, default=lambda value: np.asarray(value).tolist())
    environment = {key: value for key, value in os.environ.items() if key not in ("VIRTUAL_ENV", "PYTHONHOME")}
    done = subprocess.run(command, input=text, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def world(urdf, cases, gravity=(0.0, 0.0, -9.81), period_s=0.001, floating=False, ground=None, actuated=False):
    """[{...}] as world.cpp describes it, its arrays as numpy's; mass_matrix is square."""
    asked = {"urdf": urdf, "gravity": gravity, "period_s": period_s, "floating": floating, "actuated": actuated,
             "cases": cases, **({"ground": ground} if ground else {})}
    answers = _ask([WORKSPACE / "install/lib/aras_visual_servo_tests/sim_world"], asked)
    for one in answers:
        links = one.pop("links")
        one.update({key: np.array(value) for key, value in one.items()})
        one["mass_matrix"] = one["mass_matrix"].reshape(2 * [int(round(len(one["mass_matrix"]) ** 0.5))])
        one["links"] = {name: {key: np.array(value) for key, value in link.items()} for name, link in links.items()}
    return answers


def kinematics(urdf, base, tip, positions):
    """[(X_BC, J_BC_C)] of the controller's kinematics, for joint positions by name."""
    asked = {"urdf": urdf, "base": base, "tip": tip, "positions": positions}
    answers = _ask(["/usr/bin/python3", pathlib.Path(__file__).with_name("jacobians.py")], asked)
    return [(np.array(one["pose"]), np.array(one["jacobian"])) for one in answers]


def light(sensor, width, height, file, points):
    """Writes images of an evenly lit sensor, as photons.py describes them."""
    asked = {"sensor": sensor, "width": width, "height": height, "file": str(file), "points": points}
    _ask(["/usr/bin/python3", pathlib.Path(__file__).with_name("photons.py")], asked)
