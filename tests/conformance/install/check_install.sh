#!/usr/bin/env bash
# Installs the build, moves the folder, and uses it there: check_install.sh CMAKE BUILD SCENE DOCS_CHECK
set -euo pipefail
cmake=$1 build=$2 scene=$3 docs_check=$4
most_mib=76

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LD_LIBRARY_PATH

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

"$cmake" --install "$build" --prefix "$work/first" > "$work/install.txt" || fail "$(cat "$work/install.txt")"
mv "$work/first" "$work/moved"
cd "$work"
home=$work/moved

echo "-- every library resolves inside the folder, except glibc"
for file in "$home"/bin/* "$home"/lib/*.so* "$home"/lib/tandem/*; do
  [[ $file != */tandem_step ]] || continue     # OpenCASCADE is the machine's own
  [[ $file != */dem_server_mpi ]] || continue  # so is OpenMPI
  while read -r line; do
    case $line in
      *"not found"*) fail "${file#"$home"/}: $line" ;;
      *"=> $home/"* | linux-vdso.so* | statically*) ;;
      *ld-linux* | libc.so.* | libm.so.* | libpthread.so.* | libdl.so.* | librt.so.* | libresolv.so.* | libutil.so.* | \
        libanl.so.* | libnsl.so.* | libmvec.so.*) ;;
      *) fail "${file#"$home"/} takes a library from the machine: $line" ;;
    esac
  done < <(ldd "$file")
  ! readelf -d "$file" 2> /dev/null | grep -E '(RPATH|RUNPATH)' | grep -v 'ORIGIN' || fail "$file: path outside"
done

echo "-- the programs run"
"$home/bin/tandem" --version
"$home/bin/tandem" validate "$scene"
for installed in "$home"/share/tandem/scenes/*.json; do
  [[ ! -e $installed ]] || "$home/bin/tandem" validate "$installed"
done
"$home/bin/tandem" run "$scene" --out "$work/run" --no-picture
[[ -s $work/run/report.html ]] || fail "no report: report.py was not found"
[[ -s $home/share/tandem/schema.json ]] || fail "no schema.json"

echo "-- the Python package finds the program, and its examples are there"
[[ -s $home/share/tandem/python/examples/excavator.py ]] || fail "no examples of the Python package"
env -u TANDEM PYTHONPATH="$home/share/tandem/python" /usr/bin/python3 -B -c "
import tandem as td
assert td.find_tandem() == '$home/bin/tandem', td.find_tandem()
s = td.Scene('ball', end_time=.05)
s.body('ball', sphere=.1, mass=1)
assert abs(s.run('$work/python', picture=False, report=False)['ball.velocity.z'].last() + 9.81 * .05) < 1e-9
" || fail "the Python package does not run a scene"

echo "-- the participant kit is there"
for file in include/tandem/participant.h include/tandem/participant.hpp share/tandem/fortran/tandem_participant.f90 \
  lib/cmake/tandem/tandemConfig.cmake lib/cmake/tandem/tandemConfigVersion.cmake; do
  [[ -s $home/$file ]] || fail "no $file"
done
[[ -L $home/lib/libtandem_participant.so && -L $home/lib/libtandem_participant.so.1 ]] || fail "no links to the library's versions"
[[ $(readlink "$home/lib/libtandem_participant.so") == libtandem_participant.so.1 ]] || fail "libtandem_participant.so leads elsewhere"
[[ -f $home/lib/$(readlink "$home/lib/libtandem_participant.so.1") ]] || fail "libtandem_participant.so.1 leads to nothing"
others=$(find "$home/lib" -maxdepth 1 -name '*.so*' ! -name 'libtandem_participant.so*')
[[ -z $others ]] || fail "programs that are linked with the kit would find $others before their own"
promised=$(grep -oP '^TANDEM_API [^(]*?\Ktandem_\w+(?=\()' "$home/include/tandem/participant.h" | sort)
shown=$(nm -D --defined-only "$home/lib/libtandem_participant.so" | sed -n 's/.* [A-Z] \(\w*\)@.*/\1/p' | sort)
[[ -n $promised && $promised == "$shown" ]] || fail "the header promises" $promised "and the library shows" $shown
! grep -rlF "$build" "$home/lib/cmake" "$home/include" "$home/share/tandem/templates" || fail "a file names the build folder"
for role in mbd dem; do
  "$home/bin/tandem" new participant "new_$role" --language c --role "$role"
  "$home/bin/tandem" validate --files-only "new_$role/scene.json"
done
! "$home/bin/tandem" new participant new_mbd --language c --role mbd 2> refused.txt || fail "an existing folder was taken"
grep -q 'exists already, and is left as it is' refused.txt || fail "$(cat refused.txt)"

echo "-- every link of the pages leads to something in the folder"
python3 -B "$docs_check" links "$home/share/tandem" > "$work/links.txt" || fail "$(cat "$work/links.txt")"

if [[ $("$home/bin/tandem" --version) == *transports:*dds* ]]; then
  echo "-- DDS Security works, with the plug-ins and the OpenSSL of the folder"
  "$home/bin/tandem" keys --certificates "$work/certificates"
  LD_DEBUG=files LD_DEBUG_OUTPUT=$work/loaded "$home/bin/tandem" run "$scene" --out "$work/run" --transport dds \
    --certificates "$work/certificates" --no-picture --no-report --quiet
  grep -q '"dds_security": "certificates' "$work/run/summary.json" || fail "the run had no certificates"
  for part in security_auth security_ac security_crypto; do
    grep -hq "calling init: $home/.*libdds_$part.so" "$work"/loaded.* || fail "libdds_$part.so of the folder was not loaded"
  done
  ! grep -hE 'calling init: /(usr/)?lib/.*(dds|crypto|ssl)' "$work"/loaded.* || fail "a library of the machine was loaded"
fi

size=$(du -sm "$home" | cut -f1)
echo "-- size: $size MiB of at most $most_mib"
((size <= most_mib)) || fail "the folder takes $size MiB"
