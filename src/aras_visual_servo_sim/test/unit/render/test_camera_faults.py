"""Whatever keeps one camera from its image is said with its name; the other cameras show what they show alone."""
import ctypes
import json
import os
import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "ros" / "robot"

#: Makes simulations of the cameras of these names: `exact` of the coverage renderer, `shown` and `other` of OpenGL.
BEGIN = """
import hashlib, json, sys, yaml
from aras_visual_servo_sim import ArasError, Simulation
FOLDER, TMP = sys.argv[1:]
CAMERAS = {"exact": {}, "shown": {"renderer": "opengl"}, "other": {"renderer": "opengl", "width": 48}}
def make(*names, models=(), ball=(0.05, 0.02, 0.1), **changes):
    config = yaml.safe_load(open(FOLDER + "/sim.yaml"))["sim"]
    config["gravity_m_s2"] = [0.0, 0.0, 0.0]
    camera = config["cameras"][0]
    config["cameras"] = [{**camera, "name": name, "encoding": "rgb8", **CAMERAS[name], **changes.get(name, {})}
                         for name in names]
    scene = config["scene"]
    scene["solids"] = [dict(name="ball", sphere_m=0.03, position_m=list(ball))]
    scene["lighting"] = {"lights": [dict(name="sun", type="directional", direction=[0.3, 0.2, -1])]}
    scene["models"].extend(models)
    return Simulation(open(FOLDER + "/pan_lift.urdf").read(), config)
def image(sim, name):
    return hashlib.sha256(sim.render(name).tobytes()).hexdigest()
def alone(*names, **keys):
    return {name: image(make(name, **keys), name) for name in names}
def words(action):
    try:
        action()
    except ArasError as error:
        return str(error)
    return ""
"""

#: Stands between the simulator and OSMesa. FAULT_AT counts, from 1: contexts that are made current, or shaders.
SHIM = r"""
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
typedef void (*Function)(void);
static void *real(const char *name) {
  static void *library;
  if (!library) library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  return dlsym(library, name);
}
static int strikes(const char *fault) {
  static int count;
  return !strcmp(getenv("FAULT"), fault) && ++count == atoi(getenv("FAULT_AT"));
}
void *OSMesaCreateContextAttribs(const int *wanted, void *share) {
  return ((void *(*)(const int *, void *))real("OSMesaCreateContextAttribs"))(wanted, share);
}
void OSMesaDestroyContext(void *context) { ((void (*)(void *))real("OSMesaDestroyContext"))(context); }
unsigned char OSMesaMakeCurrent(void *context, void *buffer, unsigned type, int width, int height) {
  if (context && strikes("context")) return 0;
  unsigned char (*make)(void *, void *, unsigned, int, int) = real("OSMesaMakeCurrent");
  return make(context, buffer, type, width, height);
}
static void shaderSource(unsigned shader, int count, const char *const *texts, const int *lengths) {
  static const char *const nonsense = "nonsense";
  if (strikes("shader")) texts = &nonsense;
  ((void (*)(unsigned, int, const char *const *, const int *))((Function (*)(const char *))real(
      "OSMesaGetProcAddress"))("glShaderSource"))(shader, count, texts, lengths);
}
Function OSMesaGetProcAddress(const char *name) {
  if (!strcmp(name, "glShaderSource")) return (Function)shaderSource;
  return ((Function (*)(const char *))real("OSMesaGetProcAddress"))(name);
}
"""


@pytest.fixture(scope="module", name="shim")
def shim_fixture(tmp_path_factory):
    try:
        ctypes.CDLL("libOSMesa.so.8")
    except OSError as error:
        pytest.skip(f"faults are made in OSMesa: {error}")
    folder = tmp_path_factory.mktemp("shim")
    (folder / "shim.c").write_text(SHIM)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "libshim.so", "shim.c", "-ldl"], cwd=folder, check=True)
    return str(folder / "libshim.so")


def run(program, folder, **environment):
    """What a process prints, as JSON."""
    done = subprocess.run([sys.executable, "-c", BEGIN + program, str(FOLDER), str(folder)], capture_output=True,
                          text=True, check=False, env={**os.environ, **environment})
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_osmesa_and_egl_that_are_not_there(tmp_path):
    alone, first, words, second = run("""
sim = make("exact", "shown")
first = image(sim, "exact")
found = words(lambda: sim.render("shown"))
print(json.dumps([alone("exact")["exact"], first, found, image(sim, "exact")]))
""", tmp_path, ARAS_VISUAL_SERVO_OSMESA="libNoSuchThing.so", ARAS_VISUAL_SERVO_EGL="libNoSuchEgl.so")
    assert alone == first == second
    assert words.startswith("camera 'shown': renderer 'opengl': libNoSuchThing.so cannot be opened"), words
    assert all(word in words for word in ("libosmesa6", "libNoSuchEgl.so", "libegl1")), words


ONE_FAILS = """
sim = make("exact", "shown", "other")
before = image(sim, "exact")
found = words(lambda: sim.render("shown"))
there = {name: image(sim, name) for name in ("exact", "other", "shown")}
print(json.dumps([found, before == there["exact"], there]))
"""


@pytest.mark.parametrize("fault, at, named", [
    ("shader", 1, "does not compile"), ("shader", 2, "does not compile"), ("shader", 3, "does not compile"),
    ("context", 2, "context was lost")])
def test_shader_that_does_not_compile_and_context_that_is_lost(fault, at, named, shim, tmp_path):
    # The fault strikes once, while the camera 'shown' is drawn: the first context is bound when it is made.
    found, same, there = run(ONE_FAILS, tmp_path, ARAS_VISUAL_SERVO_OSMESA=shim, FAULT=fault, FAULT_AT=str(at))
    assert found.startswith("camera 'shown': renderer 'opengl': ") and named in found, found
    assert same and there == run('print(json.dumps(alone("exact", "other", "shown")))', tmp_path)


@pytest.mark.parametrize("keys, changes, named, others", [
    # No solid stands before a target: the other camera of OpenGL shows them by their coverage.
    ('models=[dict(name="banner", image=dict(file=TMP + "/wide.png", size_m=[0.06, 0.03]), position_m=[0.1, 0.1, 0])], '
     'ball=[-0.05, -0.15, 0.1]',
     "exact_targets=False", "wide.png' has 20000 x 4 px, allowed up to", ["exact", "other"]),
    ('models=[dict(name="banner", image=dict(file=TMP + "/wide.png", size_m=[0.2, 0.1]), position_m=[0, 0, 0.05])]',
     "exact_targets=False", "wide.png' has 20000 x 4 px, allowed up to", ["exact"]),
    ("", "width=16384, height=9, quality='high'", "allowed up to", ["exact", "other"])])
def test_picture_or_canvas_that_is_too_large(keys, changes, named, others, tmp_path):
    import cv2
    import numpy
    cv2.imwrite(str(tmp_path / "wide.png"), numpy.full((4, 20000, 3), 100, numpy.uint8))
    found, alone, there = run(f"""
keys, others = dict({keys}), {others}
sim = make("shown", *others, shown=dict({changes}), **keys)
found = [words(lambda: sim.render("shown")) for _ in range(2)]
print(json.dumps([found, alone(*others, **keys), {{name: image(sim, name) for name in others}}]))
""", tmp_path)
    for words in found:
        assert words.startswith("camera 'shown': renderer 'opengl': ") and named in words, words
    assert there == alone


REFUSED = {
    "a light without a direction": ('sim.set_light(dict(name="spot", type="spot"))', "light 'spot'"),
    "a direction of zero": ('sim.set_light(dict(name="s", type="spot", direction=[0, 0, 0]))', "light 's'"),
    "64 lights": ('for k in range(64): sim.set_light(dict(name="a%d" % k, type="point", intensity=0))', "8"),
    "a mesh whose points are no numbers": ('sim.spawn_model(dict(name="n", mesh=TMP + "/nan.obj"))', "nan.obj"),
    "a mesh without triangles": ('sim.spawn_model(dict(name="n", mesh=TMP + "/none.obj"))', "none.obj"),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_what_is_refused_while_time_goes_on_changes_no_image(fault, tmp_path):
    (tmp_path / "nan.obj").write_text("v 0 0 0\nv nan 0 0\nv 0 0.1 0\nf 1 2 3\n")
    (tmp_path / "none.obj").write_text("v 0 0 0\n")
    change, named = REFUSED[fault]
    found, alone, there = run(f"""
sim = make("exact", "shown")
def change():
    {change}
found = words(change)
print(json.dumps([found, alone("exact", "shown"), {{name: image(sim, name) for name in ("exact", "shown")}}]))
""", tmp_path)
    assert named in found, found
    assert there == alone


@pytest.mark.parametrize("normals", ["", "vn nan 0 1\n", "vn 0 0 0\n"])
def test_normals_that_are_missing_or_none_are_made(normals, tmp_path):
    corner = "//1" if normals else ""
    points = "v -0.1 -0.1 0.05\nv 0.1 -0.1 0.05\nv 0.1 0.1 0.05\nv -0.1 0.1 0.05\n"
    for name, text, at in (("given", "vn 0 0 1\n", "//1"), ("made", normals, corner)):
        (tmp_path / f"{name}.obj").write_text(
            points + text + f"f 1{at} 2{at} 3{at}\nf 1{at} 3{at} 4{at}\n")
    made, given, without = run("""
all = []
for mesh in ("made", "given", None):
    sim = make("exact", "shown")
    if mesh:
        sim.spawn_model(dict(name="plate", mesh=TMP + "/" + mesh + ".obj"))
    all.append([image(sim, "exact"), image(sim, "shown")])
print(json.dumps(all))
""", tmp_path)
    assert made == given
    assert made[0] != without[0] and made[1] != without[1]
