"""Universal Scene Description, by Pixar's usd-core."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .._core import Error
from ..camera import Camera, triple
from ..scene import Scene
from .model import PlacedMeshes
from .unsupported import Notes

_GPRIMS = ("Sphere", "Cube", "Cylinder", "Cone", "Capsule", "Plane", "NurbsPatch", "BasisCurves", "Points")


def fill_from_usd(path: Path, scene: Scene, notes: Notes) -> None:
    """Fills a scene from a .usd, .usda, .usdc or .usdz file, at its first moment."""
    try:
        from pxr import Tf, Usd, UsdUtils
    except ImportError as error:
        raise Error("needs usd-core: pip install 'lightcull[usd]'") from error
    # What USD says of a file goes here, not to the terminal.
    _diagnostics = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        stage = Usd.Stage.Open(str(path))
        _Filling(stage, scene, notes).fill()
    except Tf.ErrorException as error:
        raise Error(f"cannot be read: {_first_line(error)}") from error


def _first_line(error: BaseException) -> str:
    """The reason in what USD says, which names its own sources before it."""
    try:
        text = " ".join(str(error).split())
    except UnicodeDecodeError:  # it shows the bytes that it met
        return "its text is not UTF-8"
    return text.rsplit(": ", 1)[-1][:200] or "is no USD file"


@dataclass(frozen=True)
class _Placed:
    """A prim, and the 4 x 4 matrix that takes its points into the scene."""

    prim: Any
    matrix: np.ndarray


class _Filling:
    """What one stage becomes."""

    def __init__(self, stage: Any, scene: Scene, notes: Notes) -> None:
        from pxr import Usd, UsdGeom

        from .usd_lights import UsdLights
        from .usd_materials import UsdMaterials
        from .usd_meshes import UsdMeshes, source_of

        self._stage = stage
        self._scene = scene
        self._notes = notes
        self._time = Usd.TimeCode.EarliestTime()
        self._cache = UsdGeom.XformCache(self._time)
        self._unit = float(UsdGeom.GetStageMetersPerUnit(stage))
        z_is_up = UsdGeom.GetStageUpAxis(stage) == "Z"
        self._to_scene = _to_y_up(z_is_up, self._unit)
        materials = UsdMaterials(scene, notes, self._time)
        self._lights = UsdLights(scene, notes, self._time, self._unit, z_is_up=z_is_up)
        self._places = list(self._walk(stage.GetPseudoRoot(), self._to_scene, np.eye(4)))
        prims = [placed.prim for placed in self._places]
        uses = Counter(source_of(prim) for prim in prims if prim.IsA(UsdGeom.Mesh))
        meshes = PlacedMeshes(scene, notes, uses)
        self._meshes = UsdMeshes(meshes, notes, self._time, materials, self._lights)

    def fill(self) -> None:
        """Adds all that is seen."""
        for placed in self._places:
            self._add(placed)

    def _walk(self, root: Any, to_scene: np.ndarray, from_root: np.ndarray) -> Iterator[_Placed]:
        """The prims below a root that are seen; from_root: takes the world to where the root is taken
        to stand.
        """
        from pxr import Usd, UsdGeom

        walk = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies()))
        for prim in walk:
            imageable = UsdGeom.Imageable(prim)
            if imageable and not _is_seen(imageable, self._time):
                walk.PruneChildren()
                continue
            world = np.array(self._cache.GetLocalToWorldTransform(prim)).T
            matrix = to_scene @ from_root @ world
            if prim.IsA(UsdGeom.PointInstancer):
                walk.PruneChildren()
                yield from self._instances(UsdGeom.PointInstancer(prim), matrix)
                continue
            yield _Placed(prim, matrix)

    def _instances(self, instancer: Any, matrix: np.ndarray) -> Iterator[_Placed]:
        from pxr import UsdGeom

        indices = instancer.GetProtoIndicesAttr().Get(self._time)
        if not indices:
            return
        transforms = np.array(
            instancer.ComputeInstanceTransformsAtTime(
                self._time, self._time, UsdGeom.PointInstancer.ExcludeProtoXform
            )
        ).transpose(0, 2, 1)
        mask = instancer.ComputeMaskAtTime(self._time)
        if len(mask):
            indices = [i for i, shown in zip(indices, mask, strict=True) if shown]
        roots = [
            self._stage.GetPrimAtPath(path)
            for path in instancer.GetPrototypesRel().GetForwardedTargets()
        ]
        for index, transform in zip(indices, transforms, strict=False):
            root = roots[index]
            parent = np.array(self._cache.GetParentToWorldTransform(root)).T
            yield from self._walk(root, matrix @ transform, np.linalg.inv(parent))

    def _add(self, placed: _Placed) -> None:
        from pxr import UsdGeom, UsdLux

        prim, matrix = placed.prim, placed.matrix
        if prim.IsA(UsdGeom.Mesh):
            self._meshes.add(prim, matrix)
        elif prim.IsA(UsdGeom.Camera):
            self._add_camera(prim, matrix)
        elif prim.HasAPI(UsdLux.LightAPI) or prim.IsA(UsdLux.NonboundableLightBase):
            self._lights.add(prim, matrix)
        elif prim.GetTypeName() in _GPRIMS:
            self._notes.left_out(f"{prim.GetTypeName()} prims")

    def _add_camera(self, prim: Any, matrix: np.ndarray) -> None:
        from pxr import UsdGeom

        camera = UsdGeom.Camera(prim).GetCamera(self._time)
        origin, away = matrix[:3, 3], matrix[:3, 2]
        lens: dict[str, float] = {}
        if camera.projection == camera.Orthographic:
            # An aperture is in tenths of the stage's unit, of which the matrix has the metres.
            height = camera.verticalAperture * camera.APERTURE_UNIT
            lens["orthographic_height"] = float(height * np.linalg.norm(matrix[:3, 1]))
        else:
            fov = 2.0 * np.arctan(0.5 * camera.verticalAperture / camera.focalLength)
            lens["vertical_fov"] = float(fov)
        self._notes.has_camera = True
        self._scene.add_camera(
            Camera(
                triple(origin),
                triple(origin - away / np.linalg.norm(away)),
                triple(matrix[:3, 1]),
                **lens,
                name=str(prim.GetName()),
            )
        )


def _is_seen(imageable: Any, time: Any) -> bool:
    from pxr import UsdGeom

    purpose = imageable.GetPurposeAttr().Get() if imageable.GetPurposeAttr() else None
    hidden = imageable.GetVisibilityAttr().Get(time) == UsdGeom.Tokens.invisible
    return not hidden and purpose not in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide)


def _to_y_up(z_is_up: bool, unit: float) -> np.ndarray:
    matrix = np.diag([unit, unit, unit, 1.0])
    if z_is_up:
        matrix[:3, :3] = unit * np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    return matrix
