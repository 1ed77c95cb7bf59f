#!/usr/bin/env python3
"""Compares the Fortran module of the participant kit with the header: each struct has the same components, at the same places and
of the same size, and each constant the same value. Arrays of structs without elements are empty.

usage: layout.py ROOT CC FC LIBRARY        LIBRARY is libtandem_participant
"""
import pathlib
import re
import subprocess
import sys
import tempfile


def structs(header):
    """Name -> members, of every struct that is defined in the header."""
    found = {}
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
    for name, body in re.findall(r"typedef struct (tandem_\w+) \{(.*?)\n\} \1;", text, re.DOTALL):
        members = []
        for declaration in body.split(";"):
            pointer = re.search(r"\(\*(\w+)\)", declaration)  # of a function
            if pointer:
                members.append(pointer[1])
                continue
            for part in declaration.strip().split(","):
                if part.strip():
                    members.append(re.search(r"(\w+)(?:\[\d+\])?$", part.strip())[1])
        found[name] = members
    return found


def constants(header):
    return [name for name in re.findall(r"^#define (TANDEM_\w+) ", header, re.MULTILINE) if name not in ("TANDEM_API",)]


def c_program(structs, constants):
    lines = [f'  printf("{s}.{m} %zu %zu\\n", offsetof({s}, {m}), sizeof(((struct {s} *)0)->{m}));' for s in structs for m in structs[s]]
    lines += [f'  printf("{s} %zu\\n", sizeof(struct {s}));' for s in structs]
    lines += [f'  printf("{c} %lld\\n", (long long)(int)({c}));' for c in constants]
    return "#include <stdio.h>\n#include <tandem/participant.h>\nint main(void) {\n" + "\n".join(lines) + "\n}\n"


def fortran_program(structs, constants):
    declarations = [f"  type({s}), target :: x_{s}" for s in structs]
    lines = [f"  print '(a,i0,1x,i0)', '{s}.{m} ', place(c_loc(x_{s}%{m})) - place(c_loc(x_{s})), storage_size(x_{s}%{m})/8{repeat(s, m)}"
             for s in structs for m in structs[s]]
    lines += [f"  print '(a,i0)', '{s} ', c_sizeof(x_{s})" for s in structs]
    lines += [f"  print '(a,i0)', '{c} ', {c.lower()}" for c in constants]
    more_declarations, more_lines = empty_lists()
    return "\n".join(["program check", "  use, intrinsic :: iso_c_binding", "  use tandem_participant", "  implicit none", *declarations,
                      *more_declarations, *lines, *more_lines, "contains", EMPTY, "  integer(c_intptr_t) function place(p)", "    type(c_ptr), intent(in) :: p",
                      "    place = transfer(p, place)", "  end function", "end program", ""])


# Functions of the module that give an array, and what they take.
LISTS = {"tandem_motions": "tandem_motion_set", "tandem_loads": "tandem_load_set", "tandem_tangents": "tandem_tangent_set",
         "tandem_states": "tandem_bodies_frame", "tandem_joints": "tandem_bodies_frame", "tandem_values": "tandem_control_set",
         "tandem_elements": "tandem_bodies_frame",
         "tandem_bodies": "tandem_configuration", "tandem_boundary": "tandem_configuration", "tandem_materials": "tandem_configuration",
         "tandem_pairs": "tandem_configuration", "tandem_walls": "tandem_configuration", "tandem_triangles": "tandem_wall",
         "tandem_liquids": "tandem_configuration", "tandem_boxes": "tandem_liquid",
         "tandem_sphere_position": "tandem_configuration", "tandem_sphere_velocity": "tandem_configuration",
         "tandem_sphere_radius": "tandem_configuration", "tandem_sphere_material": "tandem_configuration"}


def empty_lists():
    """Declarations and statements that print the size of each array of a struct of zeros, where C has a null pointer."""
    declarations = [f"  type({struct}), target :: y_{struct}" for struct in sorted(set(LISTS.values()))]
    lines = [line for struct in sorted(set(LISTS.values())) for line in (f"  call zero(c_loc(y_{struct}), c_sizeof(y_{struct}))",)]
    lines += [f"  call expect_empty('{name}', size({name}(y_{struct})))" for name, struct in LISTS.items()]
    return declarations, lines


EMPTY = """  subroutine zero(p, bytes)
    type(c_ptr), intent(in) :: p
    integer(c_size_t), intent(in) :: bytes
    integer(c_int8_t), pointer :: all(:)
    call c_f_pointer(p, all, [bytes])
    all = 0
  end subroutine
  subroutine expect_empty(name, count)
    character(*), intent(in) :: name
    integer, intent(in) :: count
    if (count /= 0) print '(a,a,i0)', name, ' of nothing has ', count
  end subroutine"""


def repeat(struct, member):
    """storage_size is that of one element."""
    return f"*max(1, product(shape(x_{struct}%{member})))"


def main():
    root, cc, fc, library = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4]).resolve()
    header = (root / "participant/include/tandem/participant.h").read_text()
    types, names = structs(header), constants(header)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "check.c").write_text(c_program(types, names))
        (work / "check.f90").write_text(fortran_program(types, names))
        subprocess.run([cc, "-I", root / "participant/include", "check.c", "-o", "of_c"], cwd=work, check=True)
        # The module as the standard has it, lines of at most 132 characters among it. gfortran 12 raises
        # -Wmaybe-uninitialized falsely on arrays that a subroutine allocates.
        subprocess.run([fc, "-std=f2018", "-Wall", "-Werror", "-Wno-maybe-uninitialized", "-c",
                        root / "participant/fortran/tandem_participant.f90", "-o", "module.o"], cwd=work, check=True)
        subprocess.run([fc, "-ffree-line-length-none", "-fcheck=all", "check.f90", "module.o", library, f"-Wl,-rpath,{library.parent}",
                        "-o", "of_fortran"], cwd=work, check=True)
        c, fortran = (subprocess.run([work / program], capture_output=True, text=True, check=True).stdout.splitlines()
                      for program in ("of_c", "of_fortran"))
    faults = [f"C has {one}, Fortran {other}" for one, other in zip(c, fortran) if one != other]
    print("\n".join(faults + [f"{len(c)} places, sizes and values of {len(types)} structs and {len(names)} constants, {len(faults)} differ"]))
    # A check that reads nothing would pass for ever.
    return 1 if faults or len(c) != len(fortran) or len(types) < 20 or len(names) < 15 else 0


if __name__ == "__main__":
    sys.exit(main())
