"""A servo experiment as a gymnasium environment: one step is one image period.

The simulator draws an image only where the observation or the reward asks for one. A step answers the state that the
last observation shows, as in a run: the action holds from that image to the next.
"""

from math import atan2, sqrt
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from aras_visual_servo import (JOINT_HALF_WIDTH, ExperimentSettings, Feasibility, Names, ParameterError, RecordBuilder,
                               Scenario, ServoSettings, SimulatedCell, SweepSection, eight_bit, extra, in_rgb,
                               is_number, load_scenario, read)

from .reward import REWARDS

gymnasium = extra("gymnasium", "an environment for reinforcement learning")
spaces = gymnasium.spaces

OBSERVATIONS, ACTIONS, RENDER_MODES = ("state", "image", "dict"), ("twist", "joints"), ("rgb_array", "camera")
#: Starts are drawn until one shows the target and is within the limits; so often at most.
TRIES = 1000
#: Bounds of positions in observations [m, rad]: nothing of the shipped scenarios comes near.
FAR = 100.0
#: Width and height of pictures of the arm from beside [px].
WATCHED_PX = (480, 360)
#: Simulated time in which the arm comes to rest at its start [s].
SETTLE_S = 0.1


class ServoEnv(gymnasium.Env, gymnasium.utils.EzPickle):  # type: ignore[name-defined]
    """Servo the camera to the goal of a scenario. A pickled environment is made anew from its arguments.

    Args:
        scenario: name, path or `Scenario`: robot, scene, camera, goal, and in `sweep.joints` where it starts.
        observation: "state": joint positions and velocities, and the camera's true pose in the frame of the goal
            camera (x, y, z [m], rotation vector [rad]); "image": the camera's image; "dict": both, with the goal image.
        action: "twist": V_C of the camera, [v; w], each entry in [-1, 1] of `max_twist`; "joints": joint velocities, in
            [-1, 1] of `max_joint_speed`.
        reward: "pose": by the true pose; "features": by the errors of the scenario's features (reward.py).
        image_size: (width, height) of the camera [px]; None: the scenario's. The field of view stays.
        max_twist: [m/s, rad/s].  max_joint_speed: [m/s, rad/s].
        max_steps: after so many steps an episode is truncated.
        success: (m, rad): within both of the goal an episode terminates.
        render_mode: "rgb_array": the arm from beside; "camera": what the camera sees.
    Raises: ParameterError: an argument or the scenario is not allowed.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 30}

    def __init__(self, scenario: Union[str, Scenario] = "experiment_1", observation: str = "state",
                 action: str = "twist", reward: str = "pose", image_size: Optional[Tuple[int, int]] = None,
                 max_twist: Tuple[float, float] = (0.3, 1.0), max_joint_speed: float = 0.5, max_steps: int = 300,
                 success: Tuple[float, float] = (0.001, 0.005), render_mode: Optional[str] = None) -> None:
        gymnasium.utils.EzPickle.__init__(self, scenario, observation, action, reward, image_size, max_twist,
                                          max_joint_speed, max_steps, success, render_mode)
        for name, value, allowed in (("observation", observation, OBSERVATIONS), ("action", action, ACTIONS),
                                     ("reward", reward, tuple(REWARDS)),
                                     ("render_mode", render_mode, (None, *RENDER_MODES))):
            if value not in allowed:
                raise ParameterError(f"{name}: found {value!r}, allowed {' | '.join(map(str, allowed))}")
        scenario = scenario if isinstance(scenario, Scenario) else load_scenario(scenario)
        if image_size is not None:
            scenario = scenario.with_overrides({"sim.cameras": _resized(scenario.sim["cameras"], image_size)})
        self.scenario, self.render_mode, self.max_steps = scenario, render_mode, int(max_steps)
        self._observation, self._near = observation, success
        self._cell = SimulatedCell(scenario, calibrated=False)
        self.sim, self.camera, self.kinematics = self._cell.sim, self._cell.camera, self._cell.kinematics
        self._names = self.kinematics.joint_names
        self._experiment = ExperimentSettings.from_dict(scenario.experiment, self.kinematics)
        self._feasibility = Feasibility(scenario, self.kinematics)
        self._ranges = self._start_ranges()
        models = scenario.sim.get("scene", {}).get("models", [])
        self._target = models[0]["name"] if models and "motion" in models[0] else None  # of those that move
        self._reward = REWARDS[reward](scenario, self.kinematics)
        if action == "twist":
            self._invert = _Inverse(ServoSettings.from_dict(scenario.servo).inverse)
            self._scale = np.repeat(np.array(max_twist, dtype=float), 3)
        else:
            self._invert, self._scale = None, np.full(len(self._names), float(max_joint_speed))
        self._fastest = self.kinematics.velocity
        self.action_space = spaces.Box(-1.0, 1.0, (len(self._scale),), np.float32)
        info, self._encoding = self._cell.camera_info, self._cell.encoding
        shape = (info["height"], info["width"]) + (() if self._encoding.startswith("mono") else (3,))
        state = spaces.Box(-FAR, FAR, (2 * len(self._names) + 6,), np.float64)
        value = np.uint16 if self._encoding.endswith("16") else np.uint8
        image = spaces.Box(0, np.iinfo(value).max, shape, value)
        self.observation_space = {
            "state": state, "image": image,
            "dict": spaces.Dict({"state": state, "image": image, "goal_image": image})}[observation]
        self._wants_image = observation != "state" or self._reward.wants_image
        self._goal: Any = None
        self._observer: Any = None
        self._steps = 0

    # --- gymnasium ----------------------------------------------------------------------------------------------

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Any, Dict[str, Any]]:
        """Begins an episode.

        Args: options: {"start": joint positions by name [m, rad]}; joints without one are at the goal.
        Raises ParameterError: an unknown option or joint, or a position that is no finite number.
        """
        super().reset(seed=seed)
        options = options or {}
        start = options.get("start")
        given = {name: at.item() if isinstance(at, np.generic) else at for name, at in (start or {}).items()}
        faults = [f"options.{name}: unknown, allowed start" for name in options if name != "start"]
        faults += [f"options.start.{name}: unknown, allowed {', '.join(self._names)}"
                   for name in given if name not in self._names]
        faults += [f"options.start.{name}: found {at!r}, allowed a finite number" for name, at in given.items()
                   if not is_number(at)]
        if faults:
            raise ParameterError(faults)
        joints = self.kinematics.by_name(self.kinematics.vector(
            {**(self._experiment.goal.joints or {}), **given})) if start is not None else self._drawn()
        self.sim.reset()
        if self._goal is None or self._target or self._reward.wants_image or self._observation == "dict":
            self._teach()
        self._place(joints)
        self._steps = 0
        q, v, X = self._look()
        return self._observed(q, v, X), self._info(X)

    def step(self, action: np.ndarray) -> Tuple[Any, float, bool, bool, Dict[str, Any]]:
        """One image period with this action."""
        action = np.clip(action, -1.0, 1.0) * self._scale
        if self._invert is not None:
            q_dot = self._invert(self.kinematics.jacobian(self._q), action)
            fastest = float((np.abs(q_dot) / self._fastest).max())
            action = q_dot / fastest if fastest > 1.0 else q_dot
        self.sim.set_command(velocity=dict(zip(self._names, action.tolist())))
        q, v, X = self._look()
        self._steps += 1
        info = self._info(X)
        success = info["is_success"]
        reward = self._reward(info, self._image, self._stamp_ns)
        return self._observed(q, v, X), reward, success, not success and self._steps >= self.max_steps, info

    def render(self) -> Optional[np.ndarray]:
        """Picture of the present, uint8 (h, w, 3)."""
        if self.render_mode is None:
            return None
        if self.render_mode == "camera":
            image = np.array(eight_bit(self._rendered()))
            return np.repeat(image[..., None], 3, axis=2) if image.ndim == 2 else image
        if self._observer is None:
            self._observer = self._beside()
        return self._observer.picture(self._q)

    # --- parts --------------------------------------------------------------------------------------------------

    def _beside(self):
        """Observer of the arm, as of a run whose one row is the goal."""
        from aras_visual_servo_study.report.observer import Observer
        builder = RecordBuilder(self.scenario.name, self._names, settings=self.scenario.as_dict())
        X_WC, X_WT = np.eye(4), np.eye(4)
        X_WC[:3, 3] = self._goal[:3, 3]
        builder.add_row(0, "servo", X_WC=X_WC)
        models = self.scenario.sim.get("scene", {}).get("models", [])
        X_WT[:3, 3] = models[0].get("position_m", (0.0, 0.0, 0.0)) if models else (*self._goal[:2, 3], 0.0)
        return Observer(builder.finish(X_WT=X_WT), *WATCHED_PX)

    def _rendered(self):
        """The present image, grey or rgb."""
        return in_rgb(self.sim.render(self.camera), self._encoding)

    def _start_ranges(self):
        section = read(SweepSection, self.scenario.sweep, "sweep", Names(joints=self._names))
        goal = self._experiment.goal.joints
        return section.joints or {name: (at - JOINT_HALF_WIDTH, at + JOINT_HALF_WIDTH) for name, at in goal.items()}

    def _drawn(self):
        """Joint positions of a start, by name, that the arm can take and at which the target is in view."""
        goal = self._experiment.goal.joints
        for _ in range(TRIES):
            drawn = {name: float(self.np_random.uniform(*ends)) for name, ends in self._ranges.items()}
            joints = {**goal, **drawn}
            if not self._feasibility.refusal(self.kinematics.vector(goal), self.kinematics.vector(joints)):
                return joints
        raise ParameterError(f"scenario '{self.scenario.name}': none of {TRIES} starts drawn from sweep.joints shows "
                             "the target within the joints' limits")

    def _place(self, joints):
        self.sim.set_joint_positions(joints)
        self.sim.step(round(SETTLE_S * 1e9 / self.sim.period_ns))

    def _teach(self):
        """Take the view at the goal: pose, image, and what the reward needs of it."""
        self._place(self._experiment.goal.joints)
        self._goal = np.eye(4)
        self._look(draw=True)
        frame = self.sim.frame_state(self.camera)
        self._goal = frame["camera_pose"]
        self._goal_T = np.linalg.solve(frame["model_poses"][self._target], self._goal) if self._target else None
        self._goal_image = np.array(self._image)
        self._to_goal = np.linalg.inv(self._goal)
        self._reward.teach(self._image, self._stamp_ns, self._q)

    def _look(self, draw=False):
        """(q, q_dot, X_CgC) at the next image."""
        self._stamp_ns = self.sim.step_to_image(self.camera)
        self._image = self._rendered() if self._wants_image or draw else None
        state = self.sim.frame_state(self.camera)
        q, v = self._cell.in_order(state["joint_positions"]), self._cell.in_order(state["joint_velocities"])
        self._q = q
        if self._target is not None and self._goal_T is not None:
            self._to_goal = np.linalg.inv(state["model_poses"][self._target] @ self._goal_T)
        return q, v, self._to_goal @ state["camera_pose"]

    _to_goal, _goal_T = np.eye(4), None

    def _info(self, X):
        (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = X.tolist()
        self._pose = (x, y, z, *_rotation_vector(a, b, c, d, e, f, g, h, i))
        _, _, _, rx, ry, rz = self._pose
        distance, angle = sqrt(x * x + y * y + z * z), sqrt(rx * rx + ry * ry + rz * rz)
        return {"distance_m": distance, "angle_rad": angle,
                "is_success": distance < self._near[0] and angle < self._near[1]}

    def _observed(self, q, v, X):
        if self._observation == "image":
            return np.array(self._image)
        if not self._steps:
            self._info(X)
        state = np.concatenate((q, v, self._pose))
        if self._observation == "state":
            return state
        return {"state": state, "image": np.array(self._image), "goal_image": self._goal_image.copy()}


class _Inverse:
    """Joint velocities of a twist by damped least squares, with the scenario's damping everywhere: without the singular
    values that the servo looks at, in a third of the time."""

    def __init__(self, inverse):
        self._scale = np.array([1.0 / inverse.length_m] * 3 + [1.0] * 3)
        self._damping = inverse.damping ** 2 * np.eye(6)

    def __call__(self, jacobian, twist):
        J = jacobian * self._scale[:, None]
        return J.T @ np.linalg.solve(J @ J.T + self._damping, self._scale * twist)


def _resized(cameras, size):
    width, height = size
    return [{**camera, "width": int(width), "height": int(height)} if i == 0 else camera
            for i, camera in enumerate(cameras)]


def _rotation_vector(a, b, c, d, e, f, g, h, i):
    """Of a rotation matrix, row by row; for angles below pi, where floats suffice and numpy takes ten times as long."""
    x, y, z = h - f, c - g, d - b
    sine2 = sqrt(x * x + y * y + z * z)
    if sine2 < 1e-12:
        if a + e + i > 0.0:
            return 0.5 * x, 0.5 * y, 0.5 * z
        from aras_visual_servo import spatial
        return tuple(spatial.rotation_vector(np.array([[a, b, c], [d, e, f], [g, h, i]])).tolist())
    scale = atan2(sine2, a + e + i - 1.0) / sine2
    return scale * x, scale * y, scale * z
