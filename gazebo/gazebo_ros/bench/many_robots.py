#!/usr/bin/env python3
"""What a world of many robots costs, in user CPU seconds of one core.

    many_robots.py [--arms 10] [--seconds 2] [--camera | --ground]

Prints simulated seconds per CPU second with all controllers running, without or with a camera on each arm, and the CPU
seconds that one more arm takes to come into the running world. Each arm has six joints that are driven to and fro by
effort trajectories. Cameras look along the last link, which mostly points to the sky, or, with --ground, ahead and
down, where they see the ground, shadows and other arms.
"""
import argparse
import os
import time
import typing

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.world import World

LENGTHS_M = (0.15, 0.13, 0.4, 0.35, 0.1, 0.08)
MASSES_KG = (4.0, 3.7, 8.0, 2.3, 1.2, 0.6)
AXES = ("0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 1", "0 1 0")
CAMERA = """<gazebo reference="link6"><sensor type="camera" name="eye"><pose>0 0 0.05 0 %s 0</pose>
  <update_rate>30</update_rate><camera><horizontal_fov>1.2</horizontal_fov>
  <image><width>320</width><height>240</height></image><clip><near>0.02</near><far>50</far></clip></camera>
  <plugin name="p" filename="libgazebo_ros_camera.so"><cameraName>eye</cameraName></plugin></sensor></gazebo>"""


LINK = """<link name='link{k}'><inertial><origin xyz='0 0 {middle}'/><mass value='{mass}'/>
    <inertia ixx='{moment}' iyy='{moment}' izz='{moment}' ixy='0' ixz='0' iyz='0'/></inertial>
  <visual>{shape}<material name='m{k}'><color rgba='0.9 0.5 0.1 1'/></material></visual>
  <collision>{shape}</collision></link>"""
SHAPE = "<origin xyz='0 0 {middle}'/><geometry><box size='0.08 0.08 {length}'/></geometry>"
JOINT = """<joint name='j{k}' type='{kind}'><origin xyz='0 0 {offset}'/><parent link='{parent}'/><child link='link{k}'/>
  {axis}</joint>"""
AXIS = """<axis xyz='%s'/><limit lower='-3' upper='3' effort='300' velocity='3'/>
  <dynamics damping='0.5' friction='0.2'/>"""
END = """<transmission name='t%d'><joint name='j%d'><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
  </transmission>"""


PITCH_RAD = {"sky": -1.57, "ground": 0.6}


def arm(camera: str) -> str:
    """A URDF of an arm of the size of a man's, its links boxes that collide.

    Args:
        camera: what its camera sees, a key of PITCH_RAD; empty: it has none.
    """
    links, joints = ["<link name='world'/>"], []
    for k, (length, mass, axis) in enumerate(zip((0.1, *LENGTHS_M), (4.0, *MASSES_KG), ("", *AXES))):
        middle = 0.5 * length
        links.append(LINK.format(k=k, middle=middle, mass=mass, moment=mass * length * length / 12.0 + 0.01,
                                 shape=SHAPE.format(middle=middle, length=length)))
        joints.append(JOINT.format(k=k, kind="revolute" if axis else "fixed", axis=AXIS % axis if axis else "",
                                   offset=0.0 if k < 2 else LENGTHS_M[k - 2],
                                   parent="link%d" % (k - 1) if k else "world"))
    ends = "".join(END % (k, k) for k in range(1, 7))
    ends += CAMERA % PITCH_RAD[camera] if camera else ""
    return ("<robot name='arm'>" + "".join(links) + "".join(joints) + ends +
            "<gazebo><plugin name='c' filename='libgazebo_ros_control.so'/></gazebo></robot>")


NAMES = ["j%d" % k for k in range(1, 7)]
CONTROLLER = {"type": "effort_controllers/JointTrajectoryController", "joints": NAMES,
              "gains": {name: {"p": 2000.0, "i": 10.0, "d": 50.0, "i_clamp": 20.0} for name in NAMES}}


def come(world: World, k: int, camera: str) -> None:
    """One more arm, which begins to move."""
    simulation = world.spawn("arm%d" % k, arm(camera), "/arm%d" % k,
                             matrix_of((1.5 * (k % 5), 2.0 * (k // 5), 0.0), (0, 0, 0, 1), "bench")).simulation
    simulation.load_controller("arm", CONTROLLER)
    simulation.switch_controllers(["arm"])
    points = [(0.5 * (n + 1), [0.3 * (-1) ** n + 0.1] * 6, [0.0] * 6, []) for n in range(40)]
    simulation.pursue_trajectory("arm", NAMES, points)


def run(world: World, seconds: float, camera: str) -> None:
    """Steps as the server does, with a stop for the clock and at every image."""
    end_ns = world.time_ns + round(1e9 * seconds)
    while world.time_ns < end_ns:
        due_ns = [world.core.next_image_ns(name + "::eye") for name in world.models if camera]
        stop_ns = min([(world.time_ns // 10000000 + 1) * 10000000, end_ns, *due_ns])
        world.step(max(1, -(-(stop_ns - world.time_ns) // world.period_ns)))
        for name, due in zip(world.models, due_ns):
            if due == world.time_ns:
                world.core.step_to_image(name + "::eye")
                world.core.render(name + "::eye")


def cpu_s(work: typing.Callable[..., typing.Any], *arguments: typing.Any) -> float:
    """User CPU seconds of this process that a call takes."""
    before = time.process_time()
    work(*arguments)
    return time.process_time() - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arms", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=2.0, help="simulated")
    parser.add_argument("--camera", action="store_const", const="sky", default="",
                        help="320 x 240, 30 Hz, OpenGL, one on each arm")
    parser.add_argument("--ground", action="store_const", const="ground", dest="camera", help="the same, seeing more")
    options = parser.parse_args()
    os.environ.setdefault("LP_NUM_THREADS", "0")
    world = World()
    for k in range(options.arms - 1):
        come(world, k, options.camera)
    run(world, 0.2, options.camera)
    print("one more arm into the running world: %.3f s" % cpu_s(come, world, options.arms - 1, options.camera))
    run(world, 0.2, options.camera)
    rate = options.seconds / cpu_s(run, world, options.seconds, options.camera)
    seeing = " with cameras that see the " + options.camera if options.camera else ""
    print("%d arms%s: %.2f simulated seconds per CPU second" % (options.arms, seeing, rate))


if __name__ == "__main__":
    main()
