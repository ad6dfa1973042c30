"""`python -m tools.older x86-64-v3 [arguments of pytest]`: tests with the arithmetic of an older processor.

What computes is then made for x86-64-v3 (no AVX-512) or x86-64-v2 (no AVX, no fused products): the kernels, NumPy's
loops, the BLAS and the C library's functions. Numbers differ in their last bits, and no test may depend on these.
"""

import os
import shlex
import sys

from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

V2 = {"SSE", "SSE2", "SSE3", "SSSE3", "SSE41", "SSE42", "POPCNT", "X86_V2"}
V3 = V2 | {"AVX", "AVX2", "F16C", "FMA3", "X86_V3"}
AVX512 = ("AVX512F", "AVX512VL", "AVX512BW", "AVX512DQ")
#: Of a target: what NumPy keeps, the processor that OpenBLAS takes it for, what the C library (glibc) does without.
TARGETS = {"x86-64-v2": (V2, "Nehalem", ("AVX", "AVX2", "FMA", *AVX512)), "x86-64-v3": (V3, "Haswell", AVX512)}


def environment(target):
    """Variables that make it so."""
    kept, core, without = TARGETS[target]
    left_out = [name for name in __cpu_dispatch__ if name not in kept and __cpu_features__.get(name)]
    return {
        "CC": f"{os.environ.get('CC', 'cc')} -march={target}",
        "NPY_DISABLE_CPU_FEATURES": " ".join(left_out),
        "OPENBLAS_CORETYPE": core,
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join(f"-{name}" for name in without),
    }


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in TARGETS:
        sys.exit(f"python -m tools.older TARGET [arguments of pytest]; targets: {', '.join(TARGETS)}")
    variables = environment(sys.argv[1])
    print(" ".join(f"{name}={shlex.quote(value)}" for name, value in variables.items()))
    command = [sys.executable, "-m", "pytest", *sys.argv[2:]]
    os.execve(sys.executable, command, os.environ | variables)
