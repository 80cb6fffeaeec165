"""A free body thrown along the floor, from random states, against MuJoCo and closed forms."""
import mujoco
import numpy as np
import ours
import pytest

THROWS = 30
PERIOD_S, STEPS, G = 2.5e-4, 4000, 9.81
#: Of the way, where all points of contact go the same way: a period is 1 / 200 of the shortest slide. A box that slides
#: straight turns a little in MuJoCo.
WAY, MUJOCO_STRAIGHT = 0.01, 0.03
#: Of the way, and in rad, where they do not: by so much MuJoCo's own results differ from period to period.
TURNING = 0.06
#: Of the weight.
FORCE = 1e-3
RADIUS_M, HALF_M, MASS_KG = 0.1, (0.15, 0.1, 0.02), 2.0

SHAPES = {
    "ball": ("<sphere radius='%g'/>" % RADIUS_M, "sphere", "%g" % RADIUS_M, RADIUS_M,
             3 * [0.4 * MASS_KG * RADIUS_M**2]),
    "box": ("<box size='%g %g %g'/>" % tuple(2.0 * side for side in HALF_M), "box", "%g %g %g" % HALF_M, HALF_M[2],
            [MASS_KG / 3.0 * (sum(side**2 for side in HALF_M) - HALF_M[axis]**2) for axis in range(3)]),
}


def urdf_of(shape):
    geometry, _, _, _, inertia = SHAPES[shape]
    return f"""<robot name="thrown"><link name="body"><inertial><mass value="{MASS_KG}"/>
      <inertia ixx="{inertia[0]!r}" iyy="{inertia[1]!r}" izz="{inertia[2]!r}" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><geometry>{geometry}</geometry></collision></link></robot>"""


def mujoco_of(shape, friction):
    _, kind, size, height, inertia = SHAPES[shape]
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
      <option timestep="{PERIOD_S}" gravity="0 0 -{G}" cone="elliptic" impratio="100" noslip_iterations="20"/>
      <default><geom condim="3" friction="{friction!r} 0 0" solref="0.004 1"/></default>
      <worldbody><geom type="plane" size="10 10 1"/><body pos="0 0 {height}"><freejoint/>
      <inertial pos="0 0 0" mass="{MASS_KG}" diaginertia="{' '.join(repr(one) for one in inertia)}"/>
      <geom type="{kind}" size="{size}"/></body></worldbody></mujoco>""")


def throw(rng, shape):
    """(friction, twist [v; w] in W) of a body that touches the floor."""
    friction, speed, way = rng.uniform(0.2, 0.8), rng.uniform(0.5, 1.5), rng.uniform(-np.pi, np.pi)
    turn = rng.uniform(-5.0, 5.0, 3) * ([1.0, 1.0, 1.0] if shape == "ball" else [0.0, 0.0, 1.0])
    return friction, np.r_[speed * np.cos(way), speed * np.sin(way), 0.0, turn]


def of_ours(shape, friction, twist):
    X = np.eye(4)
    X[2, 3] = SHAPES[shape][3]
    case = {"q": {}, "v": {}, "steps": STEPS, "pose": X[:3].ravel(), "twist": twist}
    found = ours.world(urdf_of(shape), [case], (0.0, 0.0, -G), PERIOD_S, floating=True,
                       ground={"z_m": 0.0, "friction": friction})[0]
    return found["base_pose"].reshape(3, 4), found["base_twist"], found["force"]


def of_mujoco(shape, friction, twist):
    model = mujoco_of(shape, friction)
    data = mujoco.MjData(model)
    data.qvel[:] = twist
    mujoco.mj_step(model, data, nstep=STEPS)
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, data.qpos[3:])
    return np.c_[R.reshape(3, 3), data.qpos[:3]], np.array(data.qvel)


def turned(X):
    """Angle about the vertical [rad]."""
    return np.arctan2(X[1, 0], X[0, 0])


def test_box_slides_and_turns_until_it_stops(compared):
    rng, ways, straight, turns, closed, forces = np.random.default_rng(1), [], [], [], [], []
    for k in range(THROWS):
        friction, twist = throw(rng, "box")
        if k % 2:
            twist[5] = 0.0
        X, V, force = of_ours("box", friction, twist)
        X_mujoco, _ = of_mujoco("box", friction, twist)
        off = np.linalg.norm(X[:2, 3] - X_mujoco[:2, 3]) / np.linalg.norm(X_mujoco[:2, 3])
        if k % 2:
            straight.append(off)
            closed.append(abs(np.linalg.norm(X[:2, 3]) * 2.0 * friction * G / (twist[:2] @ twist[:2]) - 1.0))
        else:
            ways.append(off)
            turns.append(abs(turned(X) - turned(X_mujoco)))
        assert np.linalg.norm(V) < 1e-3, "still moves"
        forces.append(np.linalg.norm(force - [0.0, 0.0, MASS_KG * G]) / (MASS_KG * G))
    compared("sliding distance, turning box", "MuJoCo", ways, TURNING, "relative")
    compared("rotation, turning box", "MuJoCo", turns, TURNING, "rad")
    compared("sliding distance, straight box", "MuJoCo", straight, MUJOCO_STRAIGHT, "relative")
    compared("sliding distance, straight box", "v^2 / (2 mu g)", closed, WAY, "relative")
    compared("normal force, resting box", "m g", forces, FORCE, "relative")


def test_ball_slides_until_it_rolls(compared):
    """The momentum about the floor stays: v = (5 v_0 + 2 r w_0 x z) / 7, and rolling is without loss."""
    rng, ways, speeds, closed = np.random.default_rng(2), [], [], []
    for _ in range(THROWS):
        friction, twist = throw(rng, "ball")
        X, V, _ = of_ours("ball", friction, twist)
        X_mujoco, V_mujoco = of_mujoco("ball", friction, twist)
        rolls = (5.0 * twist[:2] + 2.0 * RADIUS_M * np.array([twist[4], -twist[3]])) / 7.0
        ways.append(np.linalg.norm(X[:2, 3] - X_mujoco[:2, 3]) / np.linalg.norm(X_mujoco[:2, 3]))
        speeds.append(np.linalg.norm(V[:2] - V_mujoco[:2]) / np.linalg.norm(twist[:2]))
        closed.append(np.linalg.norm(V[:2] - rolls) / np.linalg.norm(twist[:2]))
    compared("distance, thrown ball", "MuJoCo", ways, WAY, "relative")
    compared("speed, rolling ball", "MuJoCo", speeds, WAY, "relative")
    compared("speed, rolling ball", "(5 v + 2 r w x z) / 7", closed, WAY, "relative")


@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_without_friction_nothing_slows_it_down(shape, compared):
    rng, differences = np.random.default_rng(3), []
    for _ in range(5):
        _, twist = throw(rng, shape)
        _, V, _ = of_ours(shape, 0.0, twist)
        differences.append(np.linalg.norm(V[:2] - twist[:2]) / np.linalg.norm(twist[:2]))
    compared(f"speed, {shape} without friction", "initial speed", differences, 1e-9, "relative")
