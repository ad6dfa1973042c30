"""No module imports one that imports it, imports inside functions counted; those for types alone are none."""

from graphlib import CycleError, TopologicalSorter

import grimp
import pytest

pytestmark = pytest.mark.meta


def test_imports_make_no_circle():
    graph = grimp.build_graph("flexapod", exclude_type_checking_imports=True, cache_dir=None)
    packages = {module for module in graph.modules if graph.find_children(module)}
    imports = {m: graph.find_modules_directly_imported_by(m) - packages for m in graph.modules - packages}
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))
