"""docs/theory.md states the numbers that arm and features have. Unit tests of the packages check its equations."""
import pathlib
import re
import sys

import numpy as np
import pytest
import yaml

import aras_visual_servo as avs

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "src/aras_visual_servo/test/support"))
from toy_plant import Camera, polygon_moments  # noqa: E402
from views import exponential, plane_of  # noqa: E402

PAGE = (ROOT / "docs" / "theory.md").read_text()
STEP_RAD = 1e-5


def test_each_number_stands_for_one_equation_and_the_code_cites_no_other():
    numbers = re.findall(r"^\*\*\((T\d+)\)", PAGE, re.MULTILINE)
    assert len(numbers) == len(set(numbers))
    cited = {number: path for kind in ("py", "hpp", "cpp", "yaml") for path in (ROOT / "src").rglob(f"*.{kind}")
             for number in re.findall(r"(?:\(|theory\.md,? )(T\d+)", path.read_text())}
    unknown = {number: str(path) for number, path in cited.items() if number not in numbers}
    assert len(cited) > 40 and not unknown, unknown


def test_the_wrist_rises_with_the_elbow_by_the_stated_slope():
    scenario = avs.load_scenario("experiment_1")
    wrist = avs.Kinematics(scenario.urdf_xml(), "world", "link5")
    q, slopes = wrist.vector(scenario.experiment["goal"]["joints"]), []
    for name in ("J2", "J3"):
        step = STEP_RAD * np.eye(len(q))[wrist.joint_names.index(name)]
        ahead, behind = wrist.pose(q + step)[:3, 3], wrist.pose(q - step)[:3, 3]
        slopes.append((ahead - behind) / (2.0 * STEP_RAD))
    along = np.argmax(np.abs(slopes[0][:2]))  # the arm's plane stands along an axis: J1 is zero
    rise = slopes[1][2] - slopes[0][2] * slopes[1][along] / slopes[0][along]
    sentence = r"it is ([\d.]+) m/rad, and 1 mm of height asks for ([\d.]+) rad"
    slope, turn = re.search(sentence, " ".join(PAGE.split())).groups()
    assert rise == pytest.approx(float(slope), abs=0.5e-5)
    assert 1e-3 / rise == pytest.approx(float(turn), abs=0.5e-3)


def condition(target: str, pair: tuple, tilt_rad: float) -> float:
    """Returns the condition number of the matrix of (xn, yn, an, pair, alpha), 0.6 m from the target's centroid."""
    text = (ROOT / "src/aras_description/targets" / f"{target}.yaml").read_text()
    outline = np.array(yaml.safe_load(text)["outlines_m"][0])
    m = polygon_moments(outline, 1)
    X = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0, 0, 0, tilt_rad, 0, 0], 1.0)
    X[:3, 3] = -0.6 * X[:3, 2]
    camera = Camera(None, outline - np.array([m["10"], m["01"]]) / m["00"])
    camera.star = (0.6, camera.features(X).area)
    features = avs.FeatureSet(("xn", "yn", "an", *pair, "alpha"))
    return np.linalg.cond(features.matrix(avs.View(camera.features(X), plane_of(X))))


@pytest.mark.parametrize("row, tilt_rad", [("parallel", 0.0), ("tilted", np.radians(15.0))])
def test_condition_numbers_of_the_table(row, tilt_rad):
    cells = iter(re.search(rf"^\| {row} \|(.*)\|$", PAGE, re.MULTILINE)[1].split("|"))
    for pair in (("sx", "sy"), ("px", "py")):
        for target in ("rectangle", "l_shape", "blob"):
            cell, found = next(cells).strip(), condition(target, pair, tilt_rad)
            if cell == "singular":
                assert found > 1e12, (pair, target)
            else:
                assert found == pytest.approx(float(cell), rel=0.005, abs=0.5), (pair, target)
