"""The commands `run` and `report`: arguments, exit codes, what is said."""

import errno
import os
import pathlib

import pytest
from synthetic import make_record

from aras_visual_servo import cli, ModelError, ParameterError
from aras_visual_servo.cli.main import main
from aras_visual_servo.runs import judge as experiment
from aras_visual_servo_controller.nodes import launch


@pytest.fixture
def runs(monkeypatch):
    """run replaced; the scenarios it was called with."""
    calls = []

    def run(scenario, progress=None):
        calls.append(scenario)
        return make_record(scenario=scenario.name)

    monkeypatch.setattr(experiment, "run", run)
    return calls


def test_a_run_in_process_writes_its_folder_and_prints_the_table(runs, tmp_path, capsys):
    assert main(["run", "experiment_1", "--output", str(tmp_path)]) == cli.EXIT_PASSED
    [folder] = (tmp_path / "experiment_1").iterdir()
    assert (folder / "report.html").is_file()
    assert "PASSED" in capsys.readouterr().out


def test_overrides_reach_the_run_and_the_report(runs, tmp_path):
    main(["run", "experiment_1", "--output", str(tmp_path), "--set", "servo.gains_per_s.xn=1.5"])
    assert runs[0].servo["gains_per_s"]["xn"] == 1.5
    [page] = tmp_path.glob("experiment_1/*/report.html")
    assert "aras-servo run experiment_1 --set servo.gains_per_s.xn=1.5" in page.read_text()


def test_a_run_that_missed_the_goal_exits_with_one(monkeypatch, tmp_path):
    monkeypatch.setattr(experiment, "run", lambda scenario, progress=None: make_record((0.01, 0, 0)))
    assert main(["run", "experiment_1", "--output", str(tmp_path)]) == cli.EXIT_FAILED


def test_a_wrong_scenario_exits_with_two_and_says_why(runs, tmp_path, capsys):
    assert main(["run", "experiment_1", "--output", str(tmp_path), "--set", "sim.sed=3"]) == 2
    assert "sim.sed: " in capsys.readouterr().err and not runs


def test_a_folder_that_cannot_be_written_stops_before_the_run(runs, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["run", "experiment_1", "--output", str(tmp_path / "file")]) == cli.EXIT_BROKEN
    assert "cannot be written" in capsys.readouterr().err and not runs


def test_an_error_of_the_run_exits_with_three(monkeypatch, tmp_path, capsys):
    def broken(scenario, progress=None):
        raise ModelError("joint 'J9': unknown")

    monkeypatch.setattr(experiment, "run", broken)
    assert main(["run", "experiment_1", "--output", str(tmp_path)]) == cli.EXIT_BROKEN
    assert "joint 'J9': unknown" in capsys.readouterr().err


def test_a_run_over_ros_gives_the_exit_code_of_the_experiment_node(monkeypatch, tmp_path):
    commands = []

    class Roslaunch:
        def __init__(self, command, **_):
            if command[0] == "roslaunch":  # not the guard
                commands.append(command)
                outcome = next(word for word in command if word.startswith("exit_code_file:="))
                pathlib.Path(outcome.partition(":=")[2]).write_text("1\n")

        def wait(self):
            return 0  # what roslaunch ends with, whatever became of its nodes

        def communicate(self, _words):
            pass
    monkeypatch.setattr(launch.subprocess, "Popen", Roslaunch)
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:1")
    assert main(["run", "experiment_1", "--ros", "--output", str(tmp_path)]) == cli.EXIT_FAILED
    assert commands[0][:4] == ["roslaunch", "--skip-log-check", "aras_visual_servo_controller", "servo.launch"]
    assert commands[0][4].startswith("scenario:=/") and commands[0][4].endswith("experiment_1.yaml")
    assert f"results_dir:={tmp_path}" in commands[0]


def test_a_log_that_cannot_be_kept_does_not_hide_why_the_run_failed(monkeypatch, tmp_path, capsys):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    folder, log = tmp_path / "results" / "today", tmp_path / "roslaunch.log"
    folder.mkdir(parents=True)
    log.write_text("[FATAL] summary.json: cannot be written: No space left on device\n")
    monkeypatch.setattr(launch.shutil, "copyfile", full)
    launch._tell(folder.parent, set(), log, 3)
    said = capsys.readouterr().err
    assert "roslaunch.log cannot be written: No space left on device" in said
    assert "[FATAL] summary.json: cannot be written" in said and "exit code 3" in said


def test_the_namespace_of_a_run_is_checked_and_reaches_the_launch_file(monkeypatch, tmp_path, capsys):
    given = []
    monkeypatch.setattr(launch, "run_over_ros", lambda *_, namespace, **__: given.append(namespace) or 0)
    assert main(["run", "experiment_1", "--ros", "--output", str(tmp_path), "--namespace", "/left/arm"]) == 0
    assert given == ["/left/arm"]
    for name in ("a b", "1a", "/", "a//b", "~a"):
        assert main(["run", "experiment_1", "--ros", "--namespace", name]) == cli.EXIT_PARAMETERS
        assert f"--namespace: found '{name}', allowed is a name of ROS" in capsys.readouterr().err


def test_the_list_names_every_shipped_scenario(capsys):
    assert main(["scenario", "list"]) == 0
    assert {"experiment_1", "experiment_2"} <= {line.split()[0] for line in capsys.readouterr().out.splitlines()}


def test_overrides_are_yaml_values_and_the_bad_ones_are_all_named():
    assert cli.parse_overrides(["a.b=2", "c=[1, x]", "d=true"]) == {"a.b": 2, "c": [1, "x"], "d": True}
    with pytest.raises(ParameterError) as caught:
        cli.parse_overrides(["nonsense", "a=[", "b=1"])
    assert len(caught.value.faults) == 2
