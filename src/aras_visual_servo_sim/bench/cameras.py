#!/usr/bin/env python3
"""Frames a second of a camera drawn by OpenGL. The last word printed is the figure.

    cameras.py SCENE [--size 320x240] [--depth] [--gl osmesa] [--seconds 2] [--save FILE.png]
    cameras.py all --gl egl     a table of all scenes and sizes on the GPU

With OSMesa they are frames a second of CPU time of one thread. With EGL, which may draw on a GPU, they are those of
wall time, read-back included; the table begins with the name of what drew.

SCENE, seen from 0.6 m above but for the last two:
    flat, textured    a plane of one colour, or with a checkerboard; textured_samples: four samples a pixel
    boxes, shadows    ten boxes on a plane, without or with shadows; everything: textured, four samples, shadows
    arm               the arm of this workspace over a table with a target, its own camera, all of it lit, no shadows,
                      one sample; arm_everything: with shadows and four samples
    meshes            an arm of seven links of 12000 triangles each, seen from 2 m, shadows, four samples
"""
import argparse
import math
import os
import struct
import tempfile
import time
import zlib

os.environ.setdefault("LP_NUM_THREADS", "0")  # before the first call of OpenGL

from aras_visual_servo_sim import opengl_description, Simulation  # noqa: E402

SCENES = ("flat", "textured", "textured_samples", "boxes", "shadows", "everything", "arm", "arm_everything", "meshes")
SIZES = ("320x240", "640x480", "800x800", "1000x1000", "1920x1080")

FIXED = """<robot name="stand"><link name="world"/><link name="eye"/><joint name="j" type="fixed"><parent link="world"/>
<child link="eye"/><origin xyz="%s" rpy="%s"/></joint></robot>"""
SUN = {"name": "sun", "type": "directional", "direction": [0.3, 0.2, -1.0]}
DOWN = FIXED % ("0 0 0.6", "3.141592653589793 0 0")
BESIDE = FIXED % ("1.6 0 1.4", "-2.2 0 1.5707963")
LINKS, RINGS, SIDES = 7, 60, 100


def write_png(path, size, pixel):
    """An RGB picture of size x size, pixel(u, v) -> three bytes."""
    rows = b"".join(b"\0" + b"".join(pixel(u, v) for u in range(size)) for v in range(size))
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in chunks:
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def checkered_plane(folder):
    """A square of 6 m with a checkerboard of 4 x 4 pictures of 512 x 512 texels; returns its file."""
    dark, light = bytes((26, 51, 77)), bytes((204, 179, 153))
    write_png(os.path.join(folder, "checker.png"), 512, lambda u, v: dark if (u < 256) == (v < 256) else light)
    with open(os.path.join(folder, "plane.mtl"), "w", encoding="ascii") as file:
        file.write("newmtl m\nKd 1 1 1\nmap_Kd checker.png\n")
    corners = ((-3, -3), (3, -3), (3, 3), (-3, 3))
    with open(os.path.join(folder, "plane.obj"), "w", encoding="ascii") as file:
        file.write("mtllib plane.mtl\nusemtl m\n" + "".join("v %g %g 0\n" % corner for corner in corners) +
                   "".join("vt %g %g\n" % (2 * (x + 3) / 3, 2 * (y + 3) / 3) for x, y in corners) +
                   "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n")
    return os.path.join(folder, "plane.obj")


def link_mesh(folder):
    """A closed body of 12000 triangles, 0.3 m long, waisted and ribbed; returns its file."""
    lines = []
    for k in range(RINGS + 1):
        z, ribs = 0.3 * k / RINGS, 1.0 + 0.1 * math.sin(40.0 * k / RINGS)
        radius = 0.0 if k in (0, RINGS) else (0.06 - 0.02 * math.sin(math.pi * k / RINGS)) * ribs
        lines += ["v %.6f %.6f %.6f" % (radius * math.cos(2 * math.pi * i / SIDES),
                                        radius * math.sin(2 * math.pi * i / SIDES), z) for i in range(SIDES)]
    for k in range(RINGS):
        for i in range(SIDES):
            a, b = k * SIDES + i + 1, k * SIDES + (i + 1) % SIDES + 1
            lines += ["f %d %d %d" % (a, b, b + SIDES), "f %d %d %d" % (a, b + SIDES, a + SIDES)]
    with open(os.path.join(folder, "link.obj"), "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")
    return os.path.join(folder, "link.obj")


def meshed_arm(path):
    """A URDF of LINKS such bodies one after another, each turned against the one before, and the camera's stand."""
    links, joints = ['<link name="world"/>', '<link name="eye"/>'], [
        '<joint name="stand" type="fixed"><parent link="world"/><child link="eye"/><origin xyz="1.6 0 1.4" '
        'rpy="-2.2 0 1.5707963"/></joint>']
    for k in range(LINKS):
        links.append('<link name="l%d"><inertial><mass value="1"/><inertia ixx=".01" iyy=".01" izz=".01" ixy="0" '
                     'ixz="0" iyz="0"/></inertial><visual><geometry><mesh filename="file://%s"/></geometry></visual>'
                     '</link>' % (k, path))
        joints.append('<joint name="q%d" type="revolute"><parent link="%s"/><child link="l%d"/><origin xyz="0 0 %g"/>'
                      '<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="100" velocity="3"/></joint>'
                      % (k, "l%d" % (k - 1) if k else "world", k, 0.3 if k else 0.0))
    return '<robot name="meshed">%s%s</robot>' % ("".join(links), "".join(joints))


def simulation_of(scene, size, folder, gl="osmesa"):
    """The world, and the joints that move between images."""
    width, height = size
    camera = {"name": "camera", "frame": "eye", "width": width, "height": height, "renderer": "opengl", "gl": gl,
              "far_m": 20.0, "fx_px": 195.0 / 320 * width, "fy_px": 195.0 / 320 * width}
    everything = scene.endswith("everything") or scene == "meshes"
    if not everything and scene != "textured_samples":
        camera["sampling"] = "center"
    shadows = everything or scene == "shadows"
    config = {"cameras": [camera], "scene": {"lighting": {"lights": [dict(SUN, casts_shadows=shadows)]}}}
    floor = {"name": "floor", "material": {"casts_shadows": False}}
    if scene.startswith("arm"):
        camera.update(frame="camera_optical_frame")
        solids = [dict(floor, box_m=[3.0, 4.0, 0.02], position_m=[0.0, 0.0, 0.18]),
                  {"name": "target", "box_m": [0.12, 0.08, 0.002], "position_m": [0.03, 0.05, 0.191],
                   "color_rgb": [20, 20, 20]}]
        config["scene"]["solids"] = solids
        return Simulation("package://aras_description/urdf/aras_arm.urdf", config), ("J2", "J6")
    if scene == "meshes":
        config["scene"]["solids"] = [dict(floor, box_m=[20.0, 20.0, 0.1], position_m=[0.0, 0.0, -0.05])]
        return Simulation(meshed_arm(link_mesh(folder)), config), ["q%d" % k for k in range(LINKS)]
    if scene.startswith("textured") or scene == "everything":
        floor["mesh"] = checkered_plane(folder)
    else:
        floor.update(box_m=[6.0, 6.0, 0.02], position_m=[0.0, 0.0, -0.01])
    solids = [floor]
    if scene in ("boxes", "shadows", "everything"):
        solids += [{"name": "box%d" % k, "box_m": [0.1, 0.1, 0.1], "color_rgb": [204, 77, 51],
                    "position_m": [-0.25 + 0.1 * (k % 5), -0.1 + 0.2 * (k // 5), 0.05]} for k in range(10)]
    config["scene"]["solids"] = solids
    return Simulation(DOWN, config), ()


def frames_per_s(simulation, joints, seconds, depth, clock=time.process_time):
    """Everything moves a little between images, so that nothing can be kept."""
    frames, used_s, place = 0, 0.0, {joint: 0.05 * (-1) ** k for k, joint in enumerate(joints)}
    while used_s < seconds:
        place = {joint: value + 1e-4 * (1 if frames % 200 < 100 else -1) for joint, value in place.items()}
        if joints:
            simulation.set_joint_positions({**dict(zip(simulation.joint_names, simulation.joint_positions)), **place})
        begun = clock()
        simulation.render("camera")
        if depth:
            simulation.render_depth("camera")
        if frames >= 2:  # the first make shaders
            used_s += clock() - begun
        frames += 1
    return (frames - 2) / used_s


def measure(scene, size, options, save=None):
    """Frames a second of a scene."""
    clock = time.process_time if options.gl == "osmesa" else time.perf_counter
    with tempfile.TemporaryDirectory() as folder:
        simulation, joints = simulation_of(scene, [int(side) for side in size.split("x")], folder, options.gl)
        rate = frames_per_s(simulation, joints, options.seconds, options.depth, clock)
    if save:
        import cv2
        cv2.imwrite(save, simulation.render("camera")[..., ::-1])
    return rate


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=[*SCENES, "all"])
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--depth", action="store_true", help="colour and depth")
    parser.add_argument("--gl", choices=["osmesa", "egl"], default="osmesa")
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--save", help="PNG file for the last image of a scene")
    options = parser.parse_args()
    unit = "frames/s of CPU time" if options.gl == "osmesa" else "frames/s"
    if options.scene != "all":
        rate = measure(options.scene, options.size, options, options.save)
        print("%s %s%s [%s]: %.1f" % (options.scene, options.size, " with depth" * options.depth, unit, rate))
        return
    print("%s, drawn by %s\n" % (unit, opengl_description(options.gl)))
    print("| scene%s | %s |\n|%s" % (" with depth" * options.depth, " | ".join(SIZES), " --- |" * (len(SIZES) + 1)))
    for scene in SCENES:
        print("| %s |" % scene, end="", flush=True)
        for size in SIZES:
            print(" %.1f |" % measure(scene, size, options), end="", flush=True)
        print()


if __name__ == "__main__":
    main()
