"""Where the nodes of a glTF scene are."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._core import Error
from .gltf_data import GltfData
from .gltf_document import Json


def placed_nodes(document: Json) -> list[tuple[int, Json, np.ndarray]]:
    """The nodes of the scene that is shown, by their numbers: the order of lights must not depend on
    anything else. Each with its 4 x 4 matrix.
    """
    nodes: list[Json] = document.get("nodes", [])
    found: dict[int, np.ndarray] = {}
    waiting = [(root, np.eye(4)) for root in _roots(document)]
    while waiting:
        index, parent = waiting.pop()
        if index in found:
            raise Error(f"node {index}: is in the tree of nodes twice")
        found[index] = parent @ _matrix_of(nodes[index])
        waiting += [(child, found[index]) for child in nodes[index].get("children", [])]
    return [(index, nodes[index], found[index]) for index in sorted(found)]


def _roots(document: Json) -> list[int]:
    scenes = document.get("scenes", [])
    if scenes:
        shown: list[int] = scenes[document.get("scene", 0)].get("nodes", [])
        return shown
    nodes = document.get("nodes", [])
    children = {child for node in nodes for child in node.get("children", [])}
    return [index for index in range(len(nodes)) if index not in children]


def _matrix_of(node: Json) -> np.ndarray:
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    return _trs(
        np.array([node.get("translation", (0.0, 0.0, 0.0))], float),
        np.array([node.get("rotation", (0.0, 0.0, 0.0, 1.0))], float),
        np.array([node.get("scale", (1.0, 1.0, 1.0))], float),
    )[0]


def _trs(translation: np.ndarray, rotation: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """4 x 4 matrices of translations (N, 3), quaternions x, y, z, w (N, 4) and scales (N, 3)."""
    lengths = np.linalg.norm(rotation, axis=1, keepdims=True)
    x, y, z, w = np.divide(rotation, lengths, out=np.zeros_like(rotation), where=lengths > 0).T
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    matrices = np.zeros((len(translation), 4, 4))
    matrices[:, :3, :3] = turn.transpose(2, 0, 1) * scale[:, None, :]
    matrices[:, :3, 3] = translation
    matrices[:, 3, 3] = 1.0
    return matrices


def instances_of(node: Json, data: GltfData) -> np.ndarray:
    """The matrices by which a node's mesh stands within the node, (N, 4, 4), more than one by
    EXT_mesh_gpu_instancing.
    """
    instancing = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
    if instancing is None:
        return np.eye(4)[None]
    given: dict[str, Any] = {
        name: data.accessor(index).astype(float)
        for name, index in instancing["attributes"].items()
        if name in ("TRANSLATION", "ROTATION", "SCALE")
    }
    count = max((len(values) for values in given.values()), default=0)
    return _trs(
        given.get("TRANSLATION", np.zeros((count, 3))),
        given.get("ROTATION", np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))),
        given.get("SCALE", np.ones((count, 3))),
    )
