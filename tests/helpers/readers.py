"""Readers of exported files that share no code with their writers."""

import base64
import json
import struct
from xml.etree import ElementTree

import numpy as np

SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
TYPES = {5126: "<f4", 5125: "<u4", 5123: "<u2"}


class GlbReader:
    """A GLB file: its JSON, arrays, and where vertices are in the world, y up, at an instant of its animation."""

    def __init__(self, path):
        content = path.read_bytes()
        magic, version, whole = struct.unpack_from("<4sII", content)
        size, kind = struct.unpack_from("<I4s", content, 12)
        rest, tail = struct.unpack_from("<I4s", content, 20 + size)
        assert (magic, version, whole, kind, tail) == (b"glTF", 2, len(content), b"JSON", b"BIN\0")
        assert size % 4 == rest % 4 == 0 and 28 + size + rest == whole
        self.json, self.bytes = json.loads(content[20 : 20 + size]), content[28 + size :]
        assert self.json["buffers"] == [{"byteLength": rest}]
        self.arrays = [self._array(x) for x in self.json["accessors"]]
        self.nodes = {node["name"]: i for i, node in enumerate(self.json["nodes"])}
        self.parents = {child: i for i, node in enumerate(self.json["nodes"]) for child in node.get("children", ())}
        animation = self.json.get("animations", [{"channels": [], "samplers": []}])[0]
        self.tracks = {}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler["interpolation"] == "LINEAR"
            place = channel["target"]["node"], channel["target"]["path"]
            self.tracks[place] = self.arrays[sampler["input"]], self.arrays[sampler["output"]]

    def _array(self, entry):
        view, width = self.json["bufferViews"][entry["bufferView"]], SIZES[entry["type"]]
        assert view["byteOffset"] % 4 == 0 and view["byteOffset"] + view["byteLength"] <= len(self.bytes)
        found = np.frombuffer(self.bytes, TYPES[entry["componentType"]], entry["count"] * width, view["byteOffset"])
        assert found.nbytes == view["byteLength"] and np.isfinite(found).all()
        found = found.reshape(-1, width).astype(float)
        for name, of in (("min", np.min), ("max", np.max)):
            assert name not in entry or np.array_equal(of(found, axis=0), entry[name])
        return found[:, 0] if width == 1 else found

    def value(self, node, path, k, default):
        """Of a node at instant k."""
        if (node, path) in self.tracks:
            time, values = self.tracks[node, path]
            return values.reshape(len(time), -1)[k]
        return np.array(self.json["nodes"][node].get(path, default), dtype=float)

    def transform(self, node, k):
        """Node to world, (4, 4), at instant k."""
        x, y, z, w = self.value(node, "rotation", k, [0, 0, 0, 1])
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        assert abs(x * x + y * y + z * z + w * w - 1) < 1e-6
        found = np.eye(4)
        found[:3, :3] = (np.eye(3) + 2 * w * cross + 2 * cross @ cross) * self.value(node, "scale", k, [1, 1, 1])
        found[:3, 3] = self.value(node, "translation", k, [0, 0, 0])
        return self.transform(self.parents[node], k) @ found if node in self.parents else found

    def local(self, name, k):
        """Vertices of a node's mesh in its own axes at instant k, bent by its weights, (n, 3)."""
        node = self.nodes[name]
        primitive = self.json["meshes"][self.json["nodes"][node]["mesh"]]["primitives"][0]
        found = self.arrays[primitive["attributes"]["POSITION"]]
        assert self.arrays[primitive["indices"]].max() < len(found)
        targets = primitive.get("targets", [])
        weights = self.value(node, "weights", k, [0] * len(targets))
        return found + sum(w * self.arrays[x["POSITION"]] for w, x in zip(weights, targets, strict=True))

    def vertices(self, name, k):
        """The same in the world."""
        T, found = self.transform(self.nodes[name], k), self.local(name, k)
        return found @ T[:3, :3].T + T[:3, 3]


def z_up(points):
    """From axes with y up to those with z up."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


class VtuReader:
    """A .vtu file with base64 arrays: `arrays` by section and name, `cells` as (kind, points)."""

    def __init__(self, path):
        root = ElementTree.parse(path).getroot()
        assert root.attrib == {
            "type": "UnstructuredGrid", "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64",
        }  # fmt: skip
        self.arrays = {}
        for section in ("FieldData", "PointData", "CellData", "Points", "Cells"):
            for entry in root.find(f".//{section}"):
                self.arrays[section, entry.get("Name")] = self._array(entry)
        piece = root.find(".//Piece")
        points, kinds = self.arrays["Points", "points"], self.arrays["Cells", "types"]
        assert (len(points), len(kinds)) == (int(piece.get("NumberOfPoints")), int(piece.get("NumberOfCells")))
        ends = self.arrays["Cells", "offsets"]
        order = self.arrays["Cells", "connectivity"]
        assert ends[-1] == len(order) and order.min() == 0 and order.max() == len(points) - 1
        self.cells = [(int(k), order[a:b]) for k, a, b in zip(kinds, [0, *ends[:-1]], ends, strict=True)]

    @staticmethod
    def _array(entry):
        content = base64.b64decode(entry.text)
        (size,) = struct.unpack_from("<Q", content)
        assert size == len(content) - 8 and entry.get("format") == "binary"
        found = np.frombuffer(content[8:], {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}[entry.get("type")])
        width = int(entry.get("NumberOfComponents"))
        assert int(entry.get("NumberOfTuples", len(found) // width)) * width == len(found)
        return found if width == 1 else found.reshape(-1, width)
