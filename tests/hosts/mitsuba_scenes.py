"""Small Mitsuba scenes, each different in kind, as dictionaries for `mi.load_dict`."""

from __future__ import annotations

from typing import Any

import mitsuba as mi
import numpy as np

SceneDict = dict[str, Any]

# Mitsuba 3.8.0 cannot load LLVM scenes any more once a scalar variant has rendered before LLVM was
# set up.
mi.set_variant("llvm_ad_rgb")
SIZE = (32, 24)


def transform() -> Any:
    return mi.ScalarTransform4f()


def rgb(*value: float) -> SceneDict:
    return {"type": "rgb", "value": list(value) if len(value) > 1 else value[0]}


def area(*radiance: float) -> SceneDict:
    return {"type": "area", "radiance": rgb(*radiance)}


def diffuse(*reflectance: float) -> SceneDict:
    return {"type": "diffuse", "reflectance": rgb(*reflectance)}


def rectangle(position: Any, half: float, emitter: SceneDict | None, down: bool = True) -> SceneDict:
    """Horizontal, facing down or up."""
    to_world = transform().translate(position).rotate([1, 0, 0], 90 if down else -90).scale(half)
    shape = {"type": "rectangle", "to_world": to_world, "bsdf": diffuse(0.5, 0.5, 0.5)}
    return shape if emitter is None else shape | {"emitter": emitter}


def quads(
    centers: np.ndarray,
    half: float,
    radiance: SceneDict,
    attribute: np.ndarray | None = None,
    flip: bool = False,
    uvs: bool = False,
) -> Any:
    """One mesh of squares that face down, (N, 3) centres; attribute: RGB for each, float32 (N, 3)."""
    corner = np.float32([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]])
    positions = (centers[:, None, :] + corner).reshape(-1, 3).astype(np.float32)
    quad = np.array([[0, 1, 2], [0, 2, 3]]) if not flip else np.array([[0, 2, 1], [0, 3, 2]])
    faces = (4 * np.arange(len(centers))[:, None, None] + quad).reshape(-1, 3)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(diffuse(0.5, 0.5, 0.5))
    properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    mesh = mi.Mesh(
        "quads", len(positions), len(faces), has_vertex_texcoords=uvs, props=properties
    )
    if attribute is not None:
        mesh.add_attribute("face_radiance", 3, np.repeat(attribute, 2, axis=0).ravel())
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = positions.ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    if uvs:
        corner_uvs = np.float32([[0, 0], [1, 0], [1, 1], [0, 1]])
        parameters["vertex_texcoords"] = np.tile(corner_uvs, (len(centers), 1)).ravel()
    parameters.update()
    return mesh


def picture() -> SceneDict:
    """A radiance that is dark on one side."""
    texels = np.zeros((8, 8, 3), np.float32)
    texels[:, :3] = (6.0, 4.0, 1.0)
    texels[2:6, 5] = (0.5, 1.0, 9.0)
    return {"type": "bitmap", "bitmap": mi.Bitmap(texels), "filter_type": "nearest"}


def sensor(film: SceneDict | None = None) -> SceneDict:
    """A camera that looks at what stands on the floor."""
    return {
        "type": "perspective",
        "fov": 45,
        "to_world": transform().look_at([0, 2.5, 7], [0, 0.8, 0], [0, 1, 0]),
        "film": {
            "type": "hdrfilm",
            "width": SIZE[0],
            "height": SIZE[1],
            "rfilter": {"type": "box"},
        }
        | (film or {}),
        "sampler": {"type": "independent"},
    }


def stage(
    *, bsdf: SceneDict | None = None, object_bsdf: SceneDict | None = None, film: SceneDict | None = None
) -> SceneDict:
    """A floor, a wall and a ball, without light."""
    floor = bsdf or diffuse(0.6, 0.5, 0.4)
    return {
        "type": "scene",
        "sensor": sensor(film),
        "floor": rectangle([0, 0, 0], 5, None, down=False) | {"bsdf": floor},
        "wall": {
            "type": "rectangle",
            "to_world": transform().translate([0, 2, -3]).scale(5),
            "bsdf": diffuse(0.3, 0.5, 0.6),
        },
        "ball": {
            "type": "sphere",
            "center": [0.8, 0.9, 0.5],
            "radius": 0.9,
            "bsdf": object_bsdf or diffuse(0.7, 0.7, 0.7),
        },
    }


def lamps(count: int = 1) -> SceneDict:
    """Square lamps in a row under the ceiling."""
    places = np.linspace(-2, 2, count) if count > 1 else [0.0]
    return {
        f"lamp{i}": rectangle([x, 3.2, 0.5], 0.35, area(8 + i, 7, 5)) for i, x in enumerate(places)
    }


def many_lamps() -> SceneDict:
    """3,000 squares, one mesh."""
    random = np.random.default_rng(5)
    centers = np.stack(
        [random.uniform(-3, 3, 3000), random.uniform(2.2, 3.2, 3000), random.uniform(-2, 3, 3000)],
        axis=1,
    )
    return stage() | {"lamps": quads(centers, 0.02, rgb(9, 8, 6))}


def many_lamps_on_metal() -> SceneDict:
    """The same over polished metal, and a ball of it."""
    metal = {"type": "roughconductor", "alpha": 0.3}
    return many_lamps() | stage(bsdf=metal, object_bsdf=metal)


def lamps_behind_a_wall() -> SceneDict:
    """300 squares in view, and 600 bright ones that nothing in view is lit by."""
    random = np.random.default_rng(7)
    shown = random.uniform((-3, 2.2, -2), (3, 3.2, 3), (300, 3)).astype(np.float32)
    hidden = random.uniform((-4, 0.5, -6), (4, 3.2, -3.5), (600, 3)).astype(np.float32)
    return stage() | {
        "shown": quads(shown, 0.02, rgb(9, 8, 6)),
        "hidden": quads(hidden, 0.05, rgb(90, 80, 60)),
    }


ATTRIBUTE_CENTERS = np.float32([[-2, 3, 0], [-0.7, 2.5, 1], [0.7, 3, 0], [2, 2.5, -1]])
ATTRIBUTE_RADIANCE = np.float32([[8, 1, 1], [1, 2, 12], [0, 9, 0], [5, 5, 5]])


def attribute_lamps() -> SceneDict:
    """A mesh with a radiance for each face."""
    radiance = {"type": "mesh_attribute", "name": "face_radiance"}
    return stage() | {"lamps": quads(ATTRIBUTE_CENTERS, 0.3, radiance, ATTRIBUTE_RADIANCE)}


def separate_lamps() -> SceneDict:
    """The same light from meshes of one radiance each."""
    return stage() | {
        f"lamp{i}": quads(center[None], 0.3, rgb(*map(float, radiance)))
        for i, (center, radiance) in enumerate(
            zip(ATTRIBUTE_CENTERS, ATTRIBUTE_RADIANCE, strict=True)
        )
    }


def textured_lamps() -> SceneDict:
    """A picture on a rectangle, and on a mesh of two triangles."""
    return stage() | {
        "screen": rectangle([-1.2, 3, 0], 0.7, {"type": "area", "radiance": picture()}),
        "mesh": quads(np.float32([[1.2, 3, 0]]), 0.7, picture(), uvs=True),
    }


def bright_texels() -> Any:
    """A radiance that is black but for a few texels, which are blended with their neighbours."""
    texels = np.zeros((32, 32, 3), np.float32)
    for x, y, value in ((5, 9, (300, 100, 50)), (20, 21, (60, 200, 300)), (21, 20, (90, 90, 90))):
        texels[y, x] = value
    return {"type": "bitmap", "bitmap": mi.Bitmap(texels)}


def strip(
    half_length: float, half_width: float, emitter: SceneDict, height: float = 1.9
) -> Any:
    """A mesh of two triangles along x, that faces down."""
    mesh = quads(np.float32([[0, 0, 0]]), 1.0, rgb(1.0), uvs=True)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(diffuse(0.5, 0.5, 0.5))
    properties["emitter"] = mi.load_dict(emitter)
    long = mi.Mesh("strip", 4, 2, has_vertex_texcoords=True, props=properties)
    source, parameters = mi.traverse(mesh), mi.traverse(long)
    corners = np.array(source["vertex_positions"]).reshape(4, 3) * (half_length, 1, half_width)
    parameters["vertex_positions"] = (corners + (0, height, 1.0)).astype(np.float32).ravel()
    parameters["faces"] = source["faces"]
    parameters["vertex_texcoords"] = source["vertex_texcoords"]
    parameters.update()
    return long


def cut_lamps() -> SceneDict:
    """Strips, of which one is a rectangle, and textured panels: their triangles are cut."""
    tube = rectangle([0, 2.3, -1], 1.0, area(4, 3, 2))
    tube["to_world"] = transform().translate([0, 2.3, -1]).rotate([1, 0, 0], 90).scale([6, 0.08, 1])
    return stage() | {
        "strip": strip(5.0, 0.1, area(2, 4, 3)),
        "tube": tube,
        "panel": quads(np.float32([[1.2, 2.8, 0.5]]), 0.9, bright_texels(), uvs=True),
        "screen": rectangle([-1.5, 2.6, 0], 0.8, {"type": "area", "radiance": bright_texels()}),
    }


def cut_lamps_over_metal() -> SceneDict:
    """The same seen in polished metal: rays find the emitters as often as samples of lights do."""
    metal = {"type": "roughconductor", "alpha": 0.25}
    return cut_lamps() | stage(bsdf=metal, object_bsdf=metal)


def turned_lamps() -> SceneDict:
    """Lamps whose material has two sides, a mesh that is wound the other way, a flipped one."""
    up = rectangle([1.5, 1.5, 1], 0.5, area(4, 4, 4), down=False)
    up["bsdf"] = {"type": "twosided", "bsdf": diffuse(0.5, 0.5, 0.5)}
    down = rectangle([-1.5, 3, 0], 0.5, area(5, 4, 3)) | {"flip_normals": True}
    return stage() | {
        "up": up,
        "flipped": down,
        "wound": quads(np.float32([[0, 3, 1]]), 0.4, rgb(9, 9, 9), flip=True),
    }


def round_lamps() -> SceneDict:
    """A ball, a disc, a tube, and a cube of twelve triangles."""
    return stage() | {
        "globe": {
            "type": "sphere",
            "center": [-2, 2, 0],
            "radius": 0.3,
            "emitter": area(6, 5, 4),
        },
        "disc": {
            "type": "disk",
            "to_world": transform().translate([1, 3, 1]).rotate([1, 0, 0], 120).scale(0.4),
            "emitter": area(5, 5, 9),
        },
        "tube": {
            "type": "cylinder",
            "p0": [-1, 2.6, -1],
            "p1": [1, 2.6, -1],
            "radius": 0.05,
            "emitter": area(9, 3, 1),
        },
        "cube": {
            "type": "cube",
            "to_world": transform().translate([2.2, 1.5, 1]).scale(0.15),
            "emitter": area(1, 9, 2),
        },
    }


def environment() -> SceneDict:
    """A sky with a bright spot, and lamps."""
    sky = np.full((16, 32, 3), (0.2, 0.3, 0.5), np.float32)
    sky[3:5, 10:14] = (9.0, 8.0, 6.0)
    return stage() | lamps(2) | {"sky": {"type": "envmap", "bitmap": mi.Bitmap(sky)}}


def sky_only() -> SceneDict:
    return stage() | {"sky": {"type": "constant", "radiance": rgb(0.8, 0.9, 1.0)}}


def points_and_spots() -> SceneDict:
    """Emitters that no ray can hit."""
    return stage() | {
        "point": {"type": "point", "position": [-2, 2, 1], "intensity": rgb(6, 5, 4)},
        "spot": {
            "type": "spot",
            "to_world": transform().look_at([2, 4, 2], [0.5, 0, 0], [0, 0, 1]),
            "intensity": rgb(30, 30, 40),
            "cutoff_angle": 25,
            "beam_width": 12,
        },
        "projector": {
            "type": "projector",
            "irradiance": picture(),
            "fov": 30,
            "to_world": transform().look_at([0, 4, 3], [0, 0, 0], [0, 1, 0]),
            "scale": 3.0,
        },
    }


def directional() -> SceneDict:
    """Light from one direction, from a lit sheet of parallel rays, and from lamps."""
    sheet = rectangle([-1, 3, 0], 0.8, {"type": "directionalarea", "radiance": rgb(2, 1, 1)})
    return stage() | lamps(2) | {
        "sun": {"type": "directional", "direction": [0.4, -1, -0.5], "irradiance": rgb(1, 1, 0.8)},
        "sheet": sheet,
    }


def suns_and_lamps() -> SceneDict:
    """A few directions, one of them from below, and lamps: all are lights of one sampler."""
    directions = [[0.4, -1, -0.5], [-0.8, -0.6, 0.1], [0.1, 1, 0.2]]
    return stage() | lamps(5) | {
        f"sun {i}": {"type": "directional", "direction": d, "irradiance": rgb(0.5, 0.3 + 0.3 * i, 1)}
        for i, d in enumerate(directions)
    }


def glossy(bsdf: SceneDict) -> SceneDict:
    """A material on the floor and on the ball."""
    return stage(bsdf=bsdf, object_bsdf=bsdf) | lamps(3)


def panels() -> SceneDict:
    """Large lamps close to polished metal: rays find them as often as samples of lights do."""
    metal = {"type": "roughconductor", "alpha": 0.2}
    centers = np.float32([[-1.6, 1.5, -1], [0.6, 2.2, -1], [2, 1.2, 0.5], [-0.5, 2.4, 1.2]])
    return stage(bsdf=metal, object_bsdf=metal) | {"panels": quads(centers, 0.8, rgb(3, 2, 1))}


def glass() -> SceneDict:
    """A ball of glass behind a pane."""
    pane = {
        "type": "rectangle",
        "to_world": transform().translate([0, 1, 3]).scale(1.2),
        "bsdf": {"type": "thindielectric"},
    }
    return stage(object_bsdf={"type": "dielectric"}) | lamps(2) | {"pane": pane}


def rough_glass() -> SceneDict:
    """Light that comes through a surface is sampled too."""
    return stage(object_bsdf={"type": "roughdielectric", "alpha": 0.3}) | lamps(3)


def see_through() -> SceneDict:
    """A mask with holes before the lamps, and an interface of no effect around the ball."""
    holes = np.zeros((8, 8, 1), np.float32)
    holes[::2] = 0.7
    opacity = {"type": "bitmap", "bitmap": mi.Bitmap(holes), "raw": True}
    mask = {"type": "mask", "opacity": opacity, "bsdf": {"type": "twosided", "bsdf": diffuse(0.8, 0.8, 0.8)}}
    shade = rectangle([0, 2.4, 0.5], 1.5, None) | {"bsdf": mask}
    shell = {"type": "sphere", "center": [0.8, 0.9, 0.5], "radius": 1.3, "bsdf": {"type": "null"}}
    return stage() | lamps(3) | {"shade": shade, "shell": shell}


def lamps_in_view() -> SceneDict:
    """Lamps in front of things, and a sky."""
    shown = rectangle([-0.5, 1.2, 2], 0.3, area(4, 4, 4))
    shown["to_world"] = transform().translate([-0.5, 1.2, 2]).scale(0.4)
    return stage() | lamps(2) | {"shown": shown, "sky": {"type": "constant", "radiance": rgb(0.3)}}


def bumpy() -> SceneDict:
    """A normal map, and a blend of two materials."""
    tilt = np.full((4, 4, 3), (0.6, 0.5, 0.9), np.float32)
    normals = {"type": "bitmap", "bitmap": mi.Bitmap(tilt), "raw": True}
    floor = {"type": "normalmap", "normalmap": normals, "bsdf": diffuse(0.7, 0.6, 0.5)}
    ball = {
        "type": "blendbsdf",
        "weight": 0.4,
        "first": {"type": "roughconductor", "alpha": 0.2},
        "second": diffuse(0.2, 0.4, 0.8),
    }
    return stage(bsdf=floor, object_bsdf=ball) | lamps(3)


def film_options() -> SceneDict:
    """A crop of the film, a wide filter, samples in its border, and a stratified sampler."""
    film = {
        "width": 48,
        "height": 36,
        "crop_offset_x": 8,
        "crop_offset_y": 6,
        "crop_width": SIZE[0],
        "crop_height": SIZE[1],
        "sample_border": True,
        "rfilter": {"type": "gaussian"},
    }
    scene = stage(film=film) | lamps(3)
    scene["sensor"] = scene["sensor"] | {"sampler": {"type": "multijitter"}}
    return scene


def cornell() -> SceneDict:
    """Mitsuba's own."""
    scene = mi.cornell_box()
    film = {"width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}}
    scene["sensor"] = scene["sensor"] | {"film": scene["sensor"]["film"] | film}
    return scene
