"""Two laws from the same random starts, compared in pairs.   python3 examples/05_sweep_and_compare.py"""
import sys

import aras_visual_servo as avs

STARTS = int(sys.argv[1]) if len(sys.argv) > 1 else 20

decoupled = avs.sweep("experiment_1", starts=STARTS)
image_based = avs.sweep("experiment_1", starts=STARTS, law="ibvs", overrides={"servo.interaction": "current"})
for result in (decoupled, image_based):
    print(f"success {result.success.value:.2f}, 95 % between {result.success.low:.2f} and {result.success.high:.2f}")

comparison = avs.compare(decoupled, image_based)
print(comparison)
if comparison.holds("B.success < A.success - 0.05"):
    print("the image-based law loses more than five of a hundred starts")
decoupled.plot("map").savefig("map.png")
