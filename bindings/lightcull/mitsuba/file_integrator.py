"""The integrator of a Mitsuba file: what it says of paths, which `lightcull_path` then follows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from .._core import Error
from ..file_settings import ANY_DEPTH
from ..loaders.unsupported import Notes
from ..rendering.settings import RR_DEPTH
from .host import mitsuba

DIRECT_DEPTH = 2
PATH = "path"

_PATHS = ("path", "prb", "prb_basic", "prb_projective", "lightcull_path")
"""They differ in derivatives and in the choice of lights alone."""
_DIRECT = ("direct", "direct_projective")
_VOLUMES = {
    "volpath": "volpath",
    "volpathmis": "volpathmis",
    "prbvolpath": "volpath",
    "lightcull_volpath": "volpath",
}
_AROUND = {"aov": "channels of", "moment": "second moments of", "stokes": "polarisation of"}
"""Integrators that add channels to those of one within."""
_NO_LIGHT = ("depth",)
_FOLLOWED = {"max_depth", "rr_depth", "hide_emitters"}
_OF_NO_MATTER = {"block_size", "samples_per_pass"}
"""What changes nothing in the picture."""
_NULL_SURFACES = ("mask", "null", "thindielectric")


@dataclass(frozen=True)
class FileIntegrator:
    """What holds of the integrator of a file."""

    kind: str = PATH
    """The integrator of Mitsuba's that renders it as it is written."""
    max_depth: int = ANY_DEPTH
    """Longest path, in edges."""
    rr_depth: int = RR_DEPTH
    """Edges from which Russian roulette may end a path."""
    hide_emitters: bool = False
    """Whether the camera sees no emitter."""

    @property
    def properties(self) -> dict[str, Any]:
        """As `mi.load_dict` takes them, but for the type."""
        return {
            "max_depth": self.max_depth,
            "rr_depth": self.rr_depth,
            "hide_emitters": self.hide_emitters,
        }


def take_integrator(state: Any, notes: Notes) -> FileIntegrator:
    """Reads the integrator of a parsed file (`mi.parser.ParserState`), and puts `path` in its
    place, which every variant has; what does not hold is noted.
    """
    nodes = list(state.nodes)
    found = [node for node in _children(state.root, nodes) if _is_integrator(node)]
    if not found:
        return FileIntegrator()
    # Mitsuba itself refuses a second one.
    written = _read(_innermost(found[0], nodes, notes), nodes, notes)
    props = mitsuba().Properties(PATH)
    for name, value in written.properties.items():
        props[name] = value
    found[0].props = props
    return written


def _children(node: Any, nodes: list[Any]) -> Iterator[Any]:
    reference = mitsuba().Properties.ResolvedReference
    for key in node.props.keys():  # noqa: SIM118
        value = node.props[key]
        if isinstance(value, reference):
            yield nodes[value.index()]


def _is_integrator(node: Any) -> bool:
    return bool(node.type == mitsuba().ObjectType.Integrator)


def _innermost(node: Any, nodes: list[Any], notes: Notes) -> Any:
    """The integrator within those that add channels to it."""
    kind = node.props.plugin_name()
    if kind not in _AROUND:
        return node
    within = [child for child in _children(node, nodes) if _is_integrator(child)]
    notes.left_out(f"{_AROUND[kind]} the integrator {kind!r}")
    if not within:
        return node
    notes.left_out(f"integrator after the first in {kind!r}", len(within) - 1)
    return _innermost(within[0], nodes, notes)


def _read(node: Any, nodes: list[Any], notes: Notes) -> FileIntegrator:
    props = node.props
    kind = props.plugin_name()
    left_out = set(props.keys()) - _FOLLOWED - _OF_NO_MATTER
    depth, rr_depth = _whole(props, "max_depth", -1), _whole(props, "rr_depth", RR_DEPTH)
    if kind in _DIRECT:
        depth = DIRECT_DEPTH
    elif kind in _AROUND or kind in _NO_LIGHT:
        left_out.clear()
        notes.remark(f"the integrator {kind!r} shows no light: rendered by paths")
    elif kind not in _PATHS and kind not in _VOLUMES:
        notes.remark(f"the integrator {kind!r} is not lightcull's: rendered by paths")
    if kind in _VOLUMES and depth >= 0 and _has_null_surfaces(nodes) and not _has_media(nodes):
        notes.remark(f"what lets light straight through counts in max_depth, unlike by {kind}")
    for name in sorted(left_out):
        notes.left_out(f"{name} of the integrator {kind!r}")
    if depth == 0:
        raise Error("its integrator has a max_depth of 0, which shows nothing: it is black")
    if depth < -1:
        raise Error(f"its integrator has a max_depth of {depth}: wanted -1, or 1 and more")
    if rr_depth < 1:
        raise Error(f"its integrator has an rr_depth of {rr_depth}: wanted 1 and more")
    return FileIntegrator(
        _VOLUMES.get(kind, PATH),
        ANY_DEPTH if depth < 0 else depth,
        rr_depth,
        bool(props.get("hide_emitters", False)),
    )


def _whole(props: Any, name: str, default: int) -> int:
    value = props.get(name, default)
    if not isinstance(value, int):
        raise Error(f"its integrator has a {name} of {value!r}: wanted a whole number")
    return value


def _has_null_surfaces(nodes: list[Any]) -> bool:
    return any(node.props.plugin_name() in _NULL_SURFACES for node in nodes)


def _has_media(nodes: Iterable[Any]) -> bool:
    """Whether anything in a parsed file is filled with a medium."""
    return any(node.type == mitsuba().ObjectType.Medium for node in nodes)
