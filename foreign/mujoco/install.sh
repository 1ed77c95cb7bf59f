#!/bin/sh
# MuJoCo from PyPI, into a virtual environment next to this file that also sees Debian's numpy.
set -eu
cd "$(dirname "$0")"
/usr/bin/python3 -m venv --system-site-packages venv
venv/bin/pip install --quiet 'mujoco==4.0.0'
venv/bin/python -c 'import mujoco; print("mujoco", mujoco.__version__)'
