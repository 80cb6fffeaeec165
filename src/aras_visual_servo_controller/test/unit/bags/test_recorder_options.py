"""Command line of the recorder node: what cannot be meant is refused before a bag is touched. No master needed."""
import subprocess

import pytest


@pytest.mark.parametrize("words, part", [
    ([], "-O"),
    (["-O"], "-O: the value is missing"),
    (["-O", "run.txt", "/clock"], "ends in .bag"),
    (["-O", "run.bag"], "no topic"),
    (["-O", "run.bag", "--zip", "/clock"], "--zip: unknown"),
    (["-O", "run.bag", "--split", "/clock"], "--size"),
    (["-O", "run.bag", "--split", "--size", "-5", "/clock"], "found '-5'"),
])
def test_bad_words_are_named(words, part, tmp_path):
    result = subprocess.run(["rosrun", "aras_visual_servo_controller", "recorder", *words], cwd=tmp_path,
                            capture_output=True, text=True, timeout=30)
    assert result.returncode == 2
    assert part in result.stderr
    assert list(tmp_path.iterdir()) == []
