"""An importer of FMI 3.0 units for co-simulation in ctypes: as little as tests need, by the specification alone."""

import ctypes as ct
import platform
import sys
import zipfile
from math import prod
from xml.etree import ElementTree as xml

import numpy as np

LOG = ct.CFUNCTYPE(None, ct.c_void_p, ct.c_int, ct.c_char_p, ct.c_char_p)
MACHINE = "aarch64" if platform.machine() in ("arm64", "aarch64") else "x86_64"
FOLDER = f"{MACHINE}-{'darwin' if sys.platform == 'darwin' else 'linux'}"


class Unit:
    """An unpacked unit: its description, its library."""

    def __init__(self, path, folder):
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        self.root = xml.parse(folder / "modelDescription.xml").getroot()
        (library,) = (folder / "binaries" / FOLDER).iterdir()
        self.library = ct.CDLL(str(library))
        self.library.fmi3InstantiateCoSimulation.restype = ct.c_void_p
        self.step = float(self.root.find("CoSimulation").get("fixedInternalStepSize"))
        self.variables = {}
        for found in self.root.find("ModelVariables"):
            shape = tuple(int(x.get("start")) for x in found.findall("Dimension"))
            self.variables[found.get("name")] = (int(found.get("valueReference")), shape, found.attrib)

    def start(self, name):
        return np.array(self.variables[name][2]["start"].split(), dtype=float)


class Instance:
    """One instance, from instantiation to step mode."""

    def __init__(self, unit, start=0.0):
        self.unit, self.said, self.time = unit, [], start
        self.log = LOG(lambda environment, status, category, words: self.said.append(words.decode()))
        self.at = ct.c_void_p(
            unit.library.fmi3InstantiateCoSimulation(
                b"one", unit.root.get("instantiationToken").encode(), None, False, False, False, False, None,
                ct.c_size_t(0), None, self.log, None,
            )
        )  # fmt: skip
        assert self.at, self.said
        self.call("EnterInitializationMode", False, ct.c_double(0), ct.c_double(start), False, ct.c_double(0))
        self.call("ExitInitializationMode")

    def status(self, name, *arguments):
        return getattr(self.unit.library, f"fmi3{name}")(self.at, *arguments)

    def call(self, name, *arguments):
        assert self.status(name, *arguments) == 0, self.said

    def _floats(self, which, name, values):
        reference = (ct.c_uint32 * 1)(self.unit.variables[name][0])
        pointer = values.ctypes.data_as(ct.POINTER(ct.c_double))
        self.call(which, reference, ct.c_size_t(1), pointer, ct.c_size_t(values.size))

    def get(self, name):
        values = np.zeros(prod(self.unit.variables[name][1]))
        self._floats("GetFloat64", name, values)
        return values

    def set(self, name, values):
        self._floats("SetFloat64", name, np.ascontiguousarray(values, dtype=float).ravel())

    def steps(self, length):
        """Status of a communication step."""
        flags, reached = [ct.byref(ct.c_bool()) for _ in range(3)], ct.c_double()
        found = self.status("DoStep", ct.c_double(self.time), ct.c_double(length), False, *flags, ct.byref(reached))
        self.time = reached.value
        return found

    def saved(self):
        """State as bytes."""
        state, size = ct.c_void_p(), ct.c_size_t()
        self.call("GetFMUState", ct.byref(state))
        self.call("SerializedFMUStateSize", state, ct.byref(size))
        into = (ct.c_ubyte * size.value)()
        self.call("SerializeFMUState", state, into, size)
        self.call("FreeFMUState", ct.byref(state))
        return bytes(into)

    def restore(self, saved, time):
        state = ct.c_void_p()
        given = (ct.c_ubyte * len(saved)).from_buffer_copy(saved)
        self.call("DeserializeFMUState", given, ct.c_size_t(len(saved)), ct.byref(state))
        self.call("SetFMUState", state)
        self.call("FreeFMUState", ct.byref(state))
        self.time = time
