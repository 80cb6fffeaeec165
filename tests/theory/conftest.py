"""Puts what these tests share, and the packages' exact pictures of polygons and textures, where they are found."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
SOURCES = HERE.parents[1] / "src"
sys.path.insert(0, str(HERE / "support"))
sys.path.insert(0, str(SOURCES / "aras_visual_servo/test/support"))
sys.path.append(str(SOURCES / "aras_visual_servo_camera/test/unit"))  # textured_plane
