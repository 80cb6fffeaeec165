"""The C++ packages share their errors; in Python each module raises its own, also when both are loaded."""
import pytest

import aras_visual_servo_camera as camera
import aras_visual_servo_sim as sim


def test_each_module_raises_errors_of_its_own():
    for _ in range(2):
        with pytest.raises(sim.ArasError) as of_the_simulator:
            sim.Simulation("<robot name='broken'", {})
        assert not isinstance(of_the_simulator.value, camera.ArasError)
        with pytest.raises(camera.ParameterError) as of_the_camera:
            camera.MomentExtractor({}, {})
        assert not isinstance(of_the_camera.value, sim.ArasError)
