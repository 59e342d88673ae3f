"""The materials of glTF 2.0, appendix B and extensions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..scene import Scene
from .gltf_data import GltfData
from .gltf_document import Json
from .gltf_meshes import Primitive
from .model import Surface
from .textures import Textures
from .unsupported import Notes

_DIELECTRIC_F0 = 0.04


@dataclass(frozen=True)
class _Mapping:
    """Which texture coordinates a texture is looked up by, and their transform: 2 x 3, of (u, v, 1)."""

    uv_set: int
    matrix: tuple[tuple[float, float, float], ...]

    def apply(self, uvs: np.ndarray) -> np.ndarray:
        """From glTF's coordinates, v downwards, to those of a scene."""
        matrix = np.array(self.matrix)
        moved = uvs @ matrix[:, :2].T + matrix[:, 2]
        return np.stack([moved[:, 0], 1.0 - moved[:, 1]], axis=1)


@dataclass(frozen=True)
class _Look:
    """Metallic-roughness factors and textures, whatever the model they come from."""

    base_color: tuple[float, ...]
    metallic: float
    roughness: float
    base_color_texture: Json | None
    metallic_roughness_texture: Json | None = None
    kind: str = "metallic_roughness"


class Materials:
    """The materials of a document, each made when it is first needed."""

    def __init__(self, document: Json, data: GltfData, scene: Scene, notes: Notes) -> None:
        self._document = document
        self._materials: list[Json] = document.get("materials", [])
        self._data = data
        self._scene = scene
        self._notes = notes
        self._textures = Textures(scene, notes)
        self._made: dict[tuple[int | None, tuple[int, ...]], tuple[Surface, _Mapping | None]] = {}
        self.emit = False
        """Whether any that was made emits."""

    def dress(self, index: int | None, primitive: Primitive) -> Surface:
        """The surface of a primitive, which gets the texture coordinates that it takes."""
        given: Json = {} if index is None else self._materials[index]
        if primitive.has_alpha and given.get("alphaMode", "OPAQUE") != "OPAQUE":
            self._notes.left_out("alpha of vertex colours")
        key = (index, tuple(primitive.uvs))
        if key not in self._made:
            self._made[key] = self._make(given, tuple(primitive.uvs))
        surface, mapping = self._made[key]
        if mapping is not None:
            primitive.triangles.uvs = mapping.apply(primitive.uvs[mapping.uv_set])
        return surface

    def _make(self, given: Json, uv_sets: tuple[int, ...]) -> tuple[Surface, _Mapping | None]:
        look = _look_of(given, self._notes)
        strength = given.get("extensions", {}).get("KHR_materials_emissive_strength", {})
        factor = float(strength.get("emissiveStrength", 1.0))
        r, g, b = (factor * float(f) for f in given.get("emissiveFactor", (0.0, 0.0, 0.0)))
        emissive = given.get("emissiveTexture") if max(r, g, b) > 0 else None
        relief = None if look.kind == "diffuse" else given.get("normalTexture")
        slots = [emissive, look.base_color_texture, look.metallic_roughness_texture, relief]
        mapping = self._mapping_of([slot for slot in slots if slot], uv_sets)

        usable = [slot if slot and self._fits(slot, mapping) else None for slot in slots]
        emission = self._color(usable[0])
        if emissive is not None and emission is None:
            r = g = b = 0.0  # factors are white where textures are nearly black
        mode = given.get("alphaMode", "OPAQUE")
        opacity = look.base_color[3] if mode != "OPAQUE" and len(look.base_color) > 3 else 1.0
        material = self._scene.add_material(
            kind=look.kind,  # type: ignore[arg-type]
            base_color=tuple(min(max(c, 0.0), 1.0) for c in look.base_color[:3]),
            metallic=look.metallic,
            roughness=look.roughness,
            base_color_texture=self._color(usable[1]),
            metallic_roughness_texture=self._color(usable[2], linear_data=True),
            opacity=opacity,
            opacity_texture=self._alpha(usable[1]) if mode != "OPAQUE" else None,
            opacity_threshold=float(given.get("alphaCutoff", 0.5)) if mode == "MASK" else 0.0,
            normal_texture=self._color(usable[3], linear_data=True),
            normal_scale=float((relief or {}).get("scale", 1.0)),
        )
        self.emit |= max(r, g, b) > 0
        two_sided = bool(given.get("doubleSided", False))
        return Surface(material, (r, g, b), emission, two_sided), mapping

    def _mapping_of(self, slots: list[Json], uv_sets: tuple[int, ...]) -> _Mapping | None:
        """That of the first texture that has coordinates: a mesh has one set here."""
        mappings = [_mapping_of(slot) for slot in slots]
        return next((m for m in mappings if m.uv_set in uv_sets), None)

    def _fits(self, slot: Json, mapping: _Mapping | None) -> bool:
        if mapping is None:
            self._notes.left_out("textures on meshes without texture coordinates")
        elif _mapping_of(slot) != mapping:
            self._notes.left_out("textures with other coordinates than the material's first")
        return _mapping_of(slot) == mapping

    def _color(self, slot: Json | None, *, linear_data: bool = False) -> int | None:
        image = self._image_of(slot)
        if image is None:
            return None
        name, source = image
        return self._textures.color(name, source, linear_data=linear_data)

    def _alpha(self, slot: Json | None) -> int | None:
        image = self._image_of(slot)
        return None if image is None else self._textures.alpha(*image)

    def _image_of(self, slot: Json | None) -> tuple[str, Any] | None:
        if slot is None:
            return None
        texture = self._document["textures"][slot["index"]]
        webp = texture.get("extensions", {}).get("EXT_texture_webp", {})
        index = webp.get("source", texture.get("source"))
        if index is None:
            self._notes.left_out("images of formats that are not known")
            return None
        image = self._document["images"][index]

        def read() -> bytes | None:
            if "uri" in image:
                return self._data.file(image["uri"])
            return bytes(self._data.view(image["bufferView"]))

        uri = str(image.get("uri", ""))
        is_file = uri and not uri.startswith("data:")
        return uri if is_file else f"image {index}", read


def _mapping_of(slot: Json) -> _Mapping:
    """KHR_texture_transform."""
    transform = slot.get("extensions", {}).get("KHR_texture_transform", {})
    uv_set = transform.get("texCoord", slot.get("texCoord", 0))
    x, y = (float(v) for v in transform.get("offset", (0.0, 0.0)))
    across, down = (float(v) for v in transform.get("scale", (1.0, 1.0)))
    angle = float(transform.get("rotation", 0.0))
    cosine, sine = math.cos(angle), math.sin(angle)
    return _Mapping(
        int(uv_set), ((cosine * across, sine * down, x), (-sine * across, cosine * down, y))
    )


def _look_of(given: Json, notes: Notes) -> _Look:
    extensions = given.get("extensions", {})
    model = given.get("pbrMetallicRoughness", {})
    color = tuple(float(c) for c in model.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)))
    texture = model.get("baseColorTexture")
    if "KHR_materials_unlit" in extensions:
        return _Look(color, 0.0, 1.0, texture, kind="diffuse")
    if "KHR_materials_pbrSpecularGlossiness" in extensions:
        return _from_specular_glossiness(extensions["KHR_materials_pbrSpecularGlossiness"], notes)
    return _Look(
        color,
        float(model.get("metallicFactor", 1.0)),
        float(model.get("roughnessFactor", 1.0)),
        texture,
        model.get("metallicRoughnessTexture"),
    )


def _from_specular_glossiness(model: Json, notes: Notes) -> _Look:
    """By the conversion of KHR_materials_pbrSpecularGlossiness' appendix, of factors alone."""
    notes.left_out("specularGlossinessTexture", int("specularGlossinessTexture" in model))
    diffuse = np.array(model.get("diffuseFactor", (1.0, 1.0, 1.0, 1.0)), float)
    texture = model.get("diffuseTexture")
    roughness = 1.0 - float(model.get("glossinessFactor", 1.0))
    if "specularGlossinessTexture" in model:
        # The factors are white then, and would make mirrors of all.
        return _Look(tuple(diffuse), 0.0, 1.0, texture)
    specular = np.array(model.get("specularFactor", (1.0, 1.0, 1.0)), float)
    metallic = _metallic(_brightness(diffuse[:3]), _brightness(specular), float(specular.max()))
    if texture is not None:
        # What is a metal may change from texel to texel, and colours are those of its diffuse part.
        metallic = 0.0
    dielectric = 1.0 - float(specular.max())
    as_diffuse = diffuse[:3] * dielectric / (1.0 - _DIELECTRIC_F0) / max(1.0 - metallic, 1e-6)
    as_metal = (specular - _DIELECTRIC_F0 * (1.0 - metallic)) / max(metallic, 1e-6)
    color = diffuse[:3] if metallic == 0.0 else as_diffuse + (as_metal - as_diffuse) * metallic**2
    return _Look((*np.clip(color, 0.0, 1.0), *diffuse[3:]), metallic, roughness, texture)


def _brightness(color: np.ndarray) -> float:
    """That of the extension's appendix."""
    return float(np.sqrt(np.dot(color**2, (0.299, 0.587, 0.114))))


def _metallic(diffuse: float, specular: float, most_specular: float) -> float:
    """The metalness whose two reflectances have those brightnesses."""
    if specular <= _DIELECTRIC_F0:
        return 0.0
    a = _DIELECTRIC_F0
    b = diffuse * (1.0 - most_specular) / (1.0 - _DIELECTRIC_F0) + specular - 2.0 * _DIELECTRIC_F0
    c = _DIELECTRIC_F0 - specular
    root = math.sqrt(max(b * b - 4.0 * a * c, 0.0))
    return min(max((-b + root) / (2.0 * a), 0.0), 1.0)
