"""Visual servoing in Python, without ROS: features, control laws, arms, servo, scenarios and runs.

    import aras_visual_servo as avs

    record = avs.run(avs.load_scenario("experiment_1"))
    print(avs.judge(record).final_error)

`__init__.pyi` lists the public names. Each is imported when it is first used, so that importing the package is cheap.
"""

from typing import Any

try:
    import lazy_loader
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(f"{error}: run your program with /usr/bin/python3, for which Debian's packages are "
                              "installed, or install the wheel", name=error.name) from None

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from .config.files import package_version

        return package_version()
    value = _load(name)
    globals()[name] = value  # found here from now on
    return value
