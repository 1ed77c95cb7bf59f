#!/bin/sh
# LIGGGHTS and the Python packages from Debian.
set -eu
dpkg -s liggghts python3-numpy python3-scipy >/dev/null 2>&1 ||
  apt-get install -y --no-install-recommends liggghts python3-numpy python3-scipy
echo "liggghts $(dpkg-query -W -f '${Version}' liggghts)"
