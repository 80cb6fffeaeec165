"""Pages, tutorial, gallery and API reference are made and run as they are printed."""

import os
import pathlib
import re
import subprocess

import cv2
import pytest
from release import of_debian_12
from ros_graph import Graph, LIMIT_S, until

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
TUTORIAL = (WORKSPACE / "docs" / "tutorial.md").read_text()
#: What the page may ask of a student: commands typed and lines written.
MOST_COMMANDS, MOST_LINES = 12, 40
MARK = "-- command {} --"


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", TUTORIAL, re.DOTALL)


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
    assert (len(steps()), len(written)) == (7, 15), "the page says seven commands and fifteen lines"


@pytest.mark.parametrize("number", [
    pytest.param(number, id=command.split("/")[-1][:40], marks=[of_debian_12] if "sweep" in command else [])
    for number, (command, _) in enumerate(steps())])
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
        r"([\d.]+) s", TUTORIAL, re.DOTALL).groups())
    assert round(e_mm, -1) == start_mm and f"its threshold is {threshold_mm:g} mm" in TUTORIAL
    assert factor == start_mm / threshold_mm
    assert (slow_s, fast_s) == (round(math.log(factor), 1), round(math.log(factor) / 3.0, 1))


def test_every_picture_of_the_page_is_there_and_made_by_the_gallery():
    gallery = "".join((WORKSPACE / "script" / "pictures" / name).read_text()
                      for name in ("gallery.py", "animation.py"))
    pictures = re.findall(r"\]\((images/\S+)\)", TUTORIAL)
    assert len(pictures) == 2
    for name in pictures:
        assert (WORKSPACE / "docs" / name).stat().st_size > 10_000
        assert pathlib.Path(name).name in gallery or f'"{pathlib.Path(name).stem}"' in gallery


ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Pictures that `benchmark map`, `benchmark latency` and `growth.py` of the simulator make.
OTHERS = {"convergence_areas.png", "convergence_points.png", "growth.png", "latency.png"}
LAWS, TASKS, SHORT = ("points_goal", "pbvs"), ("turn_90",), {"servo.time_limit_s": 0.2}


@pytest.fixture
def small(docs, monkeypatch):
    """The module of script/gallery, with little to do."""
    gallery, animation = docs("gallery"), docs("animation")
    load, load_laws, run_laws = gallery.load_scenario, gallery.load_comparison, gallery.run_comparison
    for module in (gallery, animation):
        monkeypatch.setattr(module, "load_scenario", lambda name: load(name, SHORT))
    monkeypatch.setattr(docs("tutorial"), "load_scenario", lambda name, changes: load(name, {**changes, **SHORT}))
    monkeypatch.setattr(gallery, "load_comparison",
                        lambda name, scenario: load_laws(name, LAWS, TASKS, scenario=scenario))
    monkeypatch.setattr(gallery, "run_comparison", lambda comparison, workers: run_laws(comparison, workers=0))
    monkeypatch.setattr(gallery, "LAWS", LAWS)
    monkeypatch.setattr(gallery, "TASKS", TASKS)
    return gallery


def test_every_picture_of_the_pages_and_the_tables_are_made(small, docs, tmp_path):
    images, page = tmp_path / "docs" / "images", tmp_path / "docs" / "comparison.md"
    page.parent.mkdir()
    page.write_text((ROOT / "docs" / "comparison.md").read_text())
    small.main(images)
    made = {path.name for path in images.iterdir()}
    assert made == {path.name for path in (ROOT / "docs" / "images").iterdir()} - OTHERS
    for path in images.iterdir():
        assert path.suffix == ".webp" or cv2.imread(str(path)).std() > 5.0, f"{path.name} shows nothing"
        assert path.read_bytes()[8:12] == b"WEBP" or path.suffix == ".png"
    for table in docs("comparison").TABLES:
        assert set(docs("comparison").read(page.read_text(), table)) == {(law, TASKS[0]) for law in LAWS}


LOOKED_UP = {"public": ("load_scenario", "register_law", "ServoLoop"),
             "aras_visual_servo_learning": ("ServoEnv",),
             "aras_visual_servo.laws": ("sampled_gains",), "aras_visual_servo_sim": ("step_to_image",)}


def test_it_is_built_without_a_warning_and_has_what_people_look_up(tmp_path):
    result = subprocess.run([WORKSPACE / "script" / "docs", tmp_path / "site"], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, timeout=1500)
    assert result.returncode == 0, result.stdout.decode()
    site = tmp_path / "site" / "html"
    for page, names in LOOKED_UP.items():
        html = (site / "api" / f"{page}.html").read_text()
        assert all(f'<span class="pre">{name}</span>' in html for name in names), page
    front = (site / "index.html").read_text()
    for name in ("Tutorials", "How-to guides", "Reference", "Explanation"):
        assert f'<span class="caption-text">{name}</span>' in front
    assert '"conventions"' in (site / "searchindex.js").read_text() and (site / "search.html").is_file()
    assert "http" not in "".join(re.findall(r'<(?:script|link|img)[^>]* (?:src|href)="([^"]*)"', front)), "offline"


PAGE = (pathlib.Path(__file__).resolve().parents[2] / "docs" / "ros.md").read_text()
LINES = [line[2:] for block in re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()]


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lines")
    with Graph(folder) as graph:
        graph.folder = folder
        graph.start("roscore", "-p", str(graph.port))
        until(lambda: "/rosout" in graph.topics(), "a master", graph.log)
        launch, _ = re.findall(r"```\n(roslaunch .*)\n```", PAGE)  # the other one waits for a node of your own
        graph.start("bash", "-c", f"cd {folder} && exec {launch}")
        until(lambda: "/aras_visual_servo/servo_state" in graph.topics() and "/clock" in graph.topics(), "nodes",
              graph.log)
        yield graph


def test_the_page_has_lines_of_every_kind():
    assert len(LINES) > 25
    for kind in ("rostopic pub", "rostopic echo", "rosservice call", "rosparam set"):
        assert any(kind in line for line in LINES)


@pytest.mark.parametrize("line", LINES)
def test_a_line_works(graph, line):
    result = subprocess.run(["bash", "-c", line], env=graph.environment, cwd=graph.folder, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, timeout=2 * LIMIT_S)
    said = result.stdout.decode()
    assert result.returncode == 0 and "ERROR" not in said, said
    assert "success: False" not in said, said
    assert "success: True" in said or "reconfigure" not in line, said
    assert said.strip() or not line.startswith("rostopic echo"), "it prints nothing"
