#!/usr/bin/env bash
# Installs the build, moves the folder, makes a project of each template with it, builds the projects against the moved folder
# only, and runs their scenes: check_templates.sh CMAKE BUILD CC CXX [FC]
set -euo pipefail
cmake=$1 build=$2
export CC=$3 CXX=$4 FC=${5:-}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LD_LIBRARY_PATH CMAKE_PREFIX_PATH

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

"$cmake" --install "$build" --prefix "$work/first" > "$work/install.txt" || fail "$(cat "$work/install.txt")"
mv "$work/first" "$work/moved"
home=$work/moved
tandem=$home/bin/tandem
cd "$work"

languages=(c cpp)
[[ -z $FC ]] || languages+=(fortran)

make_and_build() {  # LANGUAGE ROLE
  local name=$1_$2
  "$tandem" new participant "$name" --language "$1" --role "$2"
  # The line of the project's README.
  grep -qF "cmake -S . -B build -DCMAKE_PREFIX_PATH=$home" "$name/README.md" || fail "$name/README.md names another folder"
  "$cmake" -S "$name" -B "$name/build" -DCMAKE_PREFIX_PATH="$home" -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF
  "$cmake" --build "$name/build"
}

jobs=()
for language in "${languages[@]}"; do
  for role in mbd dem; do
    make_and_build "$language" "$role" > "$language-$role.txt" 2>&1 &
    jobs+=("$!:$language-$role")
  done
done
make_and_build cpp sph > cpp-sph.txt 2>&1 &
jobs+=("$!:cpp-sph")
for job in "${jobs[@]}"; do
  wait "${job%%:*}" || fail "${job#*:}: $(cat "${job#*:}.txt")"
  ! grep -i 'warning' "${job#*:}.txt" || fail "${job#*:} is built with warnings"
done

run() {  # SCENE OUT OPTION...
  local scene=$1 out=$2
  shift 2
  "$tandem" run "$scene" --out "$out" --threads 1 --strict --no-picture --no-report --quiet "$@"
}

for language in "${languages[@]}"; do
  mbd=$work/${language}_mbd/build/${language}_mbd dem=$work/${language}_dem/build/${language}_dem
  echo "-- $language: libtandem_participant is the moved folder's"
  for program in "$mbd" "$dem"; do
    libraries=$(ldd "$program")
    [[ $libraries == *"libtandem_participant.so.1 => $home/lib/"* ]] || fail "$libraries"
    # A program of C++ has the library of its own compiler.
    [[ $language != cpp || $libraries != *"libstdc++.so.6 => $home"* ]] || fail "$libraries"
  done
  echo "-- $language: the scenes of the templates, whose checks compare with closed forms"
  if [[ $language == c ]]; then  # the scenes are the same for all languages
    run c_mbd/scene.json out_own_mbd
    run c_dem/scene.json out_own_dem
    run c_mbd/scene.json out_c_mbd --mbd-server "$mbd"
  fi
  run "${language}_dem/scene.json" "out_${language}_dem" --dem-server "$dem"
  run "${language}_mbd/scene.json" "out_${language}_both" --mbd-server "$mbd" --dem-server "$dem"
  for fact in '"mbd_method": "free bodies, implicit midpoint rule"' '"dem_method": "velocity Verlet'; do
    grep -q "$fact" "out_${language}_both/summary.json" || fail "out_${language}_both/summary.json has no $fact"
  done
  echo "-- $language: what a solver does not know is refused by name"
  if [[ $language == c ]]; then  # this the library does
    ! run c_dem/scene.json out_refused --mbd-server "$mbd" 2> refused.txt || fail "a joint was accepted"
    grep -q 'joint:prismatic, force:spring_damper' refused.txt || fail "$(cat refused.txt)"
  fi
  sed 's/"friction": 0,/"friction": 0.5,/' "${language}_dem/scene.json" > friction.json
  ! run friction.json out_refused --dem-server "$dem" 2> refused.txt || fail "friction was accepted"
  grep -q 'a pair has friction, which this solver does not know' refused.txt || fail "$(cat refused.txt)"
done

echo "-- a liquid: the checks of its scene pass with the template and with the solver of tandem"
run cpp_sph/scene.json out_cpp_sph --sph-server "$work/cpp_sph/build/cpp_sph"
run cpp_sph/scene.json out_own_sph
grep -q '"method": "one mass on a spring' out_cpp_sph/summary.json || fail "out_cpp_sph/summary.json has no method of the liquid"
sed 's|"domain": {|"outlets": [{"name": "drain", "region": {"type": "plane", "point": [0.15, 0, 0], "normal": [1, 0, 0]}}], "domain": {|' \
  cpp_sph/scene.json > outlet.json
! run outlet.json out_refused --sph-server "$work/cpp_sph/build/cpp_sph" 2> refused.txt || fail "an outlet was accepted"
grep -q 'the scene asks for outlet, which cpp_sph 0.1 does not know' refused.txt || fail "$(cat refused.txt)"

if "/usr/bin/python3" -c 'import numpy' 2> no_numpy.txt; then
  echo "-- python: the package and the library are the moved folder's"
  for role in mbd dem sph; do
    "$tandem" new participant "python_$role" --language python --role "$role"
    # tests/conformance/python runs the scenes; here each solver starts, and the liquid, which is quick, runs.
    "$tandem" validate "python_$role/scene.json" "--$role-server" "/usr/bin/python3 python_$role/main.py"
  done
  run python_sph/scene.json out_python_sph --sph-server "/usr/bin/python3 python_sph/main.py"
  grep -q '"program": "python_sph 0.1"' out_python_sph/summary.json || fail "out_python_sph/summary.json"
  judged=(python)
else
  echo "-- python: left out, because /usr/bin/python3 has no numpy"
  judged=()
fi

echo "-- the judge of participants finds no fault in any project"
judge() {  # LANGUAGE ROLE
  local command=$work/$1_$2/build/$1_$2
  [[ $1 != python ]] || command="/usr/bin/python3 $work/python_$2/main.py"
  "$tandem" conform "$command" --role "$2" > "judged-$1-$2.txt" || fail "$(cat "judged-$1-$2.txt")"
  tail -n 1 "judged-$1-$2.txt"
}
# All languages call the same library: C is judged in both roles, others in one. A judgement mostly waits: all run at once.
jobs=()
for pair in "c mbd" "c dem" "cpp mbd" "cpp sph" ${FC:+"fortran dem"} "${judged[@]/%/ mbd}"; do
  # shellcheck disable=SC2086 # two words
  judge $pair > "said-${pair/ /-}.txt" 2>&1 &
  jobs+=("$!:said-${pair/ /-}.txt")
done
for job in "${jobs[@]}"; do
  wait "${job%%:*}" || fail "$(cat "${job#*:}")"
  cat "${job#*:}"
done

echo "-- equal results in all languages"
for language in "${languages[@]:1}"; do
  python3 - "out_${languages[0]}_both" "out_${language}_both" << 'END' || fail "$language differs from ${languages[0]}"
import csv, sys
rows = [list(csv.reader(open(f"{folder}/bodies.csv"))) for folder in sys.argv[1:]]
assert rows[0][0] == rows[1][0] and len(rows[0]) == len(rows[1]) > 100
worst = max(abs(float(a) - float(b)) / (1 + abs(float(a))) for one, other in zip(*[r[1:] for r in rows]) for a, b in zip(one, other))
print(f"largest difference: {worst:.1e} (tolerance 1e-8)")
sys.exit(worst > 1e-8)
END
done
