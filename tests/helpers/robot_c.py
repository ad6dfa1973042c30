"""An exported folder of C, compiled and called through ctypes: memory of the caller, as its header says."""

import ctypes as ct
import re
import subprocess

import numpy as np

from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.output.exchange.c_source import FLAGS

STRICT = ("-Wall", "-Wextra", "-Werror")


def compiled(folder, *more):
    """`robot.c` of a folder as a shared library."""
    command = [*compiler(), *FLAGS, "-O0", *more, "-fPIC", "-shared", "robot.c", "-o", "robot.so", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return Library(folder)


class Library:
    """Sizes, names and calls."""

    def __init__(self, folder):
        header = (folder / "robot.h").read_text()
        self.bytes, self.count, outputs = (
            int(re.search(rf"ROBOT_{name} = (\d+)", header)[1]) for name in ("BYTES", "INPUTS", "OUTPUTS")
        )
        self.loaded = ct.CDLL(str(folder / "robot.so"))
        self.loaded.robot_size.restype = ct.c_size_t
        self.loaded.robot_time.restype = ct.c_double
        self.size = self.loaded.robot_size()
        self.names = [x.decode() for x in (ct.c_char_p * self.count).in_dll(self.loaded, "robot_input_names")]
        self.start, self._out = np.zeros(self.count), np.zeros(outputs)
        self.loaded.robot_start_inputs(_at(self.start))

    def memory(self):
        """Memory as it begins, at a multiple of 64."""
        room = np.zeros(self.size + 64, np.uint8)
        found = room[-room.ctypes.data % 64 :][: self.size]
        assert self.loaded.robot_init(_at(found)) == 0
        return found

    def step(self, memory, inputs, steps=1):
        return self.loaded.robot_step(_at(memory), _at(inputs), ct.c_long(steps))

    def outputs(self, memory):
        self.loaded.robot_outputs(_at(memory), _at(self._out))
        return self._out.copy()

    def time(self, memory):
        return self.loaded.robot_time(_at(memory))


def _at(array):
    return ct.c_void_p(array.ctypes.data)
