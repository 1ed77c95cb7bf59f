#!/bin/sh
# Simbody from Debian, and simbody_bodies built against tandem's participant kit.
# usage: install.sh [TANDEM]: an installed folder of tandem, or a build folder; without it the newest build next to this one
set -eu
cd "$(dirname "$0")"
dpkg -s libsimbody-dev nlohmann-json3-dev >/dev/null 2>&1 ||
  apt-get install -y --no-install-recommends libsimbody-dev nlohmann-json3-dev
tandem=${1:-$(dirname "$(dirname "$(ls -t ../../build/*/lib/libtandem_participant.so | head -1)")")}
mkdir -p build
c++ -std=c++17 -O2 -Wall -Wextra -isystem /usr/include/simbody -I "$tandem/include" -I ../../participant/include \
  simbody_bodies.cpp -o build/simbody_bodies -L "$tandem/lib" -ltandem_participant -Wl,-rpath,"$(realpath "$tandem/lib")" \
  -lSimTKsimbody -lSimTKmath -lSimTKcommon
echo "simbody $(dpkg-query -W -f '${Version}' libsimbody-dev): build/simbody_bodies"
