"""Two arms that the simulator moves, with parameters that the fits do not see."""
import numpy as np
from aras_visual_servo_sim import Simulation

from aras_visual_servo_controller.identification.recording import Commands, Recording

URDF = """<robot name="two"><link name="base"/>
<joint name="J1" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="500" velocity="20"/><dynamics damping="{0}" friction="{1}"/></joint>
<link name="a"><inertial><origin xyz="0.05 0.02 -0.2" rpy="0.3 0.1 0"/><mass value="2"/>
  <inertia ixx="0.02" iyy="0.03" izz="0.01" ixy="0.001" ixz="0" iyz="0"/></inertial></link>
<joint name="J2" type="revolute"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
  <origin xyz="0 0 -0.4" rpy="0 0.4 0"/><limit lower="-3" upper="3" effort="500" velocity="20"/>
  <dynamics damping="{2}" friction="{3}"/></joint>
<link name="b"><inertial><origin xyz="0 0.03 -0.15"/><mass value="{4}"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
#: What the fits get: without friction, and without payload.
NOMINAL = URDF.format(0.0, 0.0, 0.0, 0.0, 1.0)
PD = {"p": 900.0, "d": 40.0}


def controllers(kind, **keys):
    return {f"{name}_controller": {"type": kind, "joint": name, **keys} for name in ("J1", "J2")}


def effort_recording(rng, friction, gravity=9.81, extra_kg=0.0, still=(), seconds=14.0, noise=0.15):
    """Efforts, positions and velocities of a motion of sines, at 200 Hz with noise.

    Set points come every period: coarser ones have the derivative act between the samples, unseen. The period is short
    because the weight acts from the state before a period and the friction from that after it, like damping.
    """
    sim = Simulation(URDF.format(*friction, 1.0 + extra_kg), {"gravity_m_s2": [0.0, 0.0, -gravity], "period_s": 0.0005},
                     controllers("effort_controllers/JointPositionController", pid=PD))
    phase = rng.uniform(0.0, 6.28, (2, 3))
    times, rows = [], []
    for tick in range(int(seconds * 2000)):
        goal = np.sum(np.array([0.7, 0.3, 0.15]) * np.sin(np.array([1.1, 2.7, 5.3]) * sim.time_s + phase), axis=1)
        sim.set_command(position={name: 0.0 if name in still else g for name, g in zip(("J1", "J2"), goal)})
        sim.step(1)
        if tick % 10:
            continue
        times.append(sim.time_s)
        rows.append((sim.joint_positions, sim.joint_velocities, sim.joint_efforts))
    q, v, effort = np.array(rows).transpose(1, 0, 2)[:, 200:]
    return Recording(("J1", "J2"), np.array(times)[200:], q + rng.normal(0.0, 1e-5, q.shape),
                     v + rng.normal(0.0, 1e-3, v.shape), effort + rng.normal(0.0, noise, effort.shape))


TABLE = """<robot name="table"><link name="base"/>
<joint name="J1" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
  <limit lower="-9" upper="9" effort="5000" velocity="20"/><dynamics damping="{0}"/></joint>
<link name="a"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="J2" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
  <limit lower="-9" upper="9" effort="5000" velocity="20"/><dynamics damping="{1}"/></joint>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""


def position_recording(rng, gains, damping, delay_s, still=(), seconds=12.0, latency_s=0.004):
    """Positions at 100 Hz and velocity commands at 50 Hz of a table whose velocity loops are of first order.

    Joint j has the time constant M / (p + d) and the gain p / (p + d), with M = 3 and 1 kg.
    """
    arm = controllers("effort_controllers/JointVelocityController")
    for name, p in zip(sorted(arm), gains):
        arm[name]["pid"] = {"p": p}
    sim = Simulation(TABLE.format(*damping), {"command_delay_s": delay_s, "period_s": 0.0005}, arm)
    times, positions, stamps, speeds = [], [], [], []
    for k in range(int(seconds * 100)):
        if k % 2 == 0:
            if k % 40 == 0:
                speed = np.array([0.0 if f"J{i + 1}" in still else v for i, v in enumerate(rng.uniform(-0.5, 0.5, 2))])
            sim.set_command(velocity=dict(zip(("J1", "J2"), speed)))
            stamps.append(sim.time_s)
            speeds.append(speed)
        sim.step(20)
        times.append(sim.time_s)
        positions.append(sim.joint_positions)
    q = np.array(positions)
    received = np.array(times) + latency_s + rng.exponential(5e-4, len(times))
    return Recording(("J1", "J2"), np.array(times), q + rng.normal(0.0, 1e-3, q.shape), received_s=received,
                     commands=Commands("velocity", np.array(stamps), np.array(speeds)))
