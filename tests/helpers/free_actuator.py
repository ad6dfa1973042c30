"""A beam set free on its hub."""

import flexapod as fx
from flexapod import model

STUDY = fx.preset("paper-actuator")
NONE = {"law": "constant", "value": 0.0}
RATES = {"angle_rate": 0.785, "length_rate": 0.1}


def free(tip=5e-3, force=0.0, **settings):
    study = STUDY.replace(
        actuator=STUDY.actuator.replace(hub_inertia=2.0),
        motion={"rotation": None, "extension": None},
        load={"torque": NONE, "force": {"law": "constant", "value": force}},
        initial={"tip_displacement": tip, **(RATES if not force else {})},
    )
    return model.override(study, **({"duration": 3.0} | settings))


def inertia(length):
    """Of hub and straight beam about the pivot [kg m^2]."""
    return 2.0 + 4.02 * (length**3 - (length - 3.66) ** 3) / 3
