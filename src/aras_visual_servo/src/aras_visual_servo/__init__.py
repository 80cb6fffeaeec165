"""Visual servoing in Python, without ROS: features, control laws, arms, servo, scenarios and runs.

    import aras_visual_servo as avs

    record = avs.run(avs.load_scenario("experiment_1"))
    print(avs.judge(record).final_error)

`__init__.pyi` lists the public names. Each is imported when it is first used, so that importing the package is cheap.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
