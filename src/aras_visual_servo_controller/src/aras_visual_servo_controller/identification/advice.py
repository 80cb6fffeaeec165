"""Says which motion tells a parameter that a recording leaves open."""

from typing import Optional

#: A joint moved if its positions span more than this. [m or rad]
LEAST_SPAN = 0.02


def motion_for(name: str, payload_link: Optional[str] = None) -> str:
    """Returns the motion that tells the parameter `JOINT.KEY`, `gravity_scale`, `payload.KEY` or a delay."""
    joint, _, key = name.rpartition(".")
    if joint == "payload":
        return (f"turn {payload_link} about two axes across gravity, and accelerate it, so that its weight acts at "
                "different levers")
    if key in ("damping", "friction"):
        return f"move {joint} alone, both ways over more than {LEAST_SPAN} m or rad, at a slow and a fast speed"
    if key in ("stribeck", "stribeck_velocity"):
        return f"move {joint} alone from rest, very slowly, and turn back often: static friction acts at low speeds"
    if key in ("p", "i", "d", "i_clamp"):
        return f"command {joint} in fast motions both ways, so that it lags visibly behind its commands"
    if key == "gravity_scale":
        return "move a joint that carries weight slowly between postures of different load, both ways"
    return "accelerate the joints more, both ways"
