"""The independent programs: how to tell whether one is there, and the line that installs it."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from importlib.util import find_spec


@dataclass(frozen=True, kw_only=True)
class Engine:
    """An engine: its `name`, the `program` or Python `module` to look for, and the line that installs it."""

    name: str
    install: str
    program: str = ""
    module: str = ""

    def is_available(self) -> bool:
        """Test whether the engine can be called from here; nothing is started or imported."""
        return bool(shutil.which(self.program)) if self.program else find_spec(self.module) is not None


CALCULIX = Engine(name="CalculiX", program="ccx", install="apt-get install calculix-ccx")
EXUDYN = Engine(name="Exudyn", module="exudyn", install='pip install "flexapod[verify]"')
MUJOCO = Engine(name="MuJoCo", module="mujoco", install='pip install "flexapod[verify]"')
