"""What importing flexapod costs, and that its public names lead somewhere."""

import re
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import flexapod
from flexapod.app.cli.commands_view import PACKAGES
from flexapod.verification.engines.engine import EXUDYN, MUJOCO

pytestmark = pytest.mark.meta

HEAVY = ("casadi", "matplotlib", "netCDF4", "pint", "pydantic", "rich", "scipy", "typer", "xarray")


def python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_import_is_light():
    assert python(f"import sys, flexapod; print([m for m in {HEAVY} if m in sys.modules])") == "[]"


def test_the_command_loads_neither_page_nor_proof_nor_paper():
    own = ("flexapod.app.browser", "flexapod.verification.paper", "flexapod.verification")
    code = (
        "import sys, flexapod.app.cli.cli as cli; cli.program(); "
        "print([m for m in sys.modules if m.startswith({names})])"
    )
    assert python(code.format(names=own)) == "[]"
    engines = ("exudyn", "mujoco")  # loaded by what is computed, not by the tables of cases and claims
    code = "import sys, flexapod.{part}; print([m for m in {names} if m in sys.modules])"
    assert python(code.format(part="verification.pack", names=engines)) == "[]"
    assert python(code.format(part="verification.paper.claims", names=engines)) == "[]"


def test_a_command_says_of_itself_what_it_says_among_all():
    """Only the module of the command that is asked for is imported; its help is the one among all commands."""
    code = "import typer, flexapod.app.cli.cli as x; group = typer.main.get_command(x.program({names})); "
    code += "print(group.get_command(typer.Context(group), 'check').get_help(typer.Context(group)))"
    assert python(code.format(names="['check']")) == python(code.format(names="")) != ""
    code = (
        "import sys, flexapod.app.cli.cli as x; x.program(['check']); "
        "print('flexapod.app.cli.commands_run' in sys.modules)"
    )
    assert python(code) == "False"


def test_parts_of_the_distribution_are_what_the_programs_ask_for():
    parts = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"][
        "optional-dependencies"
    ]
    named = {part: {re.match("[a-zA-Z]+", line)[0] for line in lines} for part, lines in parts.items()}
    assert named["page"] == set(PACKAGES)
    assert named["verify"] == {engine.module for engine in (EXUDYN, MUJOCO)}
    assert all("flexapod[verify]" in engine.install for engine in (EXUDYN, MUJOCO))


def test_reading_numbers_needs_no_pint():
    # The preset has texts with units; a study of plain SI numbers must not pay for pint.
    code = (
        "import sys, flexapod as fx; "
        "fx.loads('[actuator]\\nlength = 2\\nrhoA = 1\\nEI = 1\\nfree_length = 1\\n[simulation]\\nduration = 1'); "
        "print('pint' in sys.modules)"
    )
    assert python(code) == "False"


@pytest.mark.parametrize("name", sorted({*flexapod.__all__} - {"__version__"}))
def test_public_names_resolve(name):
    assert getattr(flexapod, name) is not None
    assert name in dir(flexapod)


FACES = ("analysis", "control", "design.sweeps", "kinematics", "model", "output.figures")


@pytest.mark.parametrize("face", FACES)
def test_faces_list_what_they_give(face):
    package = import_module(f"flexapod.{face}")
    assert [name for name in package.__all__ if isinstance(getattr(package, name), ModuleType)] == []
    assert {*package.__all__} == {name for name in dir(package) if not name.startswith("__")}


def test_a_function_is_not_hidden_by_its_module():
    code = (
        "import flexapod.kinematics.mobility, flexapod.output.figures.budget, flexapod as fx; "
        "print(fx.kinematics.mobility.__module__, fx.plot.budget.__module__)"
    )
    assert python(code) == "flexapod.kinematics.mobility flexapod.output.figures.budget"


def test_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert flexapod.__version__ == version("flexapod")


def test_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="simulat_"):
        _ = flexapod.simulat_


def test_a_simulation_needs_no_scipy():
    """It took a third of the time of a whole process; the kernel is compiled before, which needs CasADi."""
    roll = "import sys, gc, flexapod as fx; s = fx.preset('paper-robot'); fx.simulate(s, duration=0.01, step=1e-3); "
    python(roll)
    assert python(f"{roll}print([m for m in ('scipy', 'casadi', 'dask', 'matplotlib') if m in sys.modules])") == "[]"


def test_a_report_without_figures_needs_no_matplotlib(tmp_path):
    code = (
        "import sys, flexapod as fx; from pathlib import Path; from flexapod.output.report.report import write_report; "
        "data = fx.simulate(fx.preset('paper-robot'), duration=0.01, step=1e-3); "
        f"write_report(data, Path({str(tmp_path)!r}), list); print('matplotlib' in sys.modules)"
    )
    assert python(code) == "False"


def test_a_simulation_loads_no_budgets_and_builds_no_tables_that_its_study_lacks():
    code = (
        "import sys, flexapod as fx, flexapod.analysis as study; fx.preset('paper-robot'); "
        "later = [m for m in ('budgets', 'kinematics', 'static') if f'flexapod.analysis.{m}' in sys.modules]; "
        "print(later, fx.model.ScrewDrive.__pydantic_complete__, fx.model.Robot.__pydantic_complete__, "
        "all(getattr(study, name) for name in study.__all__))"
    )
    assert python(code) == "[] False True True"


def test_garbage_is_looked_for_as_before():
    """Imports go without; what is thrown away later, and what was there before, is found."""
    code = (
        "import gc, weakref\n"
        "class Ring: pass\n"
        "early = Ring(); early.me = early; seen = [weakref.ref(early)]\n"
        "import flexapod as fx; fx.simulate\n"
        "late = Ring(); late.me = late; seen.append(weakref.ref(late))\n"
        "del early, late; gc.collect()\n"
        "print(gc.isenabled(), gc.get_freeze_count(), [ring() for ring in seen])"
    )
    assert python(code) == "True 0 [None, None]"


def test_a_former_name_answers_and_says_the_new_one():
    with pytest.warns(FutureWarning, match=r"flexapod\.rigid is flexapod\.kinematics now"):
        assert flexapod.rigid is flexapod.kinematics
