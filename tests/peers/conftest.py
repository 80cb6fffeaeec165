"""Nothing is collected in a Python without the peers: `script/test peers` makes one that has them."""
import importlib.util

if not all(map(importlib.util.find_spec, ("emva1288", "mujoco", "pinocchio"))):
    collect_ignore_glob = ["test_*.py"]
