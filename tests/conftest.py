"""Runs that several tests look at are made once."""
import functools

import pytest


@functools.lru_cache(maxsize=None)
def _run(name, changes):
    from aras_visual_servo_controller.run.judge import run_in_process
    from aras_visual_servo_controller.scenario.scenario import load_scenario

    return run_in_process(load_scenario(name, overrides=dict(changes)))


@pytest.fixture(scope="session")
def run():
    """A function: (scenario name, {dotted path: value}) -> RunRecord of the run in this process."""
    return lambda name, changes=None: _run(name, tuple(sorted((changes or {}).items())))
