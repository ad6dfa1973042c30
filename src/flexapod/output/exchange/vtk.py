"""A motion as a time series for ParaView: a file for each instant, and one that lists them."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.output.exchange.animation import motion_result
from flexapod.output.exchange.formats import Content
from flexapod.output.scene.geometry import RobotMotion, plate
from flexapod.output.scene.skeleton import Scene, Skeleton

if TYPE_CHECKING:
    from xarray import Dataset

LINE, TRIANGLE = 4, 5  # kinds of cells
TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}
HEAD = '<?xml version="1.0"?>\n<VTKFile type="{}" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'


def vtk(study: model.Study, *, name: str, data: Dataset | None = None) -> Content:
    """The motion of a result of the study, which is simulated where none is given, as file `name`.

    It lists those of all instants in a folder beside it. Points stand where the rigid robot is; `displacement` brings
    them to the flexible one. Results of legs are data of cells, those of the whole robot of the field, under their
    names.
    """
    data = motion_result(study, data)
    motion = RobotMotion(study, data)
    cells, field, legs = _Cells(motion.skeleton), _series(data, _WHOLE), _series(data, _LEGS)
    stem = Path(name).stem
    places = [f"{stem}/{stem}_{k:06d}.vtu" for k in range(len(motion.time))]
    rows = (f'<DataSet timestep="{float(t)!r}" file="{x}"/>' for t, x in zip(motion.time, places, strict=True))
    listed = HEAD.format("Collection") + "<Collection>\n" + "\n".join(rows) + "\n</Collection>\n</VTKFile>\n"
    files = {"": listed}
    for k, (t, place) in enumerate(zip(motion.time, places, strict=True)):
        found = motion.instant_at(float(t), 1.0)
        own = {"TimeValue": np.array([float(t)])} | {name: np.reshape(x[k], (1, -1)) for name, x in field.items()}
        files[place] = _grid(cells, found.rigid, found.flexible, own, {name: x[k] for name, x in legs.items()})
    others = [str(name) for name in data.data_vars if name not in field and name not in legs]
    return Content(
        files=files,
        left_out=(f"results that are neither of a leg nor of the whole robot: {', '.join(others)}",) * bool(others),
        remarks=("In ParaView: Warp By Vector with `displacement`, Tube with `radius`.",),
    )


class _Cells:
    """Parts of all files that do not change: order of the points, cells on them, their legs, their radii.

    Points are cylinders from base joint to mouth, then pistons, then rails and cranks, then the platform's plate.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        home, robot = skeleton.home, skeleton.robot
        count, stations = home.piston.shape[:2]
        self.plate, faces = plate(robot.platform_joints, 0.02 * skeleton.size)
        lines = [2] * count + [stations] * count + [2] * len(home.guides)
        ends = np.cumsum([0, *lines])
        pieces = [np.arange(a, b) for a, b in pairwise(ends)]
        pieces += list(faces.astype(int) + ends[-1])
        self.connectivity = np.concatenate(pieces)
        self.offsets = np.cumsum([len(x) for x in pieces])
        self.types = np.array([LINE] * len(lines) + [TRIANGLE] * len(faces), dtype=np.uint8)
        legs = [*range(1, count + 1)] * 2 + [int(i) + 1 for i in skeleton.guided] + [0] * len(faces)
        self.leg = np.array(legs)
        radii = np.where(np.isfinite(home.radii), home.radii, 0.02 * skeleton.size)
        thin = np.zeros(2 * len(home.guides) + len(self.plate))
        self.radius = np.concatenate([1.5 * np.repeat(radii[:, 0], 2), radii.ravel(), thin])

    def points(self, scene: Scene) -> Array:
        """Positions of the points in a scene, (n, 3) [m]."""
        cylinders = np.stack([scene.base, scene.mouth], axis=1)
        corners = scene.centre + self.plate @ scene.rotation.T
        return np.concatenate([x.reshape(-1, 3) for x in (cylinders, scene.piston, scene.guides, corners)])


def _grid(cells: _Cells, rigid: Scene, flexible: Scene, field: Mapping[str, Array], legs: Mapping[str, Array]) -> str:
    points = cells.points(rigid)
    displacement = cells.points(flexible) - points
    found = [HEAD.format("UnstructuredGrid"), "<UnstructuredGrid>\n", *_section("FieldData", field)]
    found.append(f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells.types)}">\n')
    of_legs = {name: np.concatenate([np.full((1, *x.shape[1:]), np.nan), x])[cells.leg] for name, x in legs.items()}
    found += _section("PointData", {"displacement": displacement, "radius": cells.radius})
    found += _section("CellData", {"leg": cells.leg, **of_legs})
    found += _section("Points", {"points": points})
    of_cells = {"connectivity": cells.connectivity, "offsets": cells.offsets, "types": cells.types}
    found += _section("Cells", of_cells)
    return "".join([*found, "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"])


def _section(name: str, arrays: Mapping[str, ArrayLike]) -> Iterator[str]:
    yield f"<{name}>\n"
    for key, values in arrays.items():
        yield _array(key, np.asarray(values), "NumberOfTuples" if name == "FieldData" else "")
    yield f"</{name}>\n"


def _array(name: str, values: NDArray[Any], count: str = "") -> str:
    """Numbers, (n,) or (n, m), in base64 behind their length in bytes."""
    kind = values.dtype.kind
    stored = np.ascontiguousarray(values, dtype={"f": "<f8", "i": "<i8", "u": "u1"}[kind])
    text = base64.b64encode(np.array(stored.nbytes, dtype="<u8").tobytes() + stored.tobytes()).decode()
    width = 1 if values.ndim == 1 else values.shape[1]
    more = f' {count}="{len(values)}"' if count else ""
    return (
        f'<DataArray type="{TYPES[kind]}" Name="{name}" NumberOfComponents="{width}"{more} format="binary">'
        f"{text}</DataArray>\n"
    )


_WHOLE = ((), ("axis",), ("quaternion",))
_LEGS = (("leg",), ("leg", "axis"))


def _series(data: Dataset, forms: tuple[tuple[str, ...], ...]) -> dict[str, Array]:
    """Results over time of some forms, time first."""
    found = {}
    for name, values in data.data_vars.items():
        if values.dtype.kind == "f" and values.dims in {("time", *form) for form in forms}:
            found[str(name)] = values.values
    return found
