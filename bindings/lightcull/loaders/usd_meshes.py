"""The meshes of USD."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import UsdGeom, UsdLux, UsdShade

from .._core import Error
from .model import PlacedMeshes, Surface, Triangles, fan_triangles
from .unsupported import Notes
from .usd_lights import UsdLights
from .usd_materials import Look, UsdMaterials


def source_of(prim: Any) -> str:
    """What instances of a mesh have in common."""
    source = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
    return str(source.GetPath())


class UsdMeshes:
    """Adds meshes, in the parts that have materials of their own."""

    def __init__(
        self,
        placed: PlacedMeshes,
        notes: Notes,
        time: Any,
        materials: UsdMaterials,
        lights: UsdLights,
    ) -> None:
        self._placed = placed
        self._notes = notes
        self._time = time
        self._materials = materials
        self._lights = lights

    def add(self, prim: Any, matrix: np.ndarray) -> None:
        """Adds a mesh where it stands."""
        mesh = UsdGeom.Mesh(prim)
        points = mesh.GetPointsAttr().Get(self._time)
        counts = mesh.GetFaceVertexCountsAttr().Get(self._time)
        corners = mesh.GetFaceVertexIndicesAttr().Get(self._time)
        if not points or not counts or not corners:
            return
        scheme = mesh.GetSubdivisionSchemeAttr()
        if scheme.HasAuthoredValue() and scheme.Get() != UsdGeom.Tokens.none:
            self._notes.approximated("subdivision surfaces as their cages")
        shape = _Shape(prim, np.array(points), np.array(counts), np.array(corners), self._time)
        for faces, bound in self._parts(prim, len(counts)):
            self._add_part(prim, shape, faces, bound, matrix)

    def _parts(self, prim: Any, count: int) -> list[tuple[np.ndarray, Any]]:
        """The faces of each material, and the material."""
        binding = UsdShade.MaterialBindingAPI(prim)
        left = np.ones(count, bool)
        parts = []
        for subset in binding.GetMaterialBindSubsets():
            faces = np.array(subset.GetIndicesAttr().Get(self._time) or [], int)
            if len(faces) and (faces.min() < 0 or faces.max() >= count):
                raise Error(f"{prim.GetPath()}: a subset has a face that is not there")
            left[faces] = False
            own = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]
            parts.append((faces, own))
        if left.any():
            parts.append((np.flatnonzero(left), binding.ComputeBoundMaterial()[0]))
        return parts

    def _add_part(
        self, prim: Any, shape: _Shape, faces: np.ndarray, bound: Any, matrix: np.ndarray
    ) -> None:
        look = self._materials.look(bound)
        mesh = shape.triangles(faces, look)
        mesh.check(str(prim.GetPath()))
        surface = self._materials.surface(bound, look, mesh.uvs is not None, mesh.colors is not None)
        two_sided = bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get())
        radiance = surface.radiance
        if prim.HasAPI(UsdLux.MeshLightAPI):
            radiance = self._lights.radiance(prim, shape.area(matrix))
        surface = Surface(surface.material, radiance, surface.emission_texture, two_sided)
        # Instances may have inherited other colours and materials.
        key = source_of(prim)
        part = (mesh.digest(), surface.material) if self._placed.is_repeated(key) else None
        self._placed.add(key, part, str(prim.GetPath()), mesh, surface, matrix)


class _Shape:
    """A mesh's corners, each a vertex of its own: USD gives values to corners, points and faces."""

    def __init__(
        self, prim: Any, points: np.ndarray, counts: np.ndarray, corners: np.ndarray, time: Any
    ) -> None:
        if counts.min() < 0 or counts.sum() > len(corners):
            raise Error(f"{prim.GetPath()}: has too few corners for its faces")
        if corners.min() < 0 or corners.max() >= len(points):
            raise Error(f"{prim.GetPath()}: has a corner without a point")
        self._prim = prim
        self._points = points
        self._counts = counts
        self._firsts = np.cumsum(counts) - counts
        self._corners = corners
        self._time = time
        mesh = UsdGeom.Mesh(prim)
        self._is_left_handed = mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded

    def area(self, matrix: np.ndarray) -> float:
        """That of all faces, in the scene."""
        triangles = self._corners[fan_triangles(self._counts, self._firsts)]
        a, b, c = (self._points[triangles[:, k]] @ matrix[:3, :3].T for k in range(3))
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)

    def triangles(self, faces: np.ndarray, look: Look | None) -> Triangles:
        """Those of some faces."""
        api = UsdGeom.PrimvarsAPI(self._prim)
        places = fan_triangles(self._counts[faces], self._firsts[faces])
        if self._is_left_handed:
            places = places[:, ::-1]
        of_face = np.repeat(faces, np.maximum(self._counts[faces] - 2, 0))
        used, indices = np.unique(self._corners[places], return_inverse=True)
        values = {
            "normals": self._normals(api),
            "uvs": self._primvar(api, look.uv_name, 2) if look and look.uv_name else None,
            "colors": self._primvar(api, "displayColor", 3) if look is None else None,
        }
        per_corner = any(v is not None and v[1] in ("faceVarying", "uniform") for v in values.values())
        if per_corner:
            flat, face_of = places.reshape(-1), np.repeat(of_face, 3)
            mesh = Triangles(
                self._points[self._corners[flat]], np.arange(len(flat)).reshape(-1, 3)
            )
        else:
            # Any corner of a point has the values of the point.
            flat, face_of = np.zeros(len(used), int), np.zeros(len(used), int)
            flat[indices.reshape(-1)] = places.reshape(-1)
            mesh = Triangles(self._points[used], indices.reshape(-1, 3))
        mesh.normals = _picked(values["normals"], flat, self._corners[flat], face_of)
        mesh.uvs = _picked(values["uvs"], flat, self._corners[flat], face_of)
        mesh.colors = _picked(values["colors"], flat, self._corners[flat], face_of)
        if mesh.uvs is not None and look is not None:
            mesh.uvs = look.placed(mesh.uvs)
        return mesh

    def _normals(self, api: UsdGeom.PrimvarsAPI) -> tuple[np.ndarray, str] | None:
        found = self._primvar(api, "normals", 3)
        if found is not None:
            return found
        mesh = UsdGeom.Mesh(self._prim)
        normals = mesh.GetNormalsAttr().Get(self._time)
        if not normals:
            return None
        return self._if_fits(np.array(normals, float), str(mesh.GetNormalsInterpolation()), 3)

    def _primvar(
        self, api: UsdGeom.PrimvarsAPI, name: str, columns: int
    ) -> tuple[np.ndarray, str] | None:
        primvar = api.FindPrimvarWithInheritance(name)
        if not primvar or not primvar.HasValue():
            return None
        values = primvar.ComputeFlattened(self._time)
        if values is None or len(values) == 0:
            return None
        return self._if_fits(np.array(values, float), str(primvar.GetInterpolation()), columns)

    def _if_fits(
        self, values: np.ndarray, interpolation: str, columns: int
    ) -> tuple[np.ndarray, str] | None:
        counts = {
            "constant": 1,
            "uniform": len(self._counts),
            "faceVarying": len(self._corners),
        }
        wanted = counts.get(interpolation, len(self._points))
        if values.ndim != 2 or values.shape[1] != columns or len(values) < wanted:
            return None
        return values, interpolation


def _picked(
    values: tuple[np.ndarray, str] | None, corner: np.ndarray, point: np.ndarray, face: np.ndarray
) -> np.ndarray | None:
    """The values at vertices that are such corners, points and parts of faces."""
    if values is None:
        return None
    array, interpolation = values
    if interpolation == "constant":
        return np.repeat(array[:1], len(corner), axis=0)
    return array[{"faceVarying": corner, "uniform": face}.get(interpolation, point)]
