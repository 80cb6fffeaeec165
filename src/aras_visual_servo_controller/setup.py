from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["aras_visual_servo_controller"],
        package_dir={"": "src"},
        package_data={"aras_visual_servo_controller": ["*.html", "*.json", "templates/*"]},
    )
)
