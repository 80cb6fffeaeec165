#!/usr/bin/env python3
"""Bad parameters end the nodes with exit code 2, all faults in one message; a bad result folder with 3."""
import subprocess
import sys
import unittest

import rospy
import yaml

from aras_visual_servo.scenario.scenario import load_scenario

PACKAGE = "aras_visual_servo_controller"
LIMIT_S = 60.0


def run(node, namespace, **private):
    """(exit code, output) of a node started in that namespace with these private parameters."""
    words = [f"_{key}:={value}" for key, value in private.items()]
    done = subprocess.run(["rosrun", PACKAGE, node, f"__ns:={namespace}"] + words, capture_output=True, text=True,
                          timeout=LIMIT_S)
    return done.returncode, done.stdout + done.stderr


class BadParameters(unittest.TestCase):
    def set_up(self, namespace, change):
        """Load experiment_1, changed, into a namespace."""
        scenario = load_scenario("experiment_1")
        document = yaml.safe_load(yaml.safe_dump(scenario.as_dict()))
        change(document)
        rospy.set_param(f"{namespace}/scenario", document)
        rospy.set_param(f"{namespace}/robot_description", scenario.urdf_xml())

    def test_controller_lists_every_fault_and_exits_with_2(self):
        def change(document):
            document["servo"]["gains_per_s"]["xn"] = -1.0
            document["servo"]["no_such_key"] = 1
            del document["experiment"]["z_star_m"]
        self.set_up("/faults", change)
        code, output = run("controller", "/faults")
        self.assertEqual(code, 2, output)
        for word in ("xn", "no_such_key", "z_star_m"):
            self.assertIn(word, output)

    def test_controller_checks_section_robot_as_the_scenario_does(self):
        def change(document):
            del document["robot"]["base_link"]
            document["robot"]["tip"] = "camera"
        self.set_up("/robot", change)
        code, output = run("controller", "/robot")
        self.assertEqual(code, 2, output)
        for word in ("robot/base_link: found nothing", "robot/tip: unknown key"):
            self.assertIn(word, output)

    def test_controller_without_any_parameter_names_what_is_missing(self):
        code, output = run("controller", "/nothing")
        self.assertEqual(code, 2, output)
        for word in ("robot", "servo", "experiment", "robot_description"):
            self.assertIn(word, output)

    def test_controller_refuses_an_unknown_private_parameter(self):
        self.set_up("/unknown", lambda document: None)
        code, output = run("controller", "/unknown", comand_interface="float64")
        self.assertEqual(code, 2, output)
        self.assertIn("comand_interface", output)

    def test_experiment_with_a_folder_that_cannot_be_made_exits_with_3(self):
        self.set_up("/folder", lambda document: None)
        code, output = run("experiment", "/folder", results_dir="/dev/null/results")
        self.assertEqual(code, 3, output)
        self.assertIn("/dev/null", output)

    def test_experiment_with_a_faulty_scenario_exits_with_2(self):
        self.set_up("/scenario", lambda document: document["servo"].update(mode="no_such_mode"))
        code, output = run("experiment", "/scenario", results_dir="/tmp")
        self.assertEqual(code, 2, output)
        self.assertIn("no_such_mode", output)


if __name__ == "__main__":
    import rostest
    rostest.rosrun(PACKAGE, "bad_parameters", BadParameters, sys.argv)
