"""What `flexapod modes` says: frequencies, damping and kinds at a pose, and how much disturbances shake it there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.analysis.results.idealizations import held
from flexapod.common.quantities import column, sentence, signed
from flexapod.output.text.parts import Item, TextTable, warnings_of

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.common.arrays import Array


def modes_items(
    study: model.Study | model.ActuatorStudy, data: Dataset, pose: str | None, count: int, shaken: Sequence[str]
) -> Iterator[Item]:
    """Where the modes are, a table of the lowest `count`, how disturbances have `shaken` the robot, warnings."""
    yield f"{_held(study, data, pose)}."
    yield ""
    shown = data.isel(mode=slice(0, count))
    _, frequencies = column(shown.frequency.values, "Hz", 6)
    _, ratios = column(100 * shown.damping_ratio.values, "")
    head, columns = ["mode", "frequency [Hz]", "damping [%]"], [frequencies, ratios]
    if "payload_share" in shown:  # of a robot
        head += ["of the payload [%]", "of the legs [%]"]
        columns += [_per_cent(shown.payload_share.values), _per_cent(shown.leg_share.values.sum(axis=-1))]
    rows = zip(map(str, shown.mode.values), *columns, map(str, shown.kind.values), strict=True)
    yield TextTable([*head, "what moves most, by its kinetic energy"], list(rows), left=(len(head),))
    if data.sizes["mode"] > count:
        yield f"The lowest {count} of {data.sizes['mode']} modes; more with --count."
    yield from map(sentence, shaken)
    yield from map("Warning: {}".format, warnings_of(data))


def _held(study: model.Study | model.ActuatorStudy, data: Dataset, pose: str | None) -> str:
    if isinstance(study, model.ActuatorStudy):
        free = study.actuator.free_length
        return f"Hub and extension held, about the straight beam, {free:.4g} m of it outside the hub"
    where = f"at {pose} from home" if pose else "at home"
    rest = f"about the static equilibrium (the centre of mass is off by {signed(data.com_sag.values)})"
    return f"{held(study.robot)}, {where}, {rest}"


def _per_cent(shares: Array) -> list[str]:
    return [f"{100 * abs(share):.0f}" for share in shares]


def modes_as_dict(data: Dataset, shaken: Dataset | None, files: Sequence[Path]) -> dict[str, object]:
    """Modes as plain data, with what vibrates by disturbances."""
    names = [name for name in ("mode", "frequency", "damping_ratio", "kind", "payload_share") if name in data.variables]
    columns = [data[name].values.tolist() for name in names]
    return {
        "modes": [dict(zip(names, mode, strict=True)) for mode in zip(*columns, strict=True)],
        **({"com_sag": data.com_sag.values.tolist()} if "com_sag" in data else {}),
        **({} if shaken is None else {"vibration_rms": shaken.vibration_rms.values.tolist()}),
        "warnings": warnings_of(data),
        "files": files,
    }
