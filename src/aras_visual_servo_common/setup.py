"""Installs the Python package; run by catkin, not by hand."""
from setuptools import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["aras_visual_servo_common"], package_dir={"": "src"}))
