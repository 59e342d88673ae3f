"""A Mitsuba scene from a file, rendered by Mitsuba: what `lightcull render` and `compare` take."""

from __future__ import annotations

import hashlib
import importlib
import os
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from .._core import Error
from ..rendering.settings import RenderSettings
from .host import build_digest, mitsuba
from .mitsuba_job import MitsubaJob

PATH = "path"
"""Mitsuba's own integrator, as one of the samplers."""
ANY_DEPTH = 2**31 - 1
DEFAULT_VARIANT = "scalar_rgb"


class MitsubaScene:
    """A scene of Mitsuba's, which `lightcull.compare` takes, too.

    Its samplers are those of `lightcull_path`, with their options ("culled:sets=16"), and "path",
    which is Mitsuba's own integrator.

    scene: a `mi.Scene` of the variant that is set. digest: tells it from other scenes; None: it is
    not known, and no reference is ever found in the cache.
    """

    def __init__(self, scene: Any, name: str = "scene", digest: str | None = None) -> None:
        self.name = name
        self.scene = scene
        self._variant = mitsuba().variant()
        self._digest = digest or os.urandom(16).hex()

    @property
    def light_count(self) -> int:
        """Emitters, as Mitsuba counts them: a mesh is one."""
        return len(self.scene.emitters())

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture, pixels: of the film's crop window."""
        width, height = self.scene.sensors()[0].film().crop_size()
        return int(width), int(height)

    def digest(self) -> str:
        return f"{self._digest}-{self._variant}-{build_digest()}"

    def check_sampler(self, description: str) -> None:
        self._integrator(description)

    def new_job(self, sampler: str, settings: RenderSettings, spp: int | None = None) -> MitsubaJob:
        self._set_size(settings.size)
        if settings.threads:
            # Dr.Jit comes with Mitsuba, which is optional.
            importlib.import_module("drjit").set_thread_count(settings.threads)
        if settings.direct_light != "mis":
            raise Error("direct_light: not for Mitsuba, whose paths sample lights and the BSDF")
        depths = {"max_depth": settings.max_depth, "rr_depth": settings.rr_depth}
        integrator = self._integrator(sampler, **depths)
        return MitsubaJob(sampler, self.scene, integrator, settings.seed, spp)

    @property
    def best_sampler(self) -> str:
        return "learned"

    def _set_size(self, size: tuple[int, int]) -> None:
        """A crop window is scaled with its film: the picture shows what it showed before."""
        if self.size == size:
            return
        parameters = mitsuba().traverse(self.scene.sensors()[0])
        old = {key: list(parameters[f"film.{key}"]) for key in ("size", "crop_offset")}
        factors = [new / was for new, was in zip(size, self.size, strict=True)]
        scaled = {
            key: [round(factor * x) for factor, x in zip(factors, value, strict=True)]
            for key, value in old.items()
        }
        parameters["film.crop_size"] = list(size)
        parameters["film.crop_offset"] = scaled["crop_offset"]
        parameters["film.size"] = [
            max(whole, offset + part)
            for whole, offset, part in zip(scaled["size"], scaled["crop_offset"], size, strict=True)
        ]
        parameters.update()
        if self.size != size:
            raise Error(f"{self.name}: its film cannot be made {size[0]}x{size[1]}")

    def _integrator(self, description: str, **depths: int) -> Any:
        properties: dict[str, Any] = {"type": PATH}
        if description != PATH:
            # A job is one render to its user, though it is many to Mitsuba.
            properties = {
                "type": "lightcull_path",
                "light_sampler": description,
                "keep_learned": True,
            }
        try:
            return mitsuba().load_dict(properties | depths)
        except RuntimeError as error:
            reason = str(error).splitlines()[0].rsplit("] ", 1)[-1]
            raise Error(f"sampler {description!r}: {reason}") from error


def load_file(path: str | os.PathLike[str], variant: str = DEFAULT_VARIANT) -> MitsubaScene:
    """Loads an .xml scene, and sets Mitsuba's variant."""
    path, mi = Path(path), mitsuba()
    if not path.is_file():
        raise Error(f"{path}: no such file")
    if variant not in mi.variants():
        raise Error(f"Mitsuba has no variant {variant!r}; it has {', '.join(mi.variants())}")
    try:
        mi.set_variant(variant)
        scene = mi.load_file(str(path))
    except (ImportError, RuntimeError) as error:
        raise Error(f"{path}: {error}") from error
    digest = hashlib.blake2b(path.read_bytes(), digest_size=16)
    digest.update(str(path.resolve()).encode())
    return MitsubaScene(scene, path.stem, digest.hexdigest())


def depth_of_file(path: str | os.PathLike[str]) -> int:
    """The max_depth of the integrator in an .xml scene; without one, ANY_DEPTH."""
    try:
        node = ElementTree.parse(path).find("integrator/integer[@name='max_depth']")
    except ElementTree.ParseError as error:
        raise Error(f"{path}: {error}") from error
    depth = -1 if node is None else int(float(node.get("value", "-1")))
    return ANY_DEPTH if depth < 0 else depth
