#!/usr/bin/env python3
"""Sends one goal to follow_joint_trajectory or gripper_cmd and prints how it ended, as YAML.

    move.py SHOULDER ELBOW SECONDS [cancel|tight|wrong_joints|backwards|not_a_number]
    move.py hand POSITION
"""
import math
import sys

import actionlib
import rospy
import yaml
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryGoal, GripperCommandAction,
                              GripperCommandGoal, JointTolerance)
from trajectory_msgs.msg import JointTrajectoryPoint


def trajectory_goal(shoulder, elbow, seconds, how):
    goal = FollowJointTrajectoryGoal()
    goal.trajectory.joint_names = ["elbow", "shoulder"] if how != "wrong_joints" else ["elbow", "wrist"]
    times = (seconds / 2, seconds) if how != "backwards" else (seconds, seconds / 2)
    for part, time_s in zip((0.5, 1.0), times):
        value = math.nan if how == "not_a_number" else part * shoulder
        goal.trajectory.points.append(JointTrajectoryPoint(positions=[part * elbow, value],
                                                           time_from_start=rospy.Duration(time_s)))
    goal.trajectory.points[-1].velocities = [] if how == "straight" else [0.0, 0.0]
    goal.trajectory.points[0].velocities = [elbow / seconds, shoulder / seconds]
    if how == "tight":
        goal.path_tolerance = [JointTolerance(name="elbow", position=1e-9)]
    return goal


def main():
    words = rospy.myargv()[1:]
    rospy.init_node("move", anonymous=True)
    feedback = []
    if words[0] == "hand":
        client = actionlib.SimpleActionClient("hand_controller/gripper_cmd", GripperCommandAction)
        goal = GripperCommandGoal()
        goal.command.position = float(words[1])
    else:
        client = actionlib.SimpleActionClient("arm_controller/follow_joint_trajectory", FollowJointTrajectoryAction)
        goal = trajectory_goal(*map(float, words[:3]), words[3] if len(words) > 3 else "")
    client.wait_for_server()
    client.send_goal(goal, feedback_cb=feedback.append)
    if words[-1] == "cancel":
        rospy.sleep(0.3)
        client.cancel_goal()
    client.wait_for_result(rospy.Duration(20.0))
    result = client.get_result()
    told = {"state": actionlib.GoalStatus.to_string(client.get_state()), "text": client.get_goal_status_text(),
            "feedback": len(feedback)}
    for key in ("error_code", "error_string", "position", "reached_goal", "stalled"):
        if hasattr(result, key):
            told[key] = getattr(result, key)
    print(yaml.safe_dump(told))


if __name__ == "__main__":
    sys.exit(main())
