"""Measures the relay to ROS 2: images lost, and how much slower a run in lockstep is than over ROS 1.

    . install/setup.sh; python3 src/aras_visual_servo_controller/bench/ros2_door.py [--images 10000] [--runs 5]
Both kinds of runs are experiment_1 without a bag: by the rospy controller, and by the controller of tests/extras in
rclpy. They alternate, and medians are compared. The images are answered by an rclpy node that counts them, in lockstep.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rospy
from std_srvs.srv import Empty

from aras_visual_servo_msgs.msg import SimStatus, VisualServoActionGoal, VisualServoActionResult

ROOT = Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "tests" / "support"))
from ros_graph import Graph  # noqa: E402

NAMESPACE = "/aras_visual_servo/"
ROS2 = [sys.executable, str(ROOT / "src" / "aras_visual_servo" / "scripts" / "aras-servo"), "ros2", "run"]
COUNTER = '''
import sys, rclpy
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image, JointState
from std_srvs.srv import Empty
from aras_visual_servo_msgs.msg import SimStatus
rclpy.init()
node, stamps, wanted = rclpy.create_node("counter"), [], int(sys.argv[1])
commands = node.create_publisher(JointState, "/aras_visual_servo/joint_command", 10)

def on_image(image):
    stamps.append(image.header.stamp.sec * 10**9 + image.header.stamp.nanosec)
    commands.publish(JointState(header=image.header))

node.create_subscription(Image, "/aras_visual_servo/camera/image_raw", on_image, qos_profile_sensor_data)
unpause = node.create_client(Empty, "/aras_visual_servo/sim/unpause")
while not unpause.wait_for_service(1.0):
    pass
armed = []
node.create_subscription(SimStatus, "/aras_visual_servo/sim/status",
                         lambda status: armed.append(status.lockstep_armed), 10)
while not any(armed):
    commands.publish(JointState())
    rclpy.spin_once(node, timeout_sec=0.1)
unpause.call_async(Empty.Request())
while len(stamps) < wanted:
    rclpy.spin_once(node)
print(sum(round((after - before) / (1e9 / 30)) - 1 for before, after in zip(stamps, stamps[1:])), len(stamps))
'''


def graph(folder, port, ros2):
    """servo.launch in lockstep; with ROS 2 the controller is a ROS 2 node."""
    made = Graph(folder, ROS_DOMAIN_ID=str(port % 100))
    made.start("roslaunch", "aras_visual_servo_controller", "servo.launch", "experiment:=false", "guard:=false",
               f"ros2:={str(ros2).lower()}", f"controller:={str(not ros2).lower()}", "start_paused:=true",
               "lockstep:=true", "real_time_factor:=0")
    return made


def over_ros1(folder):
    """Wall time of the run over ROS 1 [s]. In a process of its own, since rospy keeps its master."""
    with graph(folder, 1, False) as made:
        return float(made.output(sys.executable, __file__, "--ros1-client").split()[-1])


def ros1_client():
    """Sends the goal, lets time run, prints how long it took."""
    rospy.init_node("client", disable_signals=True)
    seen = {}
    rospy.Subscriber(NAMESPACE + "sim/status", SimStatus, lambda message: seen.update(status=message))
    goals = rospy.Publisher(NAMESPACE + "servo/goal", VisualServoActionGoal, queue_size=10)
    rospy.wait_for_service(NAMESPACE + "teach")
    time.sleep(2.0)
    goal = VisualServoActionGoal()
    goal.goal.reference, goal.goal.pause_after_s, goal.goal_id.id = "experiment", 2.0, "1"
    goals.publish(goal)
    while not seen["status"].lockstep_armed:
        time.sleep(0.01)
    began_s = time.monotonic()
    rospy.ServiceProxy(NAMESPACE + "sim/unpause", Empty)()
    rospy.wait_for_message(NAMESPACE + "servo/result", VisualServoActionResult)
    while not seen["status"].paused:
        time.sleep(0.001)
    print(time.monotonic() - began_s)


def over_ros2(folder):
    """Wall time of the run over ROS 2 [s]."""
    with graph(folder, 2, True) as made:
        node = ROOT / "tests" / "extras" / "ros2_nodes" / "controller.py"
        return json.loads(made.output(*ROS2, str(node), "experiment_1").splitlines()[-1])["wall_s"]


def lost(folder, images):
    """(images lost, images counted)."""
    program = folder / "counter.py"
    program.write_text(COUNTER)
    with graph(folder, 3, True) as made:
        done = subprocess.run([*ROS2, str(program), str(images)], env=made.environment, stdout=subprocess.PIPE,
                              check=True)
        return tuple(map(int, done.stdout.split()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--images", type=int, default=10000)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--ros1-client", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.ros1_client:
        ros1_client()
        return
    times = {over_ros1: [], over_ros2: []}
    for number in range(arguments.runs):
        for measure, found in times.items():
            with tempfile.TemporaryDirectory() as folder:
                found.append(measure(Path(folder)))
    one, two = (statistics.median(found) for found in times.values())
    print(f"lockstep run: {one:.3f} s over ROS 1, {two:.3f} s over ROS 2, {two / one:.2f} times; "
          f"load {os.getloadavg()[0]:.1f}")
    print(f"  {' '.join(f'{s:.3f}' for s in times[over_ros1])} | {' '.join(f'{s:.3f}' for s in times[over_ros2])}")
    with tempfile.TemporaryDirectory() as folder:
        missing, counted = lost(Path(folder), arguments.images)
    print(f"images: {missing} of {counted} lost")


if __name__ == "__main__":
    main()
