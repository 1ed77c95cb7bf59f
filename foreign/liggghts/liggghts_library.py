"""LIGGGHTS's library, as far as the solver needs it."""
import ctypes

import numpy as np


class Liggghts:
    def __init__(self, arguments):
        # Global, because the plug-ins of Open MPI expect its symbols to be there.
        self.lib = ctypes.CDLL("libliggghts.so.3", ctypes.RTLD_GLOBAL)
        self.handle = ctypes.c_void_p()
        argv = [b"liggghts", *(argument.encode() for argument in arguments)]
        self.lib.lammps_open_no_mpi(len(argv), (ctypes.c_char_p * len(argv))(*argv), ctypes.byref(self.handle))
        self.lib.lammps_command.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
        self.lib.lammps_extract_atom.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
        self.lib.lammps_extract_atom.restype = ctypes.c_void_p
        self.lib.lammps_extract_fix.argtypes = [ctypes.c_void_p, ctypes.c_char_p] + 4 * [ctypes.c_int]
        self.lib.lammps_extract_fix.restype = ctypes.POINTER(ctypes.c_double)
        self.lib.lammps_free.argtypes = [ctypes.c_void_p]

    def command(self, text):
        """Ends the process where LIGGGHTS finds an error; its sentence is then in the log."""
        self.lib.lammps_command(self.handle, text.encode())

    def fix_vector(self, name, count):
        """The first elements of a fix's global vector."""
        values = np.empty(count)
        for i in range(count):
            value = self.lib.lammps_extract_fix(self.handle, name, 0, 1, i, 0)
            values[i] = value[0]
            self.lib.lammps_free(value)
        return values

    def count(self):
        return self.lib.lammps_get_natoms(self.handle)

    def atoms(self, name, columns, kind):
        """An array of all atoms in the order of LIGGGHTS, not copied."""
        address = self.lib.lammps_extract_atom(self.handle, name)
        if not address:
            raise RuntimeError(f"LIGGGHTS has no '{name.decode()}'")
        if columns > 1:
            address = ctypes.cast(address, ctypes.POINTER(ctypes.c_void_p))[0]
        count = self.count() * columns
        array = np.frombuffer((ctypes.c_byte * (count * np.dtype(kind).itemsize)).from_address(address), kind)
        return array.reshape(-1, columns) if columns > 1 else array
