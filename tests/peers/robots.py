"""Robots of the comparison and random states of theirs."""
import functools
import re
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
import pinocchio
from ours import ARMS, ROBOTS, WORKSPACE

GRAVITY = (0.0, 0.0, -9.81)


def bare(urdf):
    """The URDF without shapes, cameras, damping and dry friction: what rigid bodies are about."""
    root = ElementTree.fromstring(urdf)
    for tag in ("gazebo", "transmission", "material"):
        for entry in root.findall(tag):
            root.remove(entry)
    for parent in [*root.findall("link"), *root.findall("joint")]:
        for tag in ("visual", "collision", "dynamics", "safety_controller"):
            for entry in parent.findall(tag):
                parent.remove(entry)
    return ElementTree.tostring(root, encoding="unicode")


class Robot:
    """One robot in Pinocchio and MuJoCo.

    Attributes: urdf: the document.  names: moving joints, sorted.  lower, upper: (n,) range of the random states.
    """

    def __init__(self, urdf):
        self.urdf = urdf
        # A continuous joint has two numbers in Pinocchio: a wide revolute one is the same here.
        wide = re.sub(r'type="continuous">', 'type="revolute"><limit lower="-50" upper="50" effort="1e6" '
                      'velocity="1e6"/>', _without_limits_of_continuous(urdf))
        self.pin = pinocchio.buildModelFromXML(wide)
        self.pin.gravity.linear = np.array(GRAVITY)
        self.data = self.pin.createData()
        self.names = sorted(self.pin.names[1:])
        self._order = [self.pin.getJointId(name) - 1 for name in self.names]
        self.lower = np.maximum(self.pin.lowerPositionLimit[self._order], -3.0)
        self.upper = np.minimum(self.pin.upperPositionLimit[self._order], 3.0)
        spec = mujoco.MjSpec.from_string(wide)
        spec.compiler.fusestatic = False
        spec.compiler.balanceinertia = False
        for joint in spec.joints:
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
        self.mj = spec.compile()
        self.mj.opt.gravity[:] = GRAVITY
        self.mj_data = mujoco.MjData(self.mj)
        self._mj_order = [int(self.mj.joint(name).dofadr[0]) for name in self.names]

    def states(self, count, seed, speed=2.0):
        """[(q, v, effort)], each (n,) in the order of names; efforts that ask for up to 100 rad/s^2 or m/s^2 each."""
        rng, states = np.random.default_rng(seed), []
        n = len(self.names)
        for _ in range(count):
            q = self.lower + rng.uniform(0.05, 0.95, n) * (self.upper - self.lower)
            v, a = rng.uniform(-speed, speed, n), rng.uniform(-100.0, 100.0, n)
            effort = pinocchio.rnea(self.pin, self.data, self.to_pin(q), self.to_pin(v), self.to_pin(a))
            states.append((q, v, self.from_pin(effort)))
        return states

    def named(self, values):
        return dict(zip(self.names, np.asarray(values).tolist()))

    def to_pin(self, values):
        result = np.zeros(len(self.names))
        result[self._order] = values
        return result

    def from_pin(self, values):
        return np.asarray(values)[..., self._order]

    def matrix_from_pin(self, M):
        M = np.triu(M) + np.triu(M, 1).T
        return M[np.ix_(self._order, self._order)]

    def set_mujoco(self, q, v, effort=None):
        mujoco.mj_resetData(self.mj, self.mj_data)
        self.mj_data.qpos[self._mj_order], self.mj_data.qvel[self._mj_order] = q, v
        if effort is not None:
            self.mj_data.qfrc_applied[self._mj_order] = effort

    def from_mujoco(self, values):
        return np.array(values)[self._mj_order]

    def mass_matrix_of_mujoco(self):
        mujoco.mj_forward(self.mj, self.mj_data)
        M = np.zeros((self.mj.nv, self.mj.nv))
        mujoco.mj_fullM(self.mj, self.mj_data, M)
        return M[np.ix_(self._mj_order, self._mj_order)]


def _without_limits_of_continuous(urdf):
    root = ElementTree.fromstring(urdf)
    for joint in root.findall("joint"):
        if joint.get("type") == "continuous":
            for limit in joint.findall("limit"):
                joint.remove(limit)
    return ElementTree.tostring(root, encoding="unicode")


@functools.lru_cache(maxsize=None)
def robot(name):
    """One of ROBOTS or ARMS, `bare`."""
    return Robot(bare((WORKSPACE / {**ROBOTS, **ARMS}[name]).read_text()))
