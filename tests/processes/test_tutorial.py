"""docs/tutorial.md as a student types it: every command, every file, every line that the page says is printed."""
import os
import pathlib
import re
import subprocess

import pytest

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
PAGE = (WORKSPACE / "docs" / "tutorial.md").read_text()
#: What the page may ask of a student: commands typed and lines written.
MOST_COMMANDS, MOST_LINES = 12, 40
MARK = "-- command {} --"


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def steps():
    """[(command, lines that it prints)] of the page, in order; "..." stands for any lines."""
    found = []
    for line in "".join(blocks("console")).splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """What each command prints, typed one after the other into one shell."""
    folder = tmp_path_factory.mktemp("student")
    for language, name in (("python", "my_law.py"), ("yaml", "mine.yaml")):
        [text] = blocks(language)
        (folder / name).write_text(text)
    lines = ["set -e"]
    for number, (command, _) in enumerate(steps()):
        # The folder of the clone is where the student sits; here only what is written there is somewhere else.
        command = re.sub(r"^(\. )?(script|install)/", lambda m: f"{m[1] or ''}{WORKSPACE}/{m[2]}/", command)
        lines += [f"echo '{MARK.format(number)}'", command]
    environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "CMAKE_PREFIX_PATH")}
    result = subprocess.run(["bash", "-c", "\n".join(lines)], cwd=folder, env=environment, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, timeout=1500)
    said = result.stdout.decode()
    assert result.returncode == 0, said + result.stderr.decode()
    return re.split("|".join(re.escape(MARK.format(number)) + "\n" for number in range(len(steps()))), said)[1:]


def test_it_asks_little_of_a_student():
    written = [line for text in blocks("python") + blocks("yaml") for line in text.splitlines() if line.strip()]
    assert len(steps()) <= MOST_COMMANDS and len(written) <= MOST_LINES
    assert (len(steps()), len(written)) == (8, 15), "the page says eight commands and fifteen lines"


@pytest.mark.parametrize("number", range(len(steps())), ids=[command.split("/")[-1][:40] for command, _ in steps()])
def test_a_command_prints_what_the_page_says(printed, number):
    found, at = printed[number].splitlines(), 0
    anywhere = False
    for expected in steps()[number][1]:
        if expected == "...":
            anywhere = True
            continue
        assert expected in found[at:], f"not printed: {expected!r}\n" + printed[number]
        place = found.index(expected, at)
        assert anywhere or place == at, f"not the next line: {expected!r}\n" + printed[number]
        at, anywhere = place + 1, False


def test_the_explained_numbers_are_those_of_the_run():
    import math

    import aras_visual_servo as avs
    scenario = avs.load_scenario("experiment_1")
    record = avs.run(scenario)
    e_mm = 1e3 * abs(record.e[record.servo_rows[0], record.feature_names.index("xn")])
    threshold_mm = 1e3 * scenario.servo["thresholds"]["xn"]
    start_mm, factor, slow_s, fast_s = map(float, re.search(
        r"`xn` is (\d+) mm,.*?factor\s+of (\d+), for which gain 1 takes ln \d+ = ([\d.]+) s and gain 3 takes "
        r"([\d.]+) s", PAGE, re.DOTALL).groups())
    assert round(e_mm, -1) == start_mm and f"its threshold is {threshold_mm:g} mm" in PAGE
    assert factor == start_mm / threshold_mm
    assert (slow_s, fast_s) == (round(math.log(factor), 1), round(math.log(factor) / 3.0, 1))


def test_every_picture_of_the_page_is_there_and_made_by_the_gallery():
    gallery = "".join((WORKSPACE / "script" / "docs" / name).read_text()
                      for name in ("gallery.py", "animation.py"))
    pictures = re.findall(r"\]\((images/\S+)\)", PAGE)
    assert len(pictures) == 2
    for name in pictures:
        assert (WORKSPACE / "docs" / name).stat().st_size > 10_000
        assert pathlib.Path(name).name in gallery or f'"{pathlib.Path(name).stem}"' in gallery
