"""The servo task as a gymnasium environment, here with a proportional policy.   python3 examples/06_gymnasium.py

gymnasium comes from PyPI: `script/bootstrap --extras` puts it into build/extras, whose Python runs this file.
"""
import gymnasium
import numpy as np

env = gymnasium.make("aras_visual_servo_learning:ArasServo-State-v0", action="twist", reward="pose")
observation, info = env.reset(seed=1)
total, terminated, truncated = 0.0, False, False
while not (terminated or truncated):
    pose = observation[-6:]  # camera in the frame of the goal camera: x, y, z [m], rotation vector [rad]
    action = np.clip(-3.0 * pose / (0.3, 0.3, 0.3, 1.0, 1.0, 1.0), -1.0, 1.0)  # parts of the largest twist
    observation, reward, terminated, truncated, info = env.step(action.astype(np.float32))
    total += reward
print("arrived" if info["is_success"] else "not there", f"at {1000 * info['distance_m']:.2f} mm, return {total:.2f}")
