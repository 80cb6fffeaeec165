"""What is counted: some frames of experiment_1 in process. counts.py runs this under callgrind, see there.

The counts begin when the simulator is reset the second time, and end when its run hash is asked for.
"""
import sys

from aras_visual_servo.runs.loop import ServoLoop
from aras_visual_servo.runs.record import RecordBuilder
from aras_visual_servo.scenario.scenario import load_scenario

#: Frames of each way of the loop: the arm drives, rests, and servos.
FRAMES = 40
WARM_UP = 3


def servo(loop, frames):
    """Teach where the arm is, move it a little, and servo back for that many frames, with a record."""
    scenario = loop.scenario
    builder = RecordBuilder(scenario.name, loop.kinematics.joint_names, settings=scenario.as_dict(),
                            feature_names=loop.servo.feature_names)
    goal = scenario.experiment["goal"]["joints"]
    loop.place(goal)
    list(loop.teach(scenario.experiment["z_star_m"]))
    loop.place({name: q + 0.01 for name, q in goal.items()})
    loop.start(servo_only=True)
    for _ in range(frames):
        record, features, image = loop.step()
        builder.add_answer(record, loop.camera_pose(), features, image, loop.moving_target_pose())
    return record


def main():
    scenario = load_scenario("experiment_1")
    loop = ServoLoop(scenario)
    servo(loop, WARM_UP)
    loop = ServoLoop(scenario, sim=loop.sim)  # resets the simulator
    record = servo(loop, FRAMES)
    print(loop.sim.run_hash, record.status.name, loop.sim.ticks, loop.frame + 1)


if __name__ == "__main__":
    sys.exit(main())
