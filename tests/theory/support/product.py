"""What the product's laws and servo answer. The equations' tests call them here only, and keep what they answer."""
import functools
from types import SimpleNamespace

import numpy as np
from bench import Bench, config
from toy_plant import OUTLINE, Camera
from views import look_at, plane_of, view

from aras_visual_servo.arm.kinematics import Kinematics
from aras_visual_servo.arm.motion import LIMIT_HORIZON, ArmMotion
from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.ground.types import Reference
from aras_visual_servo.laws import LawSetup, make_law
from aras_visual_servo.laws.broyden import BroydenSettings
from aras_visual_servo.laws.photometric import PhotometricSettings
from aras_visual_servo.servo.feed_forward import ConstantVelocity, FeedForwardSettings, TargetMotion
from aras_visual_servo.servo.settings import ServoSettings

FOUR = ("xn", "yn", "an", "alpha")
SIX = ("xn", "yn", "an", "sx", "sy", "alpha")
POSE = ("tx", "ty", "tz", "rx", "ry", "rz")
HYBRID = ("xr", "yr", "zr", "rx", "ry", "rz")


def law_of(name, gains, goal, features, outline=OUTLINE, **setup):
    """A law that was taught the view of the outline from the pose `goal`."""
    taught = view(goal, outline)
    law = make_law(name, gains, LawSetup(features, **setup))
    law.reset(Reference(FeatureSet(features).values(taught), view=taught.features, plane_C=plane_of(goal)))
    return law


def twist_of(law, goal, here, dt_s=0.0, outline=OUTLINE):
    """(V_C, s, e) of a law for the view of the outline from the pose `here`."""
    look = look_at(view(here, outline).features, dt_s, plane_of(here), np.linalg.inv(goal) @ here)
    answer = law.step(look)
    return np.array(answer.twist), np.array(answer.s), np.array(answer.e)


def four_features(name, gains, s, s_star, dt_s):
    """(4,) vx, vy, vz, wz of a law on (xn, yn, an, alpha)."""
    law = make_law(name, gains)
    law.reset(s_star)
    seen = SimpleNamespace(xn=s[0], yn=s[1], an=s[2], alpha=s[3], symmetric=False)
    return law.step(look_at(seen, dt_s)).twist[[0, 1, 2, 5]]


def photometric_twist(H, b, rms, gain, damping):
    """[(6,) twist], not held for any time, of law photometric for one image after the other with these equations."""
    settings = {"photometric": PhotometricSettings(damping, 1e-4, 1e-4)}
    law = make_law("photometric", [gain], LawSetup(("photometric",), settings=settings))
    law.reset(Reference(np.zeros(1)))
    image = {"has_reference": True, "H": H[np.triu_indices(6)].tolist(), "b": b.tolist(), "condition": 5.0,
             "symmetric": False}
    return [law.step(look_at(SimpleNamespace(**image, rms=one))).twist for one in rms]


def learnt(goal, outline, motions, changes, forgetting, move):
    """[(J, P)] of law broyden, of which the first is what it starts with, after each motion h and change ds."""
    names = tuple(f"{axis}{k + 1}" for k in range(len(outline)) for axis in "xy")
    law = law_of("broyden", [1.0] * len(names), goal, names, outline,
                 settings={"broyden": BroydenSettings("desired", forgetting, move)})
    states = [(law._J, law._P)]
    for motion, change in zip(motions, changes):
        law._learn(motion, change)
        states.append((law._J, law._P))
    return states


@functools.lru_cache(maxsize=None)
def plane_by_kinematics():
    """(p* at the goal, X_CgC, plane at the start) of a servo on the arm."""
    bench = Bench(law="ibvs", features=list(SIX), interaction="current",
                  gains_per_s=dict.fromkeys(SIX, 1.0), thresholds=dict.fromkeys(SIX, 1e-6))
    X_CgC = np.linalg.inv(bench.X_WG) @ bench.arm.pose(bench.q)
    return bench.servo.reference.plane_C, X_CgC, bench.servo._plane(bench.servo._kinematics.pose(bench.q))


def goal_from_error(features, goal, here):
    """(R_CG, p_CP, point_G) that the estimate of a moving target makes of s and e, the camera at `here`."""
    one = FeatureSet(features)
    s, s_star = one.values(view(here)), one.values(view(goal))
    motion = TargetMotion(FeedForwardSettings(), one)
    motion.set_reference(Reference(s_star, view=view(goal).features, plane_C=plane_of(goal)))
    return (*motion.goal_and_point(s, one.error(s, s_star, False)), motion._point_G)


def along_with_target(goal, cameras, targets, dt_s, velocity, turn):
    """Twist of the camera at the last of its poses, when the motion of the target is already known.

    Args: goal: X_BC above the outline, parallel to it.  cameras: two poses X_BC.  targets: where the target's frame, at
    first the base's own, is at both: X_BT, (4, 4).  velocity, turn: of the followed point [m/s] and of the target
    [rad/s], in B.
    """
    camera = Camera(None)
    camera.star = (goal[2, 3], camera.features(goal).area)
    features, taught = FeatureSet(FOUR), camera.features(goal)
    motion = TargetMotion(FeedForwardSettings(), features)
    s_star = features.values(View(taught))
    motion.set_reference(Reference(s_star, view=taught, plane_C=plane_of(goal)))
    for stamp_ns, X_BC, X_BT in zip((0, round(1e9 * dt_s)), cameras, targets):
        s = features.values(View(camera.features(np.linalg.inv(X_BT) @ X_BC)))
        answer = motion.twist(stamp_ns, X_BC, s, features.error(s, s_star, False))
        motion.velocity, motion.turn = np.array(velocity), np.array(turn)
    return answer


def filter_gains(acceleration, noise, speed, dt_s, images):
    """[(gain of the place, of the velocity)] of the filter of a moving target."""
    one = ConstantVelocity(acceleration, noise, speed)
    return [one.gains(dt_s) for _ in range(images)]


def at_limit(urdf, q, joint, room, dt_s):
    """What joints do when one has that much room left in a twist it would pass its limit with.

    Returns: (q_dot, V, J, room, horizon_s, index of the joint): scaled are neither rows nor columns.
    """
    kinematics = Kinematics(urdf, "world", "camera_optical_frame")
    settings = config(inverse={"at_limits": "saturate", "method": "plain"},
                      null_space={"posture_gain_per_s": 0.0, "joint_limit_gain_per_s": 0.0})
    motion = ArmMotion(kinematics, ServoSettings.from_dict(settings, kinematics.joint_names), sees_tilt=True)
    q, index = kinematics.vector(q), kinematics.joint_names.index(joint)
    q[index] = motion.upper[index] - room
    q_dot = np.full(len(q), 0.02)
    q_dot[index] = 2.0 * room / dt_s  # four times its room in the time that is looked ahead
    J = kinematics.jacobian(q)
    found = motion.joint_velocity(q, J @ q_dot, *motion.at(q), dt_s)
    return found.q_dot, J @ q_dot, J, room, LIMIT_HORIZON * dt_s, index
