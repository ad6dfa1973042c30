"""Results can be drawn without the files that their study was read from."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.analysis.results.attributes import motion_coordinates
from flexapod.model import preset, preset_text
from flexapod.output.scene.robot_scene import mode_scene, scene

pytestmark = pytest.mark.unit


def test_a_result_whose_motion_table_is_gone_is_still_drawn(tmp_path):
    head = preset_text("paper-robot").split("[motion]")[0]
    table = tmp_path / "path.csv"
    t = np.linspace(0.0, 0.02, 21)
    rows = "\n".join(f"{x:.3f},{1e-3 * (x / 0.02) ** 3:.9f}" for x in t)
    table.write_text(f"time [s],heave [m]\n{rows}\n", encoding="utf-8")
    file = tmp_path / "robot.toml"
    file.write_text(
        f'{head}[motion]\ntype = "csv"\nfile = "path.csv"\n[simulation]\nfidelity = "rigid"\nstep = "1 ms"\n',
        encoding="utf-8",
    )
    data = fx.run(fx.load(file))
    modes = fx.modes(fx.load(file), fidelity="lumped")
    table.unlink()
    assert np.allclose(scene(data, 0.02).com - scene(data, 0.0).com, [0, 0, 1e-3], atol=1e-9)
    assert mode_scene(modes, 1, 0.05).piston.shape == (6, 25, 3)
    heave = motion_coordinates(data).position.sel(coordinate="heave").values
    assert np.allclose(heave, data.translation_command.sel(axis="z"), rtol=0, atol=0)
    assert heave[-1] > 0.99e-3


def test_a_bent_piston_is_drawn_as_a_cantilever_that_meets_its_platform():
    robot = preset("paper-robot").robot
    data = fx.simulate(preset("paper-robot"), fidelity="lumped", duration=2e-3, step=1e-3)
    bent = data.tip_deflection.copy(data=np.zeros(data.tip_deflection.shape))
    bent[:, 2, 0] = 1e-3
    drawn = scene(data.assign(tip_deflection=bent), 0.0, magnify=10.0)
    np.testing.assert_allclose(drawn.piston[:, -1], drawn.platform, atol=1e-12)
    length, mouth = robot.home_lengths[2], robot.legs[2].cylinder.mouth
    line = (drawn.platform[2] - drawn.base[2]) / np.linalg.norm(drawn.platform[2] - drawn.base[2])
    middle = drawn.piston[2, 12] - drawn.base[2]
    # 10 mm at the tip; a cantilever bends by 5/16 of that half way, and its cylinder leans by tip over length. The sag
    # of 20 um changes lengths by as much.
    leans = (mouth + 0.5 * (length - mouth)) / length
    aside = np.linalg.norm(middle - (middle @ line) * line)
    assert aside == pytest.approx(10e-3 * abs(5 / 16 - leans), rel=1e-3)
