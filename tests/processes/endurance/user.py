"""A node that uses one ROS graph as a user does who never goes home: goals, resets, models that come and go.

    user.py MINUTES SEED FOLDER [USE ...]     in a graph of servo.launch with experiment:=false and start_paused:=true

It prints `ready`, then of each goal `goal RUN_HASH TRACE_HASH PUBLISHED RECORDED` with the numbers of messages of
all topics, `lost SENTENCE` for each note of the record, and `said NODE LEVEL TEXT` for each warning or error that a
node gives.
"""
import random
import sys
import time

import rospy
from geometry_msgs.msg import Point, Pose, Quaternion
from rosgraph_msgs.msg import Log

from aras_visual_servo_msgs.msg import ServoState
from aras_visual_servo_msgs.srv import DeleteModel, SpawnModel

import goals as goals_module

LATE_MODEL = "late_box"
BOX = "{box_m: [0.02, 0.02, 0.02], position_m: [0.0, 0.0, 0.0]}"
RATE_HZ, TICK_NS = 30, 1_000_000  # of the first camera, of the simulator
USES = ("one_goal", "resets", "models")
STEPS = 200  # physics steps between a model's coming and its going


def image_ns(number):
    """Stamp of an image of the first camera: the first tick at its time or later."""
    return -(-number * 10**9 // RATE_HZ // TICK_NS) * TICK_NS


class User(goals_module.Goals):
    """Uses the graph; which use comes next is drawn from a seed."""

    def __init__(self, folder, seed, uses):
        super().__init__(folder)
        self._uses = uses or ("one_goal", *USES)  # goals twice as often as the others
        self._random = random.Random(seed)
        self._spawn = rospy.ServiceProxy("sim/spawn_model", SpawnModel)
        self._delete = rospy.ServiceProxy("sim/delete_model", DeleteModel)
        self._answered_ns = -1
        rospy.Subscriber("servo_state", ServoState, self._on_state)
        rospy.Subscriber("/rosout_agg", Log, self._on_log)

    @staticmethod
    def _on_log(message):
        if message.level >= Log.WARN:
            print("said", message.name, message.level, message.msg.replace("\n", " "), flush=True)

    def _on_state(self, message):
        self._answered_ns = message.header.stamp.to_nsec()

    def _walk(self, steps):
        """Step, and wait until the last image was answered, which may have been before."""
        end_ns = self._step(steps).stamp.to_nsec()
        last_ns = max(at_ns for at_ns in map(image_ns, range(end_ns * RATE_HZ // 10**9 + 1)) if at_ns <= end_ns)
        self._wait("the answer to the last image", lambda: [] if self._answered_ns >= last_ns else ["it"],
                   self._startup_timeout_s)

    def use(self):
        """One use of the graph."""
        getattr(self, self._random.choice(self._uses))()

    def one_goal(self):
        """A goal, recorded."""
        record, found = self.goal()
        for note in record.notes:
            print("lost", note, flush=True)
        counts = record.recorded.values()
        print("goal", *found, sum(count["published"] for count in counts),
              sum(count["in_bag"] for count in counts), flush=True)

    def resets(self):
        """Some resets, each after some steps."""
        self._pause()
        for _ in range(self._random.randint(1, 5)):
            self._walk(self._random.randint(1, STEPS))
            self._reset()
            self._answered_ns = -1  # of the time that begins

    def models(self):
        """A model comes, is seen, and goes."""
        self._pause()
        place = Pose(Point(self._random.uniform(-0.1, 0.1), 0.0, 0.3), Quaternion(w=1.0))
        answer = self._spawn(model_name=LATE_MODEL, model_xml=BOX, initial_pose=place)
        if not answer.success:
            raise goals_module.RunError(f"spawn_model: {answer.status_message}")
        self._walk(STEPS)
        self._delete(model_name=LATE_MODEL)


def main():
    """Entry. Returns the exit code."""
    minutes, seed, folder = float(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    rospy.init_node("experiment", disable_signals=True)
    user = User(folder, seed, sys.argv[4:])
    print("ready", flush=True)
    end_s = time.monotonic() + 60.0 * minutes
    while time.monotonic() < end_s:
        user.use()
    print("end", flush=True)
    return 0


if __name__ == "__main__":
    goals_module.end(main())
