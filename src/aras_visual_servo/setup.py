"""Installs the Python package; run by catkin, not by hand."""
from setuptools import setup
from setuptools import find_packages

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=find_packages("src"), package_dir={"": "src"},
                                     package_data={"aras_visual_servo": ["*.pyi", "py.typed"]}))
