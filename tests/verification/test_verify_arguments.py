"""Tolerances of the verification pack that follow from a law: the law itself, against runs of another size."""

import numpy as np
import pytest
from tests.helpers.pack_outcomes import outcome

from flexapod import model
from flexapod.verification.cases import sliding as beam_fem

pytestmark = [pytest.mark.consistency, pytest.mark.xdist_group("pack of sliding")]  # one process computes its cases


def test_the_gap_of_six_elements_is_that_of_modes_that_run_ahead():
    """The pack's law for twelve elements, at six and over 2 s, where fewer modes have lost their step."""
    t = np.arange(401) * beam_fem.OUTPUT_STEP
    study = model.override(model.preset("paper-actuator"), duration=2.0)
    elements = beam_fem._tip(study, fidelity="beam-fem", modes=12)
    modes = beam_fem._tip(study, fidelity="assumed-modes", basis="clamped-free", modes=beam_fem.SHAPES)
    gap, (law, bound) = elements - modes, beam_fem.predicted_gap(6, t)
    # Mode 3 and 4 of six elements: lambda / n = 1.3 and 1.8, where the next term takes 10 and 18 % off the lead.
    assert np.sqrt((gap**2).mean()) == pytest.approx(np.sqrt((law**2).mean()), rel=0.1)
    assert np.abs(gap).max() < bound.max()
    assert (np.abs(law) <= bound).all()


def test_the_tolerances_are_those_of_the_law():
    """A thousandth of the peak stood there once, less than the argument for it gave."""
    rows = {row.what: row for row in outcome("beam-fem").checks}
    t = np.arange(2001) * beam_fem.OUTPUT_STEP
    law, bound = beam_fem.predicted_gap(beam_fem.ELEMENTS, t)
    peak = rows["largest deflection"].reference
    assert rows["largest difference in 10 s"].tolerance == pytest.approx(bound.max() / peak, rel=1e-12)
    assert rows["root mean square difference in 10 s"].reference == pytest.approx(np.sqrt((law**2).mean()), rel=1e-12)
    assert all(row.within_tolerance for row in rows.values())
    # Eleven elements would be off by (12 / 11)^4, which the root mean squares tell from twelve.
    fewer, _ = beam_fem.predicted_gap(11, t)
    assert np.sqrt((fewer**2).mean()) > 1.2 * rows["root mean square difference in 10 s"].ours
