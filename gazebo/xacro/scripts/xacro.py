#!/usr/bin/env python3
"""Expands a xacro file: xacro [options] FILE [NAME:=VALUE ...]. $(find PACKAGE) is looked up as roslaunch does."""
import sys

del sys.path[0]  # this folder, where the library's name stands for this program

import xacro_unprefixed

if __name__ == "__main__":
    xacro_unprefixed.main()
