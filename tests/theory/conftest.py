"""Puts the controller's shared test helpers, exact pictures of polygons among them, where these tests find them."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/aras_visual_servo_controller/test/support"))
