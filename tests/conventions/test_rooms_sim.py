"""The simulator's rooms: what each may include, which library belongs to which room, and that no folder is crowded."""
import pathlib
import re

import pytest

PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "src" / "aras_visual_servo_sim"
NAME = "aras_visual_servo_sim"
INCLUDE = re.compile(r'^#include ([<"])([^">]+)[">]', re.MULTILINE)
# Each room, and the rooms below it that it may include.
BELOW = {
    "config": set(),
    "image": {"config"},
    "robot": {"config"},
    "scene": {"config", "image", "robot"},
    "camera": {"config", "image", "robot"},
    "physics": {"config", "robot"},
    "render": {"config", "image", "scene", "camera"},
    "simulation": {"config", "image", "robot", "scene", "camera", "physics", "render"},
}
# Folders inside a room, lowest first; "" is the room's own folder. Its public headers are for all of them.
FLOORS = {
    "physics": ["bullet", "rays", "control", "managed", "drive", "body", "contact", "world"],
    "render": ["view", "pixels", "coverage", "picture", "planar", "triangles", "curved", "tiles", "opengl", ""],
    "scene": ["motion", "mesh", "light", ""],
    "simulation": ["time", "models", "cameras", "state", ""],
}
# The node's rooms, lowest first.
NODE = ["convert", "record", "publish", "listen", "node"]
# Libraries that one room alone knows.
LIBRARIES = {"Bullet": "physics", "bt": "physics", "LinearMath": "physics", "assimp": "scene", "stb": "image",
             "urdf": "robot", "tinyxml2": "robot"}


def room_of(folder):
    """('physics', 'drive') of physics/drive, ('render', '') of render."""
    parts = folder.parts
    return parts[0], parts[1] if len(parts) > 1 else ""


def core_files():
    for root in (PACKAGE / "include" / NAME, PACKAGE / "src" / "core"):
        for path in sorted(root.rglob("*.[ch]pp")):
            yield path, path.relative_to(root).parent


def our_includes(path, folder):
    """(room, floor, is it public) of each of our own headers that a file includes."""
    for bracket, name in INCLUDE.findall(path.read_text()):
        if bracket == "<":
            continue
        if name.startswith(NAME + "/"):
            yield (*room_of(pathlib.PurePath(name).relative_to(NAME).parent), True)
        else:
            yield (*room_of(pathlib.PurePath(name).parent if "/" in name else folder), False)


def test_every_core_file_stands_in_a_room():
    assert {room_of(folder)[0] for _, folder in core_files()} == set(BELOW)


def test_rooms_have_no_circle():
    order = list(BELOW)
    assert all(order.index(below) < order.index(room) for room, rooms in BELOW.items() for below in rooms)


@pytest.mark.parametrize("room", BELOW)
def test_a_room_includes_only_what_stands_below_it(room):
    upwards = [f"{path.relative_to(PACKAGE)} includes {other}" for path, folder in core_files()
               if room_of(folder)[0] == room for other, _, _ in our_includes(path, folder)
               if other not in BELOW[room] | {room}]
    assert upwards == []


@pytest.mark.parametrize("room", FLOORS)
def test_a_floor_of_a_room_includes_only_the_floors_below_it(room):
    floors = FLOORS[room]
    upwards = []
    for path, folder in core_files():
        here, floor = room_of(folder)
        if here != room or floor not in floors:
            continue
        for other, other_floor, public in our_includes(path, folder):
            shared = public and other_floor == "" and room != "simulation"
            if other == room and not shared and floors.index(other_floor) > floors.index(floor):
                upwards.append(f"{path.relative_to(PACKAGE)} includes {other}/{other_floor}")
    assert upwards == []


def test_private_headers_stay_in_their_room():
    strangers = [f"{path.relative_to(PACKAGE)} includes a private header of {other}" for path, folder in core_files()
                 for other, _, public in our_includes(path, folder)
                 if not public and other != room_of(folder)[0]]
    assert strangers == []


def test_a_room_of_the_node_includes_only_what_stands_below_it():
    root = PACKAGE / "src" / "ros"
    files = sorted(root.rglob("*.[ch]pp"))
    assert {path.parent.name for path in files} == set(NODE)
    upwards = [f"{path.relative_to(PACKAGE)} includes {name}" for path in files
               for bracket, name in INCLUDE.findall(path.read_text())
               if bracket == '"' and not name.startswith(NAME) and "/" in name
               and NODE.index(name.split("/")[0]) >= NODE.index(path.parent.name)]
    assert upwards == []


def test_each_library_is_known_to_one_room():
    found = set()
    for path, folder in core_files():
        for bracket, name in INCLUDE.findall(path.read_text()):
            library = next((each for each in LIBRARIES if bracket == "<" and name.startswith(each)), None)
            if library:
                found.add(library)
                assert room_of(folder)[0] == LIBRARIES[library], f"{path.relative_to(PACKAGE)} includes {name}"
    assert {LIBRARIES[library] for library in found} == set(LIBRARIES.values())
