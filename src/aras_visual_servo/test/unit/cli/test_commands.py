"""The command `aras-servo`: its verbs, the examples of --help, lines that repeat a command, plugins, completion."""

import errno
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
from dataclasses import replace

import pytest
import yaml

from aras_visual_servo import cli, load_scenario, package_path, scenario_names
from aras_visual_servo.config.files import arm_names
from aras_visual_servo.cli.main import VERBS, alias_main, main, verb_named

DOCS = pathlib.Path(__file__).resolve().parents[5] / "docs"
PROGRAM = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "aras-servo"
COMMANDS = {f"aras-servo {verb}{word}": command for verb in VERBS
            for word, command in ([("", verb_named(verb))] if isinstance(verb_named(verb), cli.Command) else
                                  [(f" {word}", one) for word, one in verb_named(verb).items()])}
EXAMPLES = [shlex.split(f"{prog} {line}")[1:] for prog, command in COMMANDS.items() for line, _ in command.examples]


def run(folder, *words, **environment):
    """(exit code, what is printed) of `aras-servo`, from a folder."""
    done = subprocess.run([sys.executable, str(PROGRAM), *words], cwd=folder, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=240, env={**os.environ, **environment})
    return done.returncode, done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the files that the examples name; its name has a space."""
    folder = tmp_path_factory.mktemp("with space")
    page = (DOCS / "extending.md").read_text()
    for name, language in (("my_servo.py", "python"), ("mine.yaml", "yaml")):
        (folder / name).write_text(re.search(rf"```{language}\n(.*?)```", page, re.DOTALL)[1])
    for name, arm in (("arm", "experiment_1"), ("ur5e", "ur5e")):
        (folder / f"{name}.urdf").write_text(load_scenario(arm).urdf_xml())
    page = (DOCS / "your_arm.md").read_text()
    (folder / "my_arm.urdf").write_text(re.search(r"```xml\n(.*?)```", page, re.DOTALL)[1])
    code, said = run(folder, "sweep", "experiment_1", "--starts", "2", "--workers", "0", "--name", "STAMP", "--set",
                     "servo.time_limit_s=0.5")
    assert code == 0, said
    for name in ("FOLDER_A", "FOLDER_B"):
        shutil.copytree(folder / "results" / "sweeps" / "experiment_1" / "STAMP", folder / name)
    return folder


@pytest.mark.parametrize("words", [["--help"], ["scenario", "list"]], ids=" ".join)
@pytest.mark.parametrize("buffered", ["", "1"], ids=["at the end", "at once"])
def test_a_reader_that_has_gone_ends_the_command_quietly(words, buffered):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run([sys.executable, str(PROGRAM), *words], stdout=writing, stderr=subprocess.PIPE, text=True,
                              timeout=60, env={**os.environ, "PYTHONUNBUFFERED": buffered})
    finally:
        os.close(writing)
    # The argparse of Python 3.12 and later ignores that its help cannot be written.
    ignored = sys.version_info >= (3, 12) and words == ["--help"] and buffered
    assert (done.returncode, done.stderr) == (0 if ignored else 128 + signal.SIGPIPE, "")


def test_a_pipe_that_is_not_the_output_is_an_error_of_the_command(monkeypatch, capsys):
    def broken(arguments):
        raise BrokenPipeError(errno.EPIPE, "the other end of a connection")

    monkeypatch.setitem(verb_named("scenario"), "list", replace(verb_named("scenario")["list"], work=broken))
    assert main(["scenario", "list"]) == cli.EXIT_BROKEN
    assert "the other end of a connection" in capsys.readouterr().err


def test_the_help_lists_every_verb_and_each_verb_ends_with_examples(capsys):
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0
    assert set(VERBS) <= {line.split()[0] for line in capsys.readouterr().out.splitlines() if line.startswith("  ")}
    for prog, command in COMMANDS.items():
        with pytest.raises(SystemExit):
            main([*prog.split()[1:], "--help"])
        said = capsys.readouterr().out
        assert f"  {prog} {command.examples[-1][0]}".rstrip() == said.rstrip("\n").splitlines()[-1].rstrip()
        assert max(map(len, said.splitlines())) <= 140


@pytest.mark.parametrize("words", EXAMPLES, ids=" ".join)
def test_an_example_of_the_help_works_as_printed(words, folder, tmp_path, monkeypatch):
    monkeypatch.chdir(folder)
    verb = words[0]
    if verb in ("run", "robot", "scenario", "rerun") and "--ros" not in words or words[:2] == ["compare", "sweeps"] \
            or words[:2] == ["compare", "runs"] and "STAMP" not in str(words):
        if words[:2] == ["scenario", "new"]:  # it never writes over a file
            monkeypatch.chdir(tmp_path)
        code, said = run(pathlib.Path.cwd(), *("1" if word == "17" else word for word in words))
        assert code in (0, 1) and "Traceback" not in said, said
        return
    arguments = cli.parser_of(f"aras-servo {verb}", verb_named(verb)).parse_args(words[1:])
    if words[:2] == ["compare", "laws"]:
        from aras_visual_servo_study.compare.laws import load_comparison
        assert load_comparison(arguments.comparison, arguments.laws, arguments.tasks, cli.changes_of(arguments),
                               arguments.scenario).scenarios
    elif verb == "benchmark":
        from aras_visual_servo_study.compare.protocols import protocol_named
        cli.changes_of(arguments)
        protocol_named(arguments.protocol).check_own({name: "given" for name in ("board", "meshes")
                                                      if getattr(arguments, name)})
    elif verb in ("run", "live", "sweep"):
        cli.scenario_of(arguments)


@pytest.fixture
def forgotten():
    """What the plugin of docs/extending.md registers is forgotten before and after."""
    from aras_visual_servo.features import base as features
    from aras_visual_servo.laws import base as laws

    def forget():
        sys.modules.pop("my_servo", None)
        features.FEATURES.pop("log_an", None)
        laws.LAWS.pop("bounded", None)
    forget()
    yield
    forget()


def test_the_line_that_repeats_a_run_works_from_any_folder_with_a_law_of_ones_own(folder, tmp_path):
    for words in (["run", "mine.yaml"], ["run", "experiment_1", "--law", "bounded", "--plugins", "my_servo", "--set",
                                         "servo.hold_s=0.3"]):
        code, said = run(folder, *words)
        page = pathlib.Path(folder, re.search(r"report +(.*)", said)[1]).read_text()
        line = re.search(r"<code>(aras-servo run .*?)</code>", page)[1].replace("&#39;", "'")
        again = run(tmp_path, *shlex.split(line)[1:])
        assert again[0] == code == 0, again[1]
        assert re.search(r"run hash .*", again[1])[0] == re.search(r"run hash .*", said)[0]


def test_a_line_that_repeats_leaves_out_where_results_go_and_keeps_quotes(tmp_path):
    parser = cli.parser_of("aras-servo compare", verb_named("compare"))
    arguments = parser.parse_args(["sweeps", "a b", "--fail-if", "success<0.98", "--output", str(tmp_path)])
    assert shlex.split(cli.repeat_line(arguments)) == ["aras-servo", "compare", "sweeps", os.path.abspath("a b"),
                                                       "--fail-if", "success<0.98"]


def test_a_plugin_is_looked_for_beside_the_scenario_then_on_relative_entries_of_pythonpath(
        tmp_path, monkeypatch, forgotten, folder):
    (tmp_path / "mine.yaml").write_text((folder / "mine.yaml").read_text())
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "my_servo.py").write_text((folder / "my_servo.py").read_text())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", "elsewhere")
    assert load_scenario("mine.yaml").servo["plugins"] == [str(tmp_path / "elsewhere" / "my_servo")]
    sys.modules.pop("my_servo")
    monkeypatch.delenv("PYTHONPATH")
    assert load_scenario(folder / "mine.yaml").servo["plugins"] == [str(folder / "my_servo")]


@pytest.mark.parametrize("before, wrong, code", [
    ("@register_feature", "1 / 0\n", 2), ("        inverse = self", "        1 / 0\n", 3),
    ("    works_on, needs_plane", "    def __init__(self, *a):\n        1 / 0\n\n", 3)],
    ids=["import", "twist", "init"])
def test_an_error_of_ones_own_code_names_file_and_line(folder, tmp_path, before, wrong, code):
    text = (folder / "my_servo.py").read_text().replace(before, wrong + before, 1)
    (tmp_path / "my_servo.py").write_text(text)
    (tmp_path / "mine.yaml").write_text((folder / "mine.yaml").read_text())
    found, said = run(tmp_path, "run", "mine.yaml")
    line = [words.strip() for words in text.splitlines()].index("1 / 0") + 1
    assert found == code and f"{tmp_path / 'my_servo.py'}:{line}: " in said and "Traceback" not in said


def test_new_writes_a_scenario_that_runs_and_never_writes_over_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["scenario", "new", "mine", "experiment_2"]) == 0
    assert f"aras-servo run {tmp_path / 'mine.yaml'}" in capsys.readouterr().out
    assert load_scenario("mine.yaml").experiment == load_scenario("experiment_2").experiment
    before = (tmp_path / "mine.yaml").read_text()
    assert f"# Run it:  aras-servo run {tmp_path / 'mine.yaml'}\n" in before
    assert main(["scenario", "new", "mine"]) == 2 and (tmp_path / "mine.yaml").read_text() == before
    assert main(["scenario", "new", "a/b"]) == 2 and "'a/b'" in capsys.readouterr().err
    assert main(["scenario", "new", "other", "experiment_99"]) == 2 and not (tmp_path / "other.yaml").exists()


def test_show_prints_the_whole_scenario_with_its_changes(capsys):
    assert main(["scenario", "show", "experiment_2", "--set", "sim.seed=3", "--law", "ibvs"]) == 0
    assert yaml.safe_load(capsys.readouterr().out) == load_scenario(
        "experiment_2", {"sim.seed": 3, "servo.law": "ibvs"}).as_dict()


def test_check_names_every_scenario_with_faults(capsys):
    assert main(["scenario", "check", "experiment_1", "experiment_2"]) == 0
    assert main(["scenario", "check", "experiment_1", "--set", "sim.period_s=-1"]) == 2
    assert "sim.period_s" in capsys.readouterr().out


@pytest.mark.parametrize("typed, expected", [
    ("run experiment_1", ["run", "--ros", "experiment_1"]),
    ("run experiment_1 --in-process --set sim.seed=3", ["run", "experiment_1", "--set", "sim.seed=3"]),
    ("run --list", ["scenario", "list"]), ("run --init mine experiment_2", ["scenario", "new", "mine", "experiment_2"]),
    ("run mine.yaml --resolve --set sim.seed=3", ["scenario", "show", "mine.yaml", "--set", "sim.seed=3"]),
    ("compare A B", ["compare", "sweeps", "A", "B"]), ("compare_laws canonical", ["compare", "laws", "canonical"]),
    ("compare_runs A B", ["compare", "runs", "A", "B"]), ("sweep mine.yaml", ["sweep", "mine.yaml"])])
def test_rosrun_understands_the_commands_of_2026(typed, expected, monkeypatch):
    verb, *words = typed.split()
    monkeypatch.setattr(sys, "argv", [f"/lib/{verb}", *words])
    monkeypatch.setattr("aras_visual_servo.cli.main.main", lambda argv: argv)
    assert alias_main() == expected


def test_a_package_that_is_not_installed_is_one_clear_error(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "aras_visual_servo_study", None)
    monkeypatch.setitem(sys.modules, "aras_visual_servo_study.cli", None)
    monkeypatch.setitem(sys.modules, "aras_visual_servo_study.cli.sweep", None)
    assert main(["sweep", "experiment_1"]) == cli.EXIT_BROKEN
    assert "aras_visual_servo_study" in capsys.readouterr().err


def test_over_ros_the_launch_gets_the_changes(tmp_path, monkeypatch):
    given = {}

    def launch(command, *_):
        files = dict(word.split(":=", 1) for word in command if ":=" in word)
        given.update(yaml.safe_load(pathlib.Path(files["scenario_file"]).read_text()), repeat=files["repeat"])
        pathlib.Path(files["exit_code_file"]).write_text("0")
    from aras_visual_servo_controller.nodes import launch as module
    monkeypatch.setattr(module, "_launch", launch)
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:1")
    assert main(["run", "experiment_2", "--ros", "--output", str(tmp_path), "--set", "servo.gains_per_s.xn=1.5"]) == 0
    assert given.pop("repeat") == "aras-servo run experiment_2 --set servo.gains_per_s.xn=1.5 --ros"
    assert given == load_scenario("experiment_2", {"servo.gains_per_s.xn": 1.5}).as_dict()


@pytest.mark.parametrize("arm, name", [("", "experiment_2"), ("ur5e", "experiment_2"), ("", "so101")])
def test_the_launch_file_loads_what_a_scenario_extends_and_what_set_says(arm, name):
    said = subprocess.run(["roslaunch", "--dump-params", "aras_visual_servo_controller", "servo.launch", f"arm:={arm}",
                           f"scenario:={name}", "set:=sim.seed=3 servo.gains_per_s.xn=1.5"], check=True,
                          stdout=subprocess.PIPE, timeout=240).stdout
    found, robot = yaml.safe_load(said), {"robot": arm} if arm else {}
    whole = load_scenario(name, {**robot, "sim.seed": 3, "servo.gains_per_s.xn": 1.5})
    expected = whole.as_dict()
    assert found["/aras_visual_servo/robot_description"] == whole.urdf_xml()
    for key, controller in whole.controllers().items():
        assert found[f"/aras_visual_servo/{key}/type"] == controller["type"]
    scenario = found["/aras_visual_servo/scenario"]
    assert {key: scenario[key] for key in expected if key != "time"} == {
        key: value for key, value in expected.items() if key != "time"}
    assert scenario["time"] == {**expected["time"], "start_paused": True}
    assert not [name for name in found if name.startswith("/aras_visual_servo/scenario/")]  # one parameter, no conflict
    assert found["/aras_visual_servo/experiment/repeat"] == (
        f"aras-servo run {name} --ros{' --set robot=' * bool(arm)}{arm} --set sim.seed=3 "
        "--set servo.gains_per_s.xn=1.5")


@pytest.mark.parametrize("words, over", [(["scenario:=mine/scenario.yaml"], "mine/scenario.yaml"),
                                         (["arm:=mine/scenario.yaml", "scenario:=six_dof_points"], "six_dof_points")])
def test_the_launch_file_finds_urdf_and_controllers_of_an_own_arm(words, over, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PWD", str(tmp_path))
    source = package_path("aras_description") / "arms" / "ur5e" / "arm.urdf"
    mesh = "<visual><geometry><mesh filename='part.stl'/></geometry></visual>"
    (tmp_path / "mine.urdf").write_text(re.sub(r'(<link name="tool0")\s*/>', rf"\1>{mesh}</link>", source.read_text()))
    (tmp_path / "part.stl").touch()
    assert main(["robot", "add", "mine.urdf", "--tip", "tool0", "--camera", "camera_optical_frame"]) == 0
    said = subprocess.run(["roslaunch", "--dump-params", "aras_visual_servo_controller", "servo.launch", *words],
                          check=True, stdout=subprocess.PIPE, timeout=240).stdout
    found = yaml.safe_load(said)
    whole = load_scenario(over, {"robot": str(tmp_path / "mine" / "scenario.yaml")})
    assert found["/aras_visual_servo/robot_description"] == whole.urdf_xml() != load_scenario("ur5e").urdf_xml()
    assert f"'{tmp_path / 'part.stl'}'" in whole.urdf_xml()
    for key, controller in whole.controllers().items():
        assert found[f"/aras_visual_servo/{key}/type"] == controller["type"]
    line = found["/aras_visual_servo/experiment/repeat"]
    assert line.count(str(tmp_path / "mine" / "scenario.yaml")) == 1
    [set_as] = re.findall(r"--set (robot=\S+)`", (tmp_path / "mine" / "scenario.yaml").read_text())
    assert main(["scenario", "check", "six_dof_points", "--set", set_as]) == 0


def test_the_launch_file_knows_every_named_arm():
    path = package_path("aras_visual_servo_controller") / "launch" / "servo.launch"
    known = re.search(r"scenario in \[(.*?)\]", path.read_text())[1]
    assert [name.strip("' ") for name in known.split(",")] == sorted(arm_names())


def completed(line):
    """What argcomplete offers for a line."""
    read, write = os.pipe()
    environment = {**os.environ, "_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9",
                   "_ARGCOMPLETE_COMP_WORDBREAKS": " \t\n\"'><;|&(", "_ARGCOMPLETE_IFS": "\n"}
    with os.fdopen(read) as answer:
        done = subprocess.run(["bash", "-c", f"{sys.executable} {PROGRAM} 8>&{write}"], env=environment,
                              pass_fds=[write], timeout=240)
        os.close(write)
        assert done.returncode == 0
        return answer.read().splitlines()


def test_tab_completes_verbs_scenarios_options_and_keys(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "expert.yaml").write_text("")
    assert completed("aras-servo rep") == ["report", "replay-on-twin"]
    assert set(completed("aras-servo run exper")) == {"expert.yaml"} | {
        name for name in scenario_names() if name.startswith("exper")}
    assert "--ros" in completed("aras-servo run experiment_1 --r")
    assert completed("aras-servo compare la") == ["laws "]
    assert completed("aras-servo sweep experiment_1 --set servo.gains") == ["servo.gains_per_s."]
    assert "servo.law=" in completed("aras-servo scenario show experiment_1 --set servo.l")
    assert completed("aras-servo run experiment_1 --law deco") == ["decoupled "]


def test_a_program_of_another_installation_is_refused(tmp_path):
    (tmp_path / "bin").mkdir()
    program = shutil.copy(PROGRAM, tmp_path / "bin" / "aras-servo")
    command = [sys.executable, str(program), "scenario", "list"]
    assert subprocess.run(command, capture_output=True, text=True, timeout=240).returncode == cli.EXIT_PASSED
    package = tmp_path / "lib" / "python3.11" / "site-packages" / "aras_visual_servo"
    package.mkdir(parents=True)
    refused = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert refused.returncode == cli.EXIT_BROKEN
    assert str(package) in refused.stderr and str(pathlib.Path(cli.__file__).parents[1]) in refused.stderr


def test_a_launch_file_refuses_a_robot_that_it_would_not_simulate(tmp_path, capsys):
    mine = tmp_path / "mine.yaml"
    mine.write_text("name: mine\nextends: experiment_1\nrobot: {dynamics: {friction: {J1: 0.5}}}\n")
    assert main(["scenario", "show", str(mine)]) == 0
    assert main(["scenario", "show", "--plain-robot", str(mine)]) == 2
    assert "robot.dynamics" in capsys.readouterr().err
    assert main(["scenario", "show", "--plain-robot", "experiment_1"]) == 0
