"""Motions as time series for ParaView, read by another reader: points, displacements and results are the Dataset's."""

from xml.etree import ElementTree

import numpy as np
import pytest
from tests.helpers.readers import VtuReader
from tests.helpers.samples import MECHANISMS

import flexapod as fx
from flexapod.analysis.results.variables import VARIABLES
from flexapod.kinematics.rotations import matrix
from flexapod.model import override

pytestmark = pytest.mark.consistency

LINE, TRIANGLE, STATIONS = 4, 5, 25


@pytest.fixture(scope="module", params=["tripod", "hexaglide"])
def series(request, tmp_path_factory):
    """A study, its result, and the files of both by instant."""
    sample = MECHANISMS / f"{request.param}.toml"
    study = override(fx.load(sample), output_step=0.1)
    data = fx.simulate(study)
    found = fx.export(study, "vtk", tmp_path_factory.mktemp("vtk") / "motion.pvd", data=data)
    return study, data, found


def files_of(found):
    """Instants and files, as the .pvd lists them."""
    rows = ElementTree.parse(found.path).getroot().findall("Collection/DataSet")
    assert all(row.get("file").startswith("motion/motion_") for row in rows)
    return [(float(row.get("timestep")), VtuReader(found.path.parent / row.get("file"))) for row in rows]


def test_all_instants_are_listed_and_all_files_are(series):
    _, data, found = series
    listed = files_of(found)
    assert [time for time, _ in listed] == data.time.values.tolist()
    assert [grid.arrays["FieldData", "TimeValue"] for _, grid in listed] == data.time.values.tolist()
    assert set(found.files) == {found.path, *(found.path.parent / "motion").iterdir()}


def test_points_and_displacements_are_those_of_the_result(series):
    """The rigid robot where the points are, the flexible one displaced: joints at the platform to rounding, 1e-15 m.

    Pistons bend off the lines that join their ends by `tip_deflection` or less.
    """
    study, data, found = series
    robot, count = study.robot, study.robot.count
    for k, (_, grid) in enumerate(files_of(found)):
        points, moved = grid.arrays["Points", "points"], grid.arrays["PointData", "displacement"]
        pistons = [cell for kind, cell in grid.cells if kind == LINE and len(cell) == STATIONS]
        assert len(pistons) == count and sum(kind == TRIANGLE for kind, _ in grid.cells) > 3
        for ending, places in (("_rigid", points), ("", points + moved)):
            R = matrix(data[f"platform_quaternion{ending}"].values[k])
            tips = data[f"com_position{ending}"].values[k] + (robot.platform_joints - robot.com) @ R.T
            for cell, tip in zip(pistons, tips, strict=True):
                assert places[cell[-1]] == pytest.approx(tip, abs=1e-14)
        for i, cell in enumerate(pistons):
            line = (points + moved)[cell]
            straight = line[0] + np.linspace(0, 1, STATIONS)[:, None] * (line[-1] - line[0])
            bent = np.linalg.norm(line - straight, axis=1).max()
            assert bent <= np.linalg.norm(data.tip_deflection.values[k, i]) + 1e-12


def test_results_stand_in_cells_and_field_under_their_names(series):
    study, data, found = series
    grid, k = files_of(found)[3][1], 3
    leg = grid.arrays["CellData", "leg"]
    assert sorted(set(leg)) == list(range(study.robot.count + 1))
    for (section, name), values in grid.arrays.items():
        if section == "FieldData" and name != "TimeValue":
            assert np.array_equal(np.ravel(values), np.ravel(data[name].values[k]), equal_nan=True), name
        if section == "CellData" and name != "leg":
            assert np.array_equal(values[leg > 0], data[name].values[k][leg[leg > 0] - 1], equal_nan=True), name
            assert np.isnan(values[leg == 0]).all()
    names = {name for section, name in grid.arrays if section in ("FieldData", "CellData")} - {"TimeValue", "leg"}
    assert names <= set(VARIABLES) and {"com_deviation", "drive_force", "energy_strain"} <= names
    (words,) = found.left_out
    assert set(words.split(": ")[1].split(", ")) == set(data.data_vars) - names


def test_radii_are_those_of_the_pistons_and_no_path_is_told(series):
    study, _, found = series
    grid = files_of(found)[0][1]
    radius = grid.arrays["PointData", "radius"]
    piston = next(cell for kind, cell in grid.cells if kind == LINE and len(cell) == STATIONS)
    assert radius[piston] == pytest.approx(study.robot.legs[0].piston.diameter / 2)
    for path in found.files:
        assert str(found.path.parent) not in path.read_text(encoding="ascii")


def test_plates_turn_with_their_platform_and_lines_belong_to_their_legs(series):
    """In platform axes corners stand still; cylinders go from base joints to mouths, rails through their own joints."""
    study, data, found = series
    robot = study.robot
    seen = []
    for k, (_, grid) in enumerate(files_of(found)):
        points, radius = grid.arrays["Points", "points"], grid.arrays["PointData", "radius"]
        legs = grid.arrays["CellData", "leg"].astype(int).ravel()
        corners = sorted({int(i) for kind, cell in grid.cells if kind == TRIANGLE for i in cell})
        R = matrix(data.platform_quaternion_rigid.values[k])
        seen.append((points[corners] - data.com_position_rigid.values[k]) @ R)
        lines = [(leg, cell) for leg, (kind, cell) in zip(legs, grid.cells, strict=True) if kind == LINE]
        pistons = {leg: cell for leg, cell in lines if len(cell) == STATIONS}
        tubes = {leg: cell for leg, cell in lines[: robot.count]}
        assert set(pistons) == set(tubes) == set(range(1, robot.count + 1))
        for leg, cell in tubes.items():
            foot, mouth = points[cell]
            assert mouth == pytest.approx(points[pistons[leg][0]], abs=1e-12)
            assert radius[cell] == pytest.approx(1.5 * radius[pistons[leg][0]])
            for rail in (other for of, other in lines[2 * robot.count :] if of == leg):
                start, end = points[rail]
                along = (end - start) / np.linalg.norm(end - start)
                assert np.linalg.norm(np.cross(foot - start, along)) < 1e-12
        rails = [leg for leg, _ in lines[2 * robot.count :]]
        assert rails == [i + 1 for i, leg in enumerate(robot.legs) if leg.carriage is not None]
    assert np.ptp(seen, axis=0).max() < 1e-12
    # each corner is half a thickness, 0.02 of the robot's size, from a joint of the platform
    away = np.linalg.norm(robot.platform_joints - robot.com - seen[0][:, None], axis=2).min(axis=1)
    assert away.max() < 0.1 * np.ptp(robot.platform_joints, axis=0).max()
