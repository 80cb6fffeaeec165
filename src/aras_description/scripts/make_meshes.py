#!/usr/bin/env python3
"""Writes the visual meshes of the arm to meshes/visual (binary STL, metres, each in its link's frame).

The shapes are modelled on a small five-axis arm in the manner of the Mitsubishi RV-2AJ, hanging from a linear axis, and
on a six-axis sibling of it (link3_roll, link4):
link frames have z down the arm, x forward, y along the pitch axes. Run without arguments; the output is the same
bytes on every run.
"""

import argparse
import pathlib

import numpy as np

from mesh_shapes import (along_x, along_y, belt, binary_stl, circle, cylinder, lathe, loft, mirrored_pair, moved,
                         rounded_box, rounded_rectangle)

MOUNT_Z_M = 0.02888  # slider frame to the arm's mounting face
RAIL_LENGTH_M = 3.36


def rail():
    """Beam along world y above the slider, hung from the ceiling; frame: world axes at the slider's height."""
    beam = moved(rounded_box((0.10, RAIL_LENGTH_M, 0.09), 0.008), z=0.095)
    hangers = [moved(rounded_box((0.07, 0.08, 0.36), 0.010), y=y, z=0.31) for y in (-1.30, 0.0, 1.30)]
    plates = [moved(rounded_box((0.18, 0.18, 0.014), 0.020), y=y, z=0.497) for y in (-1.30, 0.0, 1.30)]
    return [beam, *hangers, *plates]


def rail_guides():
    """Two linear guides under the beam, a rack between them and the end stops; frame of rail()."""
    guides = [moved(rounded_box((0.016, RAIL_LENGTH_M - 0.06, 0.014), 0.003, chamfer=0.001), x=x, z=0.044)
              for x in (-0.034, 0.034)]
    stops = [moved(rounded_box((0.11, 0.02, 0.11), 0.004), y=y, z=0.085) for y in (-1.69, 1.69)]
    return [*guides, *stops]


def slider():
    """Carriage: plate under the guides, side skirts, mounting block for the arm."""
    plate = rounded_box((0.19, 0.17, 0.030), 0.018, (0.0, 0.0, -0.016))
    block = loft([rounded_rectangle(0.165, 0.150, 0.02, -0.003), rounded_rectangle(0.150, 0.140, 0.02, MOUNT_Z_M)])
    bearings = [rounded_box((0.036, 0.055, 0.018), 0.005, (x, y, -0.038))
                for x in (-0.034, 0.034) for y in (-0.05, 0.05)]
    return [plate, block, *bearings]


def slider_drive():
    """Drive motor and gearbox on the carriage's side."""
    motor = moved(along_y(cylinder(0.026, -0.055, 0.045)), x=-0.118, z=-0.004)
    gear = rounded_box((0.050, 0.052, 0.052), 0.008, (-0.100, 0.058, -0.004))
    return [motor, gear]


def link0():
    """Base of the arm, upside down: mounting plate, tapered column, turret."""
    plate = rounded_box((0.180, 0.160, 0.014), 0.016, (-0.030, 0.0, 0.007))
    column = loft([
        rounded_rectangle(0.160, 0.144, 0.030, 0.012, (-0.028, 0.0)),
        rounded_rectangle(0.158, 0.142, 0.036, 0.060, (-0.026, 0.0)),
        rounded_rectangle(0.136, 0.130, 0.055, 0.118, (-0.010, 0.0)),
        rounded_rectangle(0.126, 0.126, 0.0625, 0.136, (0.0, 0.0))])
    turret = lathe(((0.064, 0.130), (0.066, 0.133), (0.066, 0.159), (0.064, 0.162)))
    return [plate, column, turret]


def link0_connectors():
    """Connector box at the back of the base, with cable glands."""
    box = rounded_box((0.058, 0.112, 0.078), 0.010, (-0.125, 0.0, 0.056))
    glands = [moved(along_x(cylinder(0.011, -0.170, -0.150, segments=24)), y=y, z=0.056) for y in (-0.03, 0.0, 0.03)]
    return [box, *glands]


def link1():
    """Shoulder: turning block that ends in a fork around J2 (at z = 0.132)."""
    block = loft([
        rounded_rectangle(0.118, 0.126, 0.0585, 0.006),
        rounded_rectangle(0.118, 0.140, 0.048, 0.022, (-0.003, 0.0)),
        rounded_rectangle(0.112, 0.150, 0.026, 0.050, (-0.005, 0.0)),
        rounded_rectangle(0.092, 0.146, 0.020, 0.074, (-0.005, 0.0))])
    cheek = belt(0.054, 0.060, 0.056, 0.132, 0.044, 0.076, chamfer=0.006)
    motor = moved(rounded_box((0.040, 0.080, 0.066), 0.012), x=-0.066, z=0.050)
    return [block, mirrored_pair(cheek), motor]


def link1_seam():
    """Seam ring of J1."""
    return [lathe(((0.060, -0.006), (0.060, 0.008)))]


def link2():
    """Upper arm: shoulder hub, tapered beam, elbow hub (J3 at z = 0.25)."""
    shoulder = along_y(cylinder(0.052, -0.043, 0.043, chamfer=0.003))
    elbow = moved(along_y(cylinder(0.041, -0.031, 0.031, chamfer=0.003)), z=0.25)
    beam = loft([
        rounded_rectangle(0.090, 0.080, 0.022, 0.015), rounded_rectangle(0.088, 0.082, 0.022, 0.045),
        rounded_rectangle(0.076, 0.072, 0.020, 0.130), rounded_rectangle(0.066, 0.060, 0.018, 0.205),
        rounded_rectangle(0.062, 0.054, 0.016, 0.235)])
    return [shoulder, elbow, beam]


def link2_shaft():
    """Ends of the shoulder shaft: round covers outside the fork, which turn with the upper arm."""
    return [mirrored_pair(along_y(lathe(((0.042, 0.074), (0.042, 0.080), (0.038, 0.083), (0.012, 0.084)), 32)))]


def link2_covers():
    """Raised covers on both sides of the upper arm."""
    return [mirrored_pair(belt(0.030, 0.075, 0.023, 0.180, 0.030, 0.0425, chamfer=0.003))]


def link3():
    """Forearm: fork around the elbow, tapered body, fork around J5 (at z = 0.16)."""
    elbow_cheek = belt(0.044, 0.0, 0.036, 0.070, 0.033, 0.056, chamfer=0.005)
    body = loft([
        rounded_rectangle(0.066, 0.104, 0.014, 0.046), rounded_rectangle(0.074, 0.106, 0.018, 0.062),
        rounded_rectangle(0.066, 0.092, 0.020, 0.100), rounded_rectangle(0.056, 0.078, 0.018, 0.124)])
    wrist_cheek = belt(0.029, 0.108, 0.030, 0.160, 0.0245, 0.039, chamfer=0.004)
    return [mirrored_pair(elbow_cheek), body, mirrored_pair(wrist_cheek)]


def link3_caps():
    """Round covers of J3 and J5."""
    elbow = along_y(lathe(((0.032, 0.054), (0.032, 0.059), (0.029, 0.062), (0.010, 0.063)), 32))
    wrist = moved(along_y(lathe(((0.021, 0.037), (0.021, 0.041), (0.018, 0.043), (0.008, 0.044)), 32)), z=0.16)
    return [mirrored_pair(elbow), mirrored_pair(wrist)]


def link3_roll():
    """Elbow of the six-axis arm: fork around J3 and the seat of the forearm roll J4 (at z = 0.07)."""
    elbow_cheek = belt(0.044, 0.0, 0.036, 0.052, 0.034, 0.056, chamfer=0.005)
    body = loft([rounded_rectangle(0.066, 0.104, 0.014, 0.046), rounded_rectangle(0.074, 0.106, 0.018, 0.056),
                 rounded_rectangle(0.072, 0.100, 0.030, 0.066)])
    seat = lathe(((0.034, 0.064), (0.036, 0.066), (0.036, 0.070)))
    return [mirrored_pair(elbow_cheek), body, seat]


def link3_roll_caps():
    """Round covers of J3 on the six-axis arm."""
    return [mirrored_pair(along_y(lathe(((0.032, 0.054), (0.032, 0.059), (0.029, 0.062), (0.010, 0.063)), 32)))]


def link4():
    """Forearm of the six-axis arm: turns on J4 (at z = 0), fork around J5 (at z = 0.09)."""
    barrel = lathe(((0.034, 0.001), (0.036, 0.003), (0.036, 0.012)))
    body = loft([rounded_rectangle(0.066, 0.092, 0.028, 0.010), rounded_rectangle(0.062, 0.086, 0.024, 0.030),
                 rounded_rectangle(0.056, 0.078, 0.018, 0.054)])
    wrist_cheek = belt(0.029, 0.038, 0.030, 0.090, 0.0245, 0.039, chamfer=0.004)
    return [barrel, body, mirrored_pair(wrist_cheek)]


def link4_caps():
    """Round covers of J5 on the six-axis arm."""
    wrist = moved(along_y(lathe(((0.021, 0.037), (0.021, 0.041), (0.018, 0.043), (0.008, 0.044)), 32)), z=0.09)
    return [mirrored_pair(wrist)]


def link5():
    """Wrist: pitch hub and the barrel that carries J6 (at z = 0.0718)."""
    hub = along_y(cylinder(0.028, -0.0235, 0.0235))
    barrel = lathe(((0.021, 0.006), (0.0245, 0.014), (0.0265, 0.034), (0.0265, 0.054), (0.0245, 0.057)))
    return [hub, barrel]


def link6():
    """Tool flange and the square camera plate."""
    flange = lathe(((0.022, -0.0150), (0.0225, -0.0140), (0.0225, 0.0000), (0.020, 0.0020), (0.020, 0.0070)))
    plate = rounded_box((0.080, 0.080, 0.0060), 0.016, (0.0, 0.0, 0.0090), chamfer=0.0012)
    screws = [moved(lathe(((0.0040, 0.0110), (0.0040, 0.0145)), 16), x=x, y=y)
              for x in (-0.030, 0.030) for y in (-0.030, 0.030)]
    return [flange, plate, *screws]


def camera():
    """Camera body in camera_link (x forward, optical centre at the origin); it sits behind the centre."""
    body = along_x(rounded_box((0.046, 0.038, 0.0135), 0.006, (0.0, 0.0, -0.01465), chamfer=0.0015))
    cable = moved(along_y(cylinder(0.0035, 0.020, 0.036, chamfer=0.001, segments=20)), x=-0.015)
    return [body, cable]


def camera_lens():
    """Lens barrel and front glass; the front rim lies in the plane of the optical centre."""
    barrel = along_x(loft([circle(radius, x, 36) for radius, x in (
        (0.0150, -0.0090), (0.0150, -0.0060), (0.0128, -0.0056), (0.0128, -0.0006), (0.0122, 0.0), (0.0098, 0.0),
        (0.0080, -0.0022))]))
    return [barrel]


PARTS = (rail, rail_guides, slider, slider_drive, link0, link0_connectors, link1, link1_seam, link2, link2_shaft,
         link2_covers, link3, link3_caps, link3_roll, link3_roll_caps, link4, link4_caps, link5, link6, camera,
         camera_lens)


def meshes():
    """File name -> bytes of each mesh."""
    return {part.__name__ + ".stl": binary_stl(np.concatenate(part())) for part in PARTS}


def main():
    """Writes the files."""
    default = pathlib.Path(__file__).resolve().parent.parent / "meshes" / "visual"
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=pathlib.Path, default=default, help="folder to write to")
    output = parser.parse_args().output
    output.mkdir(parents=True, exist_ok=True)
    for name, content in meshes().items():
        (output / name).write_bytes(content)


if __name__ == "__main__":
    main()
