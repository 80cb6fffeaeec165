#!/usr/bin/env python3
"""Prints the environments' steps a second of one core, by user CPU time.   build/extras/bin/python rates.py"""
import resource

import gymnasium
import numpy as np

STEPS = 1500


def steps_per_s(name: str, action: str) -> float:
    """Returns the rate of an episode that goes back and forth about its start."""
    env = gymnasium.make(f"aras_visual_servo_learning:{name}", action=action, max_steps=10**9,
                         success=(0.0, 0.0)).unwrapped
    env.reset(seed=0)
    step = np.full(env.action_space.shape, 0.05, np.float32)
    began_s = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    for i in range(STEPS):
        env.step(step if i % 100 < 50 else -step)
    return STEPS / (resource.getrusage(resource.RUSAGE_SELF).ru_utime - began_s)


for environment in ("ArasServo-State-v0", "ArasServo-Image84-v0", "ArasServo-Image-v0"):
    for kind in ("joints", "twist"):
        print(f"{environment:<22}{kind:<8}{steps_per_s(environment, kind):.0f} steps/s")
