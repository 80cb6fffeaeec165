"""What servo.launch starts for `rviz:=true`, as roslaunch reads it: no ROS master and no display."""
import pathlib

import pytest
import roslaunch.config
import roslaunch.xmlloader

LAUNCH = pathlib.Path(__file__).resolve().parents[3] / "launch" / "servo.launch"


def load(*arguments):
    """(nodes by their whole names, values of the parameters by their names) of servo.launch with these arguments."""
    config = roslaunch.config.ROSLaunchConfig()
    roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(str(LAUNCH), config, argv=[str(LAUNCH), *arguments],
                                                           verbose=False)
    return {node.namespace + node.name: node for node in config.nodes}, \
        {name: parameter.value for name, parameter in config.params.items()}


@pytest.fixture(scope="module")
def plain():
    return load("ns:=left")


@pytest.fixture(scope="module")
def shown():
    return load("ns:=left", "rviz:=true")


def test_rviz_adds_itself_and_what_feeds_it_and_no_second_source_of_what_the_simulator_says(plain, shown):
    assert set(shown[0]) - set(plain[0]) == {"/left/rviz", "/left/rviz_view"}
    assert set(plain[0]) <= set(shown[0])


def test_rviz_opens_the_file_of_the_description_with_the_names_of_its_namespace(shown):
    rviz = shown[0]["/left/rviz"]
    words = rviz.args.split()
    assert words[0] == "-d" and pathlib.Path(words[1]).is_file() and pathlib.Path(words[1]).name == "view.rviz"
    assert ("/aras_visual_servo/camera/image_raw", "camera/image_raw") in map(tuple, rviz.remap_args)


def test_with_rviz_a_run_is_as_fast_as_one_can_watch_and_the_graph_outlives_it(plain, shown):
    assert shown[1]["/left/scenario"]["time"]["real_time_factor"] == 1.0
    assert plain[1]["/left/scenario"]["time"]["real_time_factor"] == 0.0
    assert plain[0]["/left/experiment"].required and not shown[0]["/left/experiment"].required


def test_a_factor_that_is_given_wins_over_that_for_watching():
    _, parameters = load("rviz:=true", "real_time_factor:=3.0")
    assert parameters["/aras_visual_servo/scenario"]["time"]["real_time_factor"] == 3.0
