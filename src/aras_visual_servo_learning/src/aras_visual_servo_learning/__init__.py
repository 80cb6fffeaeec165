"""For learning people: gymnasium environments, and runs and sweeps as data sets.

    import gymnasium
    env = gymnasium.make("aras_visual_servo_learning:ArasServo-State-v0")

With gymnasium installed, importing this package registers the environments. Without it `export` works all the same.
"""

#: id -> what of `ServoEnv` differs from its defaults.
ENVIRONMENTS = {
    "ArasServo-State-v0": {"observation": "state"},
    "ArasServo-Image84-v0": {"observation": "image", "image_size": (84, 84)},
    "ArasServo-Image-v0": {"observation": "image"},
    "ArasServo-Dict-v0": {"observation": "dict"},
    "ArasServo-SixDof-v0": {"scenario": "six_dof_rectangle", "observation": "state"},
}


def register() -> None:
    """Register every environment with gymnasium. Raises MissingExtra: there is none; the message says how to get it."""
    from aras_visual_servo import extra
    gymnasium = extra("gymnasium", "an environment for reinforcement learning")
    for name, arguments in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(name, entry_point=f"{__name__}.environment:ServoEnv", kwargs=dict(arguments))


def _register_if_possible():
    try:
        register()
    except RuntimeError:  # MissingExtra: `environment` says so to who asks for one
        pass


_register_if_possible()
