"""Puts helpers of the packages' tests where these tests find them."""
import pathlib
import sys

SRC = pathlib.Path(__file__).resolve().parents[2] / "src"
sys.path[:0] = [str(SRC / "aras_visual_servo/test/support"), str(SRC / "aras_visual_servo_camera/test/unit")]
