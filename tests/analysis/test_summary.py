"""The answer in a few numbers, and results on disk."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod.analysis import open_results, save, summary
from flexapod.analysis.store import save_csv
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def data():
    study = paper_robot(motion={"duration": 0.2}, duration=0.3, step=1e-3)
    return fx.run(study)


@pytest.mark.parametrize("point", ["com", "tool"])
def test_numbers_of_a_robot(data, point):
    found = summary(data, point)
    off = data[f"{point}_deviation"].values
    size = np.sqrt((off**2).sum(axis=1))
    assert found.peak == size.max()
    assert found.time == float(data.time[size.argmax()])
    assert found.rms == pytest.approx(np.sqrt((off**2).sum(axis=1).mean()))
    assert found.start == size[0]
    assert [a.axis for a in found.axes] == ["x", "y", "z"]
    for i, axis in enumerate(found.axes):
        travel = np.ptp(data[f"{point}_position_rigid"].values[:, i])
        assert axis.peak == np.abs(off[:, i]).max()
        assert axis.excursion == pytest.approx(travel)
        if travel < 1e-6:
            assert axis.per_cent is None
        else:
            assert axis.per_cent == pytest.approx(100 * axis.peak / travel)
    assert found.axes[0].per_cent is None  # a roll about x moves nothing along x
    assert not found.partial


def test_another_point_is_refused(data):
    with pytest.raises(InputError, match="com, tool"):
        summary(data, "elbow")


def test_causes_add_up_and_the_largest_is_named(data):
    found = summary(data)
    assert set(found.causes) == {"axial-strain", "bending", "drive"}
    assert sum(found.causes.values()) == pytest.approx(1.0, abs=1e-3)  # residual of second order
    assert found.largest_cause == "axial-strain"
    assert found.causes["drive"] == 0.0
    at = int(np.linalg.norm(data.com_deviation, axis=1).argmax())
    direction = data.com_deviation.values[at] / np.linalg.norm(data.com_deviation.values[at])
    by_leg = data.deviation_by_cause.isel(time=at).sel(cause="axial-strain").values @ direction
    assert found.worst_leg == by_leg.argmax() + 1
    assert found.worst_leg_share == pytest.approx(by_leg.max() / by_leg.sum())


def test_the_sentence_says_size_axes_and_cause(data):
    found = summary(data)
    micrometres = f"{found.peak * 1e6:.3g} µm"
    assert found.sentence.startswith(f"The payload's centre of mass misses its rigid path by up to {micrometres} (x ")
    assert "the largest cause is stretch of the pistons (" in found.sentence
    assert f"most of it in leg {found.worst_leg}" in found.sentence
    assert summary(data, "tool").sentence.startswith("The tool misses")
    assert found.as_dict()["sentence"] == found.sentence


def test_rigid_legs_need_no_blame():
    found = summary(fx.simulate(paper_robot(), fidelity="rigid", duration=0.02, step=1e-3))
    assert found.peak < 1e-12
    assert found.causes == {}
    assert found.largest_cause is None
    assert found.worst_leg is None
    assert "rigid" in found.sentence


def test_a_leg_that_bends_under_a_fixed_platform_is_not_called_rigid():
    strut = sample_study("strut")
    found = summary(fx.simulate(strut, step=1e-3, duration=0.05))
    assert found.peak == 0 and found.tips > 1e-6 and "tips of legs swing by up to" in found.sentence


def test_numbers_of_an_actuator():
    data = fx.simulate_actuator(fx.preset("paper-actuator"), duration=0.5, step=1e-3)
    found = summary(data)
    tip = data.tip_deflection.values
    assert found.peak == np.abs(tip).max()
    assert found.end == tip[-1]
    assert found.lengths == (1.83, pytest.approx(1.88))
    assert "mm" in found.sentence


def test_partial_results_say_so(data):
    assert summary(data.assign_attrs(partial=1)).partial
    assert "until the computation stopped" in summary(data.assign_attrs(partial=1)).sentence


def test_csv_holds_what_varies_over_time(data, tmp_path):
    path = save_csv(data, tmp_path / "results.csv")
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    columns = head.split(",")
    assert columns[0] == "time [s]"
    assert len(rows) == data.sizes["time"]
    table = np.array([[float(x) for x in row.split(",")] for row in rows])
    for column, values in (
        ("com_deviation.z [m]", data.com_deviation.sel(axis="z")),
        ("actuator_force.3 [N]", data.actuator_force.sel(leg=3)),
        ("deviation_by_cause.bending.2.y [m]", data.deviation_by_cause.sel(cause="bending", leg=2, axis="y")),
    ):
        np.testing.assert_allclose(table[:, columns.index(column)], values, rtol=1e-9)  # ten digits
    assert len(set(columns)) == len(columns)


def test_results_are_replaced_whole_or_not_at_all(data, tmp_path, monkeypatch):
    path = save(data, tmp_path / "results.nc")
    before = path.read_bytes()

    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("flexapod.analysis.store.write", full)
    with pytest.raises(fx.InputError, match="No space left"):
        save(data, path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["results.nc"]


def test_unreadable_results_are_refused(tmp_path):
    import xarray as xr

    with pytest.raises(fx.InputError, match=r"missing\.nc"):
        open_results(tmp_path / "missing.nc")
    text = tmp_path / "text.nc"
    text.write_text("no results")
    with pytest.raises(fx.InputError, match=r"text\.nc"):
        open_results(text)
    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(fx.InputError, match="not a result of flexapod"):
        open_results(tmp_path / "other.nc")
    (tmp_path / "file").write_text("")
    with pytest.raises(fx.InputError, match="cannot be written"):
        save(xr.Dataset(), tmp_path / "file" / "results.nc")


def test_sentence_of_a_beam_that_nothing_bends():
    text = (
        "[actuator]\nlength = 2\nrhoA = 1\nEI = 100\nfree_length = 1\n[motion]\nrotation = { rate = 1 }\n"
        '[simulation]\nfidelity = "rigid"\nduration = 0.1'
    )
    assert "stays on the hub's line" in summary(fx.run(fx.loads(text))).sentence


def test_no_leg_is_blamed_where_all_have_the_same_part(data):
    """Six legs alike under a payload in their middle: the leg that was named was the largest by rounding."""
    alike = data.copy(deep=True)
    alike["deviation_by_cause"][:] = alike.deviation_by_cause.mean("leg") * (1 + 1e-9 * alike.leg)
    found = summary(alike)
    assert found.worst_leg is None and found.worst_leg_share is None
    assert "most of it in leg" not in found.sentence and "%)" in found.sentence
