"""How much do manufacturing tolerances change the deviation of a robot? 20 draws on local workers."""

import flexapod as fx

TOLERANCES = {
    "random": {
        "count": 20,
        "seed": 1,
        "tolerance": [
            {"key": "leg.piston.diameter", "normal": "0.05 mm"},
            {"key": "robot.platform.joints", "uniform": "0.2 mm"},
        ],
    },
    "keep": {"scalars": ["com_deviation_peak"]},
}

if __name__ == "__main__":  # local workers import this file
    study = fx.preset("paper-robot")
    study = study.replace(simulation=study.simulation.replace(fidelity="lumped", tolerance=None, step=1e-3))
    peak = 1e6 * fx.sweep(study, TOLERANCES).com_deviation_peak
    print(f"largest deviation: median {float(peak.median()):.4g} um, all within {float(peak.min()):.4g} and", end=" ")
    print(f"{float(peak.max()):.4g} um")
