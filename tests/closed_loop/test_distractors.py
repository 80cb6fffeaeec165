"""Other objects beside the target, in the closed loop: the arm goes to the right one, or stands still and says why."""

import copy

import numpy as np
import pytest
import yaml

import aras_visual_servo as avs

# The promise for coverage images, see test_in_process.py.
COVERAGE_MM_DEG = {"x_mm": 0.2, "y_mm": 0.2, "z_mm": 0.5, "angle_deg": 0.05}
SLAB_M = [[-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]]


def run_beside(others, vision=None):
    """Experiment 1 with more models in the scene, offsets from the target in its plane.

    Returns:
        (RunRecord, most objects counted in one image, how many images were ambiguous).
    """
    document = copy.deepcopy(avs.load_scenario("experiment_1").as_dict())
    models = document["sim"]["scene"]["models"]
    target = dict(models[0])
    for k, (file, x_m, y_m) in enumerate(others):
        position_m = [target["position_m"][0] + x_m, target["position_m"][1] + y_m, target["position_m"][2]]
        models.append(dict(target, name=f"other_{k}", file=str(file or target["file"]), position_m=position_m))
    document["vision"].update(vision or {})
    loop = avs.ServoLoop(avs.scenario_from_dict(document))
    seen, step = [], loop.step

    def counting_step():
        answer = step()
        seen.append((answer[1].components, answer[1].ambiguous))
        return answer

    loop.step = counting_step
    record = loop.run(closing_s=0.1)
    return record, max(count for count, _ in seen), sum(ambiguous for _, ambiguous in seen)


@pytest.fixture
def slab(tmp_path):
    """A rectangle, smaller than the target."""
    path = tmp_path / "slab.yaml"
    path.write_text(yaml.safe_dump({"name": "slab", "color_rgb": [20, 20, 20], "outlines_m": [SLAB_M]}))
    return path


@pytest.mark.parametrize("component", ["largest", "nearest_to_previous", "most_similar"])
def test_arrives_with_another_object_in_view(slab, component):
    record, most, ambiguous = run_beside([(slab, 0.14, 0.0), (slab, -0.02, 0.16)], {"component": component})
    assert most >= 2 and ambiguous == 0
    judgement = avs.judge(record)
    assert judgement.converged, judgement.reason
    for name, bound in COVERAGE_MM_DEG.items():
        assert abs(judgement.final_error[name]) <= bound, (name, judgement.final_error)


def test_a_twin_that_comes_into_view_on_the_way_is_not_taken_for_the_target():
    record, most, _ = run_beside([(None, 0.0, -0.52)])
    assert most == 2
    judgement = avs.judge(record)
    assert judgement.converged, judgement.reason


def test_a_twin_in_view_at_the_goal_ends_it_and_the_arm_stands():
    record, most, ambiguous = run_beside([(None, 0.0, 0.25)])
    assert most == 2 and ambiguous > 0
    assert record.status[-1] == avs.Status.TARGET_LOST and avs.Status.SERVOING not in record.status
    assert np.abs(record.twist).max() == 0.0
