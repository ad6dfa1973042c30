"""Files for other programs, and what they leave out."""

import json
from pathlib import Path

import numpy as np
import scipy.io

import flexapod as fx
from flexapod.exchange.uff import uff

study = fx.preset("paper-robot")
short = fx.simulate(study, fidelity="assumed-modes", modes=1, step=1e-3, duration=0.02, output_step=5e-3)
machine = fx.load("robot.toml")
made = {
    "abaqus": fx.export(study, "abaqus", "paper.inp", modes=6, pose={"heave": 0.02}),
    "mjcf": fx.export(study, "mjcf", "paper.xml", fidelity="rigid"),
    "gltf": fx.export(study, "gltf", "paper.glb", data=short, magnify=100),
    "vtk": fx.export(study, "vtk", "paper.pvd", data=short),
    "mat": fx.export(machine, "mat", "plant.mat", inputs=["wrench", "floor:z"], outputs=["tool", "stroke"]),
    "npz": fx.export(machine, "mat", "plant.npz", inputs="wrench", outputs="tool:z"),
    "c": fx.export(study, "c", "steps", step=1e-3, commands="motion"),
}
plant = scipy.io.loadmat("plant.mat")
deck = Path("paper.inp").read_text()
nodes = deck.splitlines()
response = fx.linearize(machine, inputs="wrench:fz", outputs="tool:z").frequency_response([10.0, 20.0, 30.0])
lines = uff(response).splitlines()
Path("response.uff").write_text("\n".join(lines) + "\n")
again = fx.read_frf("response.uff")
try:
    fx.export(study, "step", "paper.step")
except fx.InputError as error:
    refused = [error.key, str(error.value)]

found = {
    "files": {name: [Path(file).name for file in one.files] for name, one in made.items() if name != "vtk"},
    "series": len(made["vtk"].files),
    "left_out": {name: len(one.left_out) for name, one in made.items()},
    "names": [[str(x).strip() for x in plant[key].ravel()[:3]] for key in ("inputs", "outputs")],
    "sizes": [plant[key].shape for key in "ABCD"],
    "static": (plant["D"] - plant["C"] @ np.linalg.solve(plant["A"], plant["B"]))[2, 2],
    "deck": [sum(line.startswith("*") for line in nodes), len(nodes)],
    "deck_keywords": sorted({line.split(",")[0] for line in nodes if line.startswith("*") and line[1] != "*"}),
    "mjcf": Path("paper.xml").read_text().count("<body"),
    "glb": Path("paper.glb").read_bytes()[:4].decode(),
    "robot_h": [name in Path("steps/robot.h").read_text() for name in ("robot_size", "robot_step", "drive_force")],
    "uff": [lines[1].split(), len(lines)],
    "again": [list(again.sizes), np.abs(again.to_array().values).max()],
    "refused": refused,
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
