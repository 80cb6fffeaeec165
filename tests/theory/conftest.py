"""Puts the packages' shared test helpers, exact pictures of polygons and textures, where these tests find them."""
import pathlib
import sys

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "src"
sys.path.insert(0, str(SOURCES / "aras_visual_servo_controller/test/support"))
sys.path.append(str(SOURCES / "aras_visual_servo_camera/test/unit"))  # textured_plane
