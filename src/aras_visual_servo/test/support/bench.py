"""A servo on the true arm with exact pictures and joints that follow at once, step by step."""

import numpy as np
from toy_plant import arm, Camera, GOAL, PERIOD_NS, pose_error, START

from aras_visual_servo import FEATURE_NAMES, Observation, Servo

FINAL_POSITION_M, FINAL_ANGLE_RAD = 1e-5, 1e-5

DT_S = 1e-9 * PERIOD_NS
LAMBDA = 3.0


def config(**changes):
    base = {
        "law": "decoupled",
        "mode": "continuous",
        "gains_per_s": dict.fromkeys(FEATURE_NAMES, LAMBDA),
        "thresholds": dict.fromkeys(FEATURE_NAMES, 1e-6),
        "time_limit_s": 20.0,
    }
    return {**base, **changes}


class Bench:
    """Arm with perfect joints (plus an optional offset q = set_point + sag(set_point)), camera, target, servo."""

    def __init__(self, goal=GOAL, start=START, sag=None, **changes):
        self.arm = arm()
        self.sag = sag or (lambda q: np.zeros(6))
        self.goal_q = self.arm.vector(goal)
        self.goal_q = self.goal_q + self.sag(self.goal_q)
        self.X_WG = self.arm.pose(self.goal_q)
        X_WT = np.eye(4)
        X_WT[:3, 3] = [-0.03, 0.05, 0.19]
        self.camera = Camera(X_WT)
        self.camera.star = (self.X_WG[2, 3] - 0.19, self.camera.features(self.X_WG).area)
        self.servo = Servo(self.arm, config(**changes))
        self.servo.teach(self.camera.features(self.X_WG), self.goal_q, self.camera.star[0])
        self.set_point = self.arm.vector(start)
        self.stamp_ns = 0
        self.records, self.commands = [], []
        self.servo.start(0, self.set_point)

    @property
    def q(self):
        return self.set_point + self.sag(self.set_point)

    def look(self):
        return Observation(self.stamp_ns, self.camera.features(self.arm.pose(self.q)), self.q)

    def step(self, observation=None):
        command, record = self.servo.step(observation or self.look(), DT_S)
        self.apply(command)
        self.records.append(record)
        self.commands.append(command)
        self.stamp_ns += PERIOD_NS
        return command, record

    def apply(self, command):
        for i, name in enumerate(self.arm.joint_names):
            self.set_point[i] = command.position.get(name, self.set_point[i])
            self.set_point[i] += command.velocity.get(name, 0.0) * DT_S

    def run(self, steps=1000):
        for _ in range(steps):
            if self.servo.finished:
                break
            self.step()
        return self.records[-1]

    def errors(self):
        return np.array([record.e for record in self.records])

    def assert_at_goal(self):
        distance, angle = pose_error(self.X_WG, self.arm.pose(self.q))
        assert distance < FINAL_POSITION_M
        assert angle < FINAL_ANGLE_RAD


def resting(command):
    return not command.position and all(value == 0.0 for value in command.velocity.values())
