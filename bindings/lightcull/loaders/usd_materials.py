"""UsdPreviewSurface."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Ar, UsdShade

from ..scene import Scene
from .model import Surface
from .textures import Textures
from .unsupported import Notes

_NUMBERS = {"metallic": 0.0, "roughness": 0.5, "opacity": 1.0, "opacityThreshold": 0.0}
_COLORS = {"diffuseColor": (0.18, 0.18, 0.18), "emissiveColor": (0.0, 0.0, 0.0)}
_LEFT_OUT = ("displacement", "occlusion", "clearcoat")


@dataclass(frozen=True)
class _Image:
    """A texture of a shader's input."""

    path: str
    channel: str
    uv_name: str
    scale: tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)

    @property
    def placement(self) -> tuple[Any, ...]:
        return self.uv_name, self.scale, self.rotation, self.offset


@dataclass
class Look:
    """A surface shader's values, and images for some of them."""

    values: dict[str, Any]
    images: dict[str, _Image] = field(default_factory=dict)
    normal_scale: float = 1.0
    """Of the image of normals, as `Scene.add_material` has it."""

    @property
    def first(self) -> _Image | None:
        """The image whose texture coordinates a mesh gets."""
        order = ("emissiveColor", "diffuseColor", "opacity", "roughness", "metallic", "normal")
        return next((self.images[name] for name in order if name in self.images), None)

    @property
    def uv_name(self) -> str | None:
        """The primvar of those coordinates."""
        return self.first.uv_name if self.first else None

    def placed(self, uvs: np.ndarray) -> np.ndarray:
        """UsdTransform2d: scaled, turned and moved."""
        assert self.first is not None
        angle = np.radians(self.first.rotation)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        return uvs * self.first.scale @ turn.T + self.first.offset


class UsdMaterials:
    """The materials of a stage, each made when it is first needed."""

    def __init__(self, scene: Scene, notes: Notes, time: Any) -> None:
        self._scene = scene
        self._notes = notes
        self._time = time
        self._textures = Textures(scene, notes)
        self._looks: dict[str, Look | None] = {}
        self._made: dict[tuple[str, bool, bool], Surface] = {}

    def look(self, material: Any) -> Look | None:
        """What a bound material says; None without one, or with one of another kind."""
        if not material:
            return None
        path = str(material.GetPath())
        if path not in self._looks:
            self._looks[path] = self._read(material)
        return self._looks[path]

    def surface(self, material: Any, look: Look | None, has_uvs: bool, has_colors: bool) -> Surface:
        """What a mesh of the material gets."""
        key = (str(material.GetPath()) if look else "", has_uvs, has_colors)
        if key not in self._made:
            self._made[key] = self._make(look, has_uvs, has_colors)
        return self._made[key]

    def _read(self, material: Any) -> Look | None:
        shader = material.ComputeSurfaceSource()[0]
        if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            self._notes.left_out("materials that have no UsdPreviewSurface")
            return None
        look = Look({})
        for name, default in {**_NUMBERS, **_COLORS}.items():
            given = shader.GetInput(name)
            value, image = self._input(given) if given else (None, None)
            look.values[name] = default if value is None else value
            if image is not None:
                look.images[name] = image
        self._read_normals(shader, look)
        for name in _LEFT_OUT:
            given = shader.GetInput(name)
            self._notes.left_out(f"{name} of materials", int(bool(given and given.HasConnectedSource())))
        workflow = shader.GetInput("useSpecularWorkflow")
        self._notes.left_out("specular workflow of materials", int(bool(workflow and workflow.Get())))
        return look

    def _read_normals(self, shader: Any, look: Look) -> None:
        """Adds the image of normals, whose scale and bias take texels to -1 to 1."""
        given = shader.GetInput("normal")
        if not given or not given.HasConnectedSource():
            return
        node = UsdShade.Shader(given.GetConnectedSource()[0].GetPrim())
        if node.GetIdAttr().Get() != "UsdUVTexture":
            self._notes.left_out("normals of materials that are no texture")
            return
        given_scale, given_bias = self._value(node, "scale"), self._value(node, "bias")
        scale = np.array((1.0,) * 3 if given_scale is None else given_scale, float)[:3]
        bias = np.array((0.0,) * 3 if given_bias is None else given_bias, float)[:3]
        strength = scale[0] / 2.0
        wanted = (strength, strength, 1.0)
        if not (np.allclose(scale, np.multiply(2.0, wanted)) and np.allclose(bias, np.negative(wanted))):
            self._notes.left_out("normal maps without a scale of 2 and a bias of -1")
            return
        image = self._texture(node, "rgb")[1]
        if image is not None:
            look.images["normal"], look.normal_scale = image, float(strength)

    def _input(self, given: Any) -> tuple[Any, _Image | None]:
        """An input's value, or the image that gives it."""
        for attribute in UsdShade.Utils.GetValueProducingAttributes(given):
            if UsdShade.Utils.GetType(attribute.GetName()) == UsdShade.AttributeType.Input:
                return attribute.Get(self._time), None
            shader = UsdShade.Shader(attribute.GetPrim())
            if shader.GetIdAttr().Get() == "UsdUVTexture":
                bias = self._value(shader, "bias")
                self._notes.left_out("bias of textures", int(bias is not None and any(bias)))
                return self._texture(shader, UsdShade.Output(attribute).GetBaseName())
            self._notes.left_out(f"shader nodes {str(shader.GetIdAttr().Get())[:40]!r}")
        return None, None

    def _texture(self, shader: Any, channel: str) -> tuple[Any, _Image | None]:
        """A texture, and the factor that its scale is."""
        file = shader.GetInput("file").Get(self._time) if shader.GetInput("file") else None
        if file is None:
            return None, None
        st = shader.GetInput("st")
        scale, rotation, offset, name = (1.0, 1.0), 0.0, (0.0, 0.0), "st"
        source = st.GetConnectedSource() if st and st.HasConnectedSource() else None
        node = UsdShade.Shader(source[0].GetPrim()) if source else None
        if node and node.GetIdAttr().Get() == "UsdTransform2d":
            scale = _pair(self._value(node, "scale"), scale)
            offset = _pair(self._value(node, "translation"), offset)
            rotation = float(self._value(node, "rotation") or 0.0)
            source = node.GetInput("in").GetConnectedSource() if node.GetInput("in") else None
            node = UsdShade.Shader(source[0].GetPrim()) if source else None
        if node:
            name = str(self._value(node, "varname") or "st")
        factor = self._value(shader, "scale")
        path = file.resolvedPath or file.path
        image = _Image(path, channel, name, scale, rotation, offset)
        return (1.0 if factor is None else factor), image

    def _value(self, shader: Any, name: str) -> Any:
        given = shader.GetInput(name)
        if not given:
            return None
        for attribute in UsdShade.Utils.GetValueProducingAttributes(given):
            return attribute.Get(self._time)
        return None

    def _make(self, look: Look | None, has_uvs: bool, has_colors: bool) -> Surface:
        if look is None:
            grey = 1.0 if has_colors else 0.5
            return Surface(self._scene.add_material(base_color=(grey, grey, grey)))
        images = look.images if has_uvs else {}
        self._notes.left_out(
            "textures on meshes without texture coordinates", len(look.images) - len(images)
        )
        first = look.first
        kept = {n: i for n, i in images.items() if first and i.placement == first.placement}
        self._notes.left_out(
            "textures with other coordinates than the material's first", len(images) - len(kept)
        )
        base = self._color(kept.get("diffuseColor"))
        emission = self._color(kept.get("emissiveColor"))
        radiance = _rgb(look.values["emissiveColor"])
        if "emissiveColor" in look.images and emission is None:
            radiance = (0.0, 0.0, 0.0)
        for name in ("roughness", "metallic"):
            self._notes.left_out(f"textures of {name}", int(name in kept))
        material = self._scene.add_material(
            kind="metallic_roughness",
            base_color=_rgb(look.values["diffuseColor"], 1.0),
            metallic=_unit(look.values["metallic"]),
            roughness=_unit(look.values["roughness"]),
            base_color_texture=base,
            opacity=_unit(look.values["opacity"]),
            opacity_texture=self._opacity(kept.get("opacity")),
            opacity_threshold=_unit(look.values["opacityThreshold"]),
            normal_texture=self._numbers(kept.get("normal")),
            normal_scale=look.normal_scale,
        )
        return Surface(material, radiance, emission)

    def _color(self, image: _Image | None) -> int | None:
        if image is None:
            return None
        return self._textures.color(image.path, lambda: self._bytes(image.path))

    def _opacity(self, image: _Image | None) -> int | None:
        if image is None:
            return None
        if image.channel == "a":
            return self._textures.alpha(image.path, lambda: self._bytes(image.path))
        return self._numbers(image)

    def _numbers(self, image: _Image | None) -> int | None:
        if image is None:
            return None
        return self._textures.color(image.path, lambda: self._bytes(image.path), linear_data=True)

    def _bytes(self, path: str) -> bytes | None:
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
        if not asset:
            self._notes.left_out(f"missing file {path[-100:]!r}")
            return None
        return bytes(asset.GetBuffer())


def _pair(value: Any, default: tuple[float, float]) -> tuple[float, float]:
    return default if value is None else (float(value[0]), float(value[1]))


def _unit(value: Any) -> float:
    number = float(np.ravel(np.array(value, float))[0])
    return min(max(number, 0.0), 1.0)


def _rgb(value: Any, most: float = np.inf) -> tuple[float, float, float]:
    values = np.ravel(np.array(value, float))
    r, g, b = values[:3] if len(values) >= 3 else [values[0]] * 3
    return tuple(float(min(max(c, 0.0), most)) for c in (r, g, b))  # type: ignore[return-value]
