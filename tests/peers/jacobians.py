"""Asked by the tests: the controller's kinematics, {urdf, base, tip, positions} -> [{pose, jacobian}], JSON both."""
import json
import sys

import aras_visual_servo as avs


def main():
    asked = json.load(sys.stdin)
    arm = avs.Kinematics(asked["urdf"], asked["base"], asked["tip"])
    positions = [arm.vector(q) for q in asked["positions"]]
    print(json.dumps([{"pose": arm.pose(q).tolist(), "jacobian": arm.jacobian(q).tolist()} for q in positions]))


if __name__ == "__main__":
    main()
