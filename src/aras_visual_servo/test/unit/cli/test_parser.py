"""What the commands share: examples of --help, the starter, the resolved scenario, tab completion."""

import os
import pathlib
import re
import shlex
import subprocess

import pytest
import yaml

from aras_visual_servo.cli import run
from aras_visual_servo_study.cli import compare, sweep
from aras_visual_servo.cli.parser import PREFIX
from aras_visual_servo.scenario.files import scenario_names
from aras_visual_servo.scenario.scenario import load_scenario

COMMANDS = {"run": run.run_main, "report": run.report_main, "sweep": sweep.sweep_main, "rerun": sweep.rerun_main,
            "compare": sweep.compare_main, "compare_laws": compare.compare_laws_main,
            "compare_runs": compare.compare_runs_main}
CONFIG = pathlib.Path(__file__).resolve().parents[3] / "config"


class Parsed(Exception):
    """The arguments were understood."""


@pytest.mark.parametrize("name", COMMANDS)
def test_help_ends_with_examples_that_the_command_understands(name, capsys, monkeypatch):
    with pytest.raises(SystemExit) as left:
        COMMANDS[name](["--help"])
    said = capsys.readouterr().out
    lines = re.findall(rf"^  {PREFIX} {name} (.*)$", said.split("\nexamples:\n")[1], re.MULTILINE)
    assert left.value.code == 0 and len(lines) >= 2 and max(map(len, said.splitlines())) <= 120

    def stop(_):
        raise Parsed
    for module in (run, sweep, compare):
        monkeypatch.setattr(module, "guarded", stop)
    for line in lines:
        with pytest.raises(Parsed):
            COMMANDS[name](shlex.split(line))


def test_init_writes_a_scenario_that_runs_and_never_writes_over_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run.run_main(["--init", "mine", "experiment_2"]) == 0
    assert "run mine.yaml --in-process" in capsys.readouterr().out
    assert load_scenario("mine.yaml").experiment == load_scenario("experiment_2").experiment
    before = (tmp_path / "mine.yaml").read_text()
    assert run.run_main(["--init", "mine"]) == 2 and "mine.yaml is there already" in capsys.readouterr().err
    assert (tmp_path / "mine.yaml").read_text() == before
    assert run.run_main(["--init", "a/b"]) == 2 and "--init: found 'a/b', allowed letters" in capsys.readouterr().err
    assert run.run_main(["--init", "other", "experiment_99"]) == 2 and not (tmp_path / "other.yaml").exists()


def test_resolve_prints_the_whole_scenario_with_its_overrides(capsys):
    assert run.run_main(["experiment_2", "--resolve", "--set", "sim.seed=3"]) == 0
    assert yaml.safe_load(capsys.readouterr().out) == load_scenario("experiment_2", {"sim.seed": 3}).as_dict()


def test_over_ros_the_launch_gets_the_overrides(tmp_path, monkeypatch):
    given = {}

    def launch(command, *_):
        files = dict(word.split(":=", 1) for word in command if ":=" in word)
        given.update(yaml.safe_load(pathlib.Path(files["scenario_file"]).read_text()))
        pathlib.Path(files["exit_code_file"]).write_text("0")
    from aras_visual_servo_controller.nodes import launch as module
    monkeypatch.setattr(module, "_launch", launch)
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:1")
    assert run.run_main(["experiment_2", "--output", str(tmp_path), "--set", "servo.gains_per_s.xn=1.5"]) == 0
    assert given == load_scenario("experiment_2", {"servo.gains_per_s.xn": 1.5}).as_dict()


def test_the_launch_file_loads_what_a_scenario_extends_and_what_set_says():
    said = subprocess.run(["roslaunch", "--dump-params", "aras_visual_servo_controller", "servo.launch",
                           "scenario:=experiment_2", "set:=sim.seed=3 servo.gains_per_s.xn=1.5"], check=True,
                          stdout=subprocess.PIPE, timeout=240).stdout
    found = yaml.safe_load(said)
    expected = load_scenario("experiment_2", {"sim.seed": 3, "servo.gains_per_s.xn": 1.5}).as_dict()
    scenario = found["/aras_visual_servo/scenario"]
    assert {key: scenario[key] for key in expected if key != "time"} == {
        key: value for key, value in expected.items() if key != "time"}
    assert scenario["time"] == {**expected["time"], "start_paused": True}
    assert not [name for name in found if name.startswith("/aras_visual_servo/scenario/")]  # one parameter, no conflict


def completed(line):
    """What bash offers for a line, by the file that a user sources."""
    installed = pathlib.Path(subprocess.run(["catkin_find", "--share", "aras_visual_servo_controller", "config"],
                                            stdout=subprocess.PIPE, check=True).stdout.decode().split()[0])
    script = f"""
. {shlex.quote(str(installed / "completion.bash"))}
compopt() {{ :; }}
COMP_LINE={shlex.quote(line)}; COMP_POINT=${{#COMP_LINE}}; COMP_TYPE=9
read -ra COMP_WORDS <<<"$COMP_LINE"; [[ $COMP_LINE == *" " ]] && COMP_WORDS+=("")
COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_aras_rosrun
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
    return subprocess.run(["bash", "-c", script], stdout=subprocess.PIPE, check=True, timeout=240,
                          env={**os.environ, "COMP_WORDBREAKS": " \t\n\"'><=;|&(:"}).stdout.decode().split()


def test_tab_completes_scenarios_options_and_keys(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "expert.yaml").write_text("")
    assert set(completed(f"{PREFIX} run exper")) == {"expert.yaml"} | {
        name for name in scenario_names() if name.startswith("exper")}
    assert "--in-process" in completed(f"{PREFIX} run experiment_1 --in")
    assert completed(f"{PREFIX} sweep experiment_1 --set servo.gains") == ["servo.gains_per_s."]
    assert "servo.law=" in completed(f"{PREFIX} run experiment_1 --set servo.l")
