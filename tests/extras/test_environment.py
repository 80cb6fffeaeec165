"""The gymnasium environments: by gymnasium's own checker, and by what a servo must be able to do in them."""
import functools
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv

import aras_visual_servo as avs
from aras_visual_servo_learning import ENVIRONMENTS
from aras_visual_servo_learning.environment import ServoEnv

MODULE = "aras_visual_servo_learning:"
#: Of a proportional law on the pose, in 120 steps of 1/30 s at 3 /s: e^-12 of the start, and what friction leaves.
ARRIVES_M, ARRIVES_RAD = 0.001, 0.005


def make(name="ArasServo-State-v0", **arguments):
    return gymnasium.make(MODULE + name, **arguments)


def towards_goal(state, max_twist=(0.3, 1.0)):
    """Action of a law on the true pose: straight home, v = -3 R^T p, w = -3 theta u."""
    from scipy.spatial.transform import Rotation
    p, r = state[-6:-3], state[-3:]
    v = -3.0 * Rotation.from_rotvec(r).inv().apply(p)
    twist = np.concatenate((v / max_twist[0], -3.0 * r / max_twist[1]))
    return (twist / max(1.0, np.abs(twist).max())).astype(np.float32)


@pytest.mark.parametrize("name", ENVIRONMENTS)
@pytest.mark.parametrize("arguments", [{}, {"action": "joints", "reward": "features"}], ids=["pose", "features"])
def test_the_checker_of_gymnasium_finds_nothing(name, arguments):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(name, render_mode="camera", **arguments).unwrapped)


def test_a_simple_law_arrives_and_the_episode_terminates():
    env = make()
    state, info = env.reset(seed=3)
    assert info["distance_m"] > 0.02
    rewards = []
    for _ in range(300):
        state, reward, terminated, truncated, info = env.step(towards_goal(state))
        rewards.append(reward)
        if terminated:
            break
    assert terminated and not truncated and info["is_success"]
    assert info["distance_m"] < ARRIVES_M and info["angle_rad"] < ARRIVES_RAD
    assert rewards[-1] > 0.9 and rewards[0] < rewards[len(rewards) // 2] < 0.0


def test_away_from_the_goal_is_worth_less_and_time_truncates():
    env = make(max_steps=20)
    state, _ = env.reset(seed=3)
    results = [env.step(-towards_goal(state)) for _ in range(20)]
    assert results[-1][1] < results[0][1] and results[-1][3] and not results[-1][2]


def test_the_reward_of_features_grows_on_the_way_home_and_says_what_it_saw():
    env = make(reward="features")
    state, _ = env.reset(seed=3)
    first = last = env.step(towards_goal(state))
    for _ in range(60):
        last = env.step(towards_goal(last[0]))
    assert first[1] < last[1] and last[4]["target_visible"] and last[4]["feature_error"].shape == (4,)
    assert np.abs(last[4]["feature_error"]).max() < 0.1 * np.abs(first[4]["feature_error"]).max()


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_start():
    def episode(seed):
        env = make("ArasServo-Dict-v0")
        observation, _ = env.reset(seed=seed)
        seen = [observation]
        for _ in range(5):
            seen.append(env.step(np.full(6, 0.1, np.float32))[0])
        return seen
    first, again, other = episode(1), episode(1), episode(2)
    for a, b in zip(first, again):
        assert all(np.array_equal(a[key], b[key]) for key in a)
    assert not np.array_equal(first[0]["state"], other[0]["state"])


def test_a_start_may_be_given():
    env = make()
    state, info = env.reset(seed=0, options={"start": {"gantry": 0.15}})
    assert info["distance_m"] == pytest.approx(0.1, abs=0.002)  # 0.1 m along the gantry; friction of the joints
    assert state[:6] == pytest.approx([-0.0, -0.09, 0.045, 0.045, 0.0, 0.15], abs=0.002)


@pytest.mark.parametrize("options, keys", [
    ({"strat": {"gantry": 0.1}}, ["options.strat"]), ({"start": {"gantryy": 0.1}}, ["options.start.gantryy"]),
    ({"start": {"gantry": float("nan"), "J9": 0.1}}, ["options.start.J9", "options.start.gantry"])])
def test_unknown_options_and_joints_are_named(options, keys):
    with pytest.raises(avs.ParameterError) as caught:
        ServoEnv().reset(options=options)
    assert [fault.split(": ")[0] for fault in caught.value.faults] == keys


def test_a_pickled_environment_begins_the_same_episode():
    env = ServoEnv(action="joints", max_steps=5)
    again = pickle.loads(pickle.dumps(env))
    assert (env.reset(seed=3)[0] == again.reset(seed=3)[0]).all()
    assert again.max_steps == 5 and again.action_space == env.action_space
    start = {"gantry": np.float32(0.1)}
    assert (env.reset(options={"start": start})[0] == again.reset(options={"start": start})[0]).all()


def test_the_images_are_those_of_the_camera_and_have_the_size_that_was_asked_for():
    small, whole = make("ArasServo-Image84-v0"), make("ArasServo-Image-v0")
    a, b = small.reset(seed=5)[0], whole.reset(seed=5)[0]
    assert a.shape == (84, 84, 3) and b.shape == (240, 320, 3) and a.dtype == np.uint8
    assert a.min() < 60 and a.max() > 200 and np.ptp(b) > 150  # a dark target on a bright ground


def test_pictures_from_beside_and_from_the_camera():
    for mode, shape in (("rgb_array", (360, 480, 3)), ("camera", (240, 320, 3))):
        env = make(render_mode=mode)
        env.reset(seed=0)
        picture = env.render()
        for _ in range(30):
            env.step(np.array([1.0, 0, 0, 0, 0, 0], np.float32))
        assert picture.shape == shape and not np.array_equal(picture, env.render())


def test_environments_run_in_processes_of_their_own():
    environments = AsyncVectorEnv([functools.partial(make, "ArasServo-Image84-v0")] * 2)
    try:
        seen, _ = environments.reset(seed=[1, 2])
        alone, _ = make("ArasServo-Image84-v0").reset(seed=2)
        assert seen.shape == (2, 84, 84, 3) and np.array_equal(seen[1], alone)
        _, rewards, *_ = environments.step(np.zeros((2, 6), np.float32))
        assert rewards.shape == (2,) and (rewards < 0).all()
    finally:
        environments.close()


@pytest.mark.parametrize("arguments, said", [
    ({"observation": "sound"}, "observation: found 'sound', allowed state | image | dict"),
    ({"action": "torque"}, "action: found 'torque', allowed twist | joints"),
    ({"scenario": "experiment_99"}, "experiment_99")])
def test_what_is_not_allowed_is_named(arguments, said):
    with pytest.raises(avs.ParameterError, match=said.replace("|", r"\|")):
        make(**arguments)
