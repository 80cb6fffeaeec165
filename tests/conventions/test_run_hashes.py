"""The run hashes of docs/conventions.md are those of runs, on both kinds of processor and both releases of Debian."""
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

import aras_visual_servo as avs
import numpy as np
import pytest
from release import RELEASE

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "conventions.md").read_text()
TABLE = re.search(r"<!-- hashes -->\n(.*?)<!-- end hashes -->", PAGE, re.DOTALL)[1]
ROWS = {name: (fused, plain, drawn_by.strip()) for name, fused, plain, drawn_by in
        re.findall(r"^\| `(\w+)` \| `(\w+)` \| `(\w+)` \|(.*)\|$", TABLE, re.MULTILINE)}
TABLE_13 = re.search(r"<!-- hashes of Debian 13 -->\n(.*?)<!-- end", PAGE, re.DOTALL)[1]
ROWS_13 = {name: (found, drawn_by.strip()) for name, found, drawn_by in
           re.findall(r"^\| `(\w+)` \| `(\w+)` \|(.*)\|$", TABLE_13, re.MULTILINE)}

AVX512 = ("AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL", "-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ")
#: What tells numpy and the C library to do as on another processor.
WITHOUT_AVX512 = {"NPY_DISABLE_CPU_FEATURES": AVX512[0], "GLIBC_TUNABLES": f"glibc.cpu.hwcaps={AVX512[1]}"}
WITHOUT_FMA = {"NPY_DISABLE_CPU_FEATURES": f"AVX F16C FMA3 AVX2 {AVX512[0]}",
               "GLIBC_TUNABLES": f"glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX,-BMI1,-BMI2,{AVX512[1]}"}

RUN = """
import json, sys
import aras_visual_servo as avs
records = [avs.run(avs.load_scenario(name)) for name in sys.argv[1:]]
print(json.dumps([[record.run_hash, record.opengl] for record in records]))
"""


def has(*flags):
    found = re.search(r"^flags\s*:(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return set(flags) <= set(found[1].split() if found else ())


def hashes(names, variables):
    """{name: (run hash, what drew its images by OpenGL)} of runs in a process with these variables."""
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", RUN, *names], env={**os.environ, **variables},
                          stdout=subprocess.PIPE, text=True, check=True)
    return dict(zip(names, map(tuple, json.loads(done.stdout.splitlines()[-1]))))


@pytest.mark.parametrize("column, variables", [(0, {}), (0, WITHOUT_AVX512), (1, WITHOUT_FMA)],
                         ids=["as it is", "without AVX-512", "without FMA"])
def test_runs_have_the_hashes_of_the_page(column, variables):
    if column == 0 and not has("fma", "avx2"):
        pytest.skip("this processor has no AVX2 and FMA")
    assert len(ROWS) == 5 and list(ROWS_13) == list(ROWS)
    if RELEASE == "13" and column == 1:
        pytest.skip("the page has no hashes of Debian 13 without FMA")
    rows = ROWS_13 if RELEASE == "13" else ROWS
    for name, (found, opengl) in hashes(list(rows), variables).items():
        if opengl == rows[name][-1]:  # with another Mesa the images are others
            assert found == rows[name][column], name


def test_the_readme_names_the_hash_of_the_page():
    assert f"`{ROWS['experiment_1'][0]}`" in (ROOT / "README.md").read_text()


def sha256(values):
    return hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()[:12]


def test_simulator_camera_and_kinematics_have_the_same_bytes_on_debian_12_and_13():
    if not has("fma", "avx2"):
        pytest.skip("this processor has no AVX2 and FMA")
    loop = avs.ServoLoop(avs.load_scenario("experiment_1"))
    sim, kinematics, q = loop.sim, loop.kinematics, [0.05, 0.1, 0.2, -0.1, 0.1, 0.3]
    sim.set_command(dict(zip(kinematics.joint_names, q)), {}, None, 0)
    joints = []
    for _ in range(400):
        sim.step(1)
        joints.append(sim.joint_positions.copy())
    image = sim.render(loop.camera)
    assert sha256(joints) == "5133f122216e"
    assert sha256(sim.camera_pose(loop.camera)) == "ca022a53e6db"
    assert sha256(image) == "c174ab17f622"
    assert sha256(loop.extractor.process(image, 1).m) == "7f6a2f52bf97"
    assert sha256(kinematics.pose(np.array(q))) == "06469821da53"
    assert sha256(kinematics.jacobian(np.array(q))) == "729e54400a58"
