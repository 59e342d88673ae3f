"""Shows a scene by Cycles, in the Python that has Blender's module bpy, and nothing of lightcull.

    python blender_worker.py FOLDER

FOLDER holds what `blender.py` exported: scene.json, arrays.npz, texture*.exr. For each line of
standard input, a JSON object {"first", "samples", "seed", "path"}, samples number `first` and so on
are rendered to an OpenEXR file of several layers, and a line goes to standard output: ANSWER and a
JSON object {"seconds", "emission"}: of all processors together, and the layers of what the camera
sees of emitters. The first line comes unasked, when the scene stands.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import bpy  # type: ignore[import-not-found]
import mathutils  # type: ignore[import-not-found]
import numpy as np

ANSWER = "lightcull-answer: "
"""Blender prints, too."""


class _Nodes:
    """A tree of nodes that is being built."""

    def __init__(self, owner: Any) -> None:
        if owner.node_tree is None:  # from Blender 5 on there always is one
            owner.use_nodes = True
        self._tree = owner.node_tree
        self._tree.nodes.clear()

    def add(self, kind: str, inputs: dict[Any, Any] | None = None, **properties: Any) -> Any:
        """A node; an input is a number, a tuple or the output of another node."""
        node = self._tree.nodes.new(kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self._tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node


def _rgba(color: Any) -> tuple[float, ...]:
    return (*color, 1.0)


class _Builder:
    """Makes the scene in Blender."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._about: dict[str, Any] = json.loads((folder / "scene.json").read_text())
        self._arrays = np.load(folder / "arrays.npz")
        self._scene = bpy.context.scene
        bpy.data.batch_remove(bpy.data.objects)  # what Blender starts with

    def build(self) -> None:
        smooth = self._arrays["smooth"]
        for name, chosen in (("flat", ~smooth), ("smooth", smooth)):
            if chosen.any():
                self._add_mesh(name, chosen, name == "smooth")
        for light in self._about["points"]:
            self._add_light("POINT", light["intensity"], light["position"], (0, 0, -1))
        for light in self._about["spots"]:
            self._add_spot(light)
        for light in self._about["directional_lights"]:
            self._add_light("SUN", light["irradiance"], (0, 0, 0), light["direction"])
        self._set_world()
        self._set_camera()
        self._set_render()

    def _object(self, name: str, data: Any) -> Any:
        made = bpy.data.objects.new(name, data)
        self._scene.collection.objects.link(made)
        return made

    def _add_mesh(self, name: str, chosen: np.ndarray, smooth: bool) -> None:
        indices = self._arrays["indices"][chosen].astype(np.int32)
        used, corners = np.unique(indices.reshape(-1), return_inverse=True)
        corners = corners.reshape(-1).astype(np.int32)
        count = len(indices)
        mesh = bpy.data.meshes.new(name)
        mesh.vertices.add(len(used))
        mesh.vertices.foreach_set("co", self._arrays["positions"][used].reshape(-1))
        mesh.loops.add(3 * count)
        mesh.loops.foreach_set("vertex_index", corners)
        mesh.polygons.add(count)
        mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
        mesh.polygons.foreach_set("use_smooth", np.full(count, smooth))
        uvs = self._arrays["uvs"][used][corners]
        mesh.uv_layers.new(name="uv").data.foreach_set("uv", uvs.reshape(-1))
        self._set_materials(mesh, self._arrays["surface"][chosen])
        mesh.update(calc_edges=True)
        mesh.validate()
        if smooth:
            mesh.normals_split_custom_set_from_vertices(self._arrays["normals"][used].tolist())
        made = self._object(name, mesh)
        for owner in (made, made.cycles):  # which has them depends on the version
            for setting in owner.bl_rna.properties:
                if setting.identifier.startswith("shadow_terminator"):
                    setattr(owner, setting.identifier, 0.0)

    def _set_materials(self, mesh: Any, surface: np.ndarray) -> None:
        surfaces = self._about["surfaces"]
        used, which = np.unique(surface, return_inverse=True)
        by_attribute = len(used) > self._about["settings"]["most_materials"]
        slots: dict[str, int] = {}
        slot_of = []
        for index in used:
            known = surfaces[index]
            if by_attribute and known["radiance"] is not None:
                known = known | {"radiance": "attribute"}
            key = json.dumps(known)
            if key not in slots:
                slots[key] = len(slots)
                mesh.materials.append(self._material(known))
            slot_of.append(slots[key])
        mesh.polygons.foreach_set("material_index", np.array(slot_of, np.int32)[which.reshape(-1)])
        if by_attribute:
            radiances = np.array([surfaces[i]["radiance"] or (0, 0, 0) for i in used], np.float32)
            attribute = mesh.attributes.new("radiance", "FLOAT_VECTOR", "FACE")
            attribute.data.foreach_set("vector", radiances[which.reshape(-1)].reshape(-1))

    def _material(self, surface: dict[str, Any]) -> Any:
        made = bpy.data.materials.new("surface")
        nodes = _Nodes(made)
        shader = self._bsdf(nodes, self._about["materials"][surface["material"]])
        if surface["radiance"] is not None:
            made.cycles.emission_sampling = "FRONT_BACK" if surface["two_sided"] else "FRONT"
            emission = self._emission(nodes, surface)
            both = nodes.add("ShaderNodeAddShader", {0: emission, 1: shader}) if shader else None
            shader = both.outputs[0] if both else emission
        output = nodes.add("ShaderNodeOutputMaterial")
        if shader:
            made.node_tree.links.new(shader, output.inputs["Surface"])
        return made

    def _bsdf(self, nodes: _Nodes, material: dict[str, Any]) -> Any:
        """The output of the shader; None of what is black."""
        color: Any = _rgba(material["base_color"])
        texture = material["base_color_texture"]
        if texture is None and not any(color[:3]) and not material["metallic_roughness"]:
            return None
        if texture is not None:
            color = self._product(nodes, self._texel(nodes, texture), color[:3])
        if not material["metallic_roughness"]:
            return nodes.add("ShaderNodeBsdfDiffuse", {"Color": color, "Roughness": 0.0}).outputs[0]
        roughness: Any = material["roughness"]
        metallic: Any = material["metallic"]
        texture = material["metallic_roughness_texture"]
        if texture is not None:
            parts = nodes.add("ShaderNodeSeparateXYZ", {0: self._texel(nodes, texture)}).outputs
            roughness, metallic = (
                nodes.add("ShaderNodeMath", {0: part, 1: factor}, operation="MULTIPLY").outputs[0]
                for part, factor in ((parts["Y"], roughness), (parts["Z"], metallic))
            )
        inputs = {"Base Color": color, "Metallic": metallic, "Roughness": roughness, "IOR": 1.5}
        return nodes.add("ShaderNodeBsdfPrincipled", inputs, distribution="GGX").outputs[0]

    def _emission(self, nodes: _Nodes, surface: dict[str, Any]) -> Any:
        color: Any
        if surface["radiance"] == "attribute":
            color = nodes.add("ShaderNodeAttribute", attribute_name="radiance").outputs["Vector"]
        else:
            color = _rgba(surface["radiance"])
        texture = surface["emission_texture"]
        if texture is not None:
            factor = color if surface["radiance"] == "attribute" else color[:3]
            color = self._product(nodes, self._texel(nodes, texture), factor)
        emission = nodes.add("ShaderNodeEmission", {"Color": color, "Strength": 1.0}).outputs[0]
        if surface["two_sided"]:
            return emission
        backfacing = nodes.add("ShaderNodeNewGeometry").outputs["Backfacing"]
        return nodes.add("ShaderNodeMixShader", {0: backfacing, 1: emission}).outputs[0]

    def _texel(self, nodes: _Nodes, texture: int) -> Any:
        place = nodes.add("ShaderNodeUVMap", uv_map="uv").outputs[0]
        return nodes.add(
            "ShaderNodeTexImage", {"Vector": place}, image=self._image(f"texture{texture}.exr")
        ).outputs["Color"]

    def _image(self, name: str) -> Any:
        image = bpy.data.images.load(str(self._folder / name), check_existing=True)
        image.colorspace_settings.name = "Non-Color"
        return image

    @staticmethod
    def _product(nodes: _Nodes, color: Any, factor: Any) -> Any:
        return nodes.add(
            "ShaderNodeVectorMath", {0: color, 1: factor}, operation="MULTIPLY"
        ).outputs[0]

    def _add_light(self, kind: str, strength: Any, position: Any, direction: Any) -> Any:
        """strength: W/sr, or W/m^2 of a sun."""
        light = bpy.data.lights.new(kind.lower(), kind)
        peak = max(strength)
        light.color = [c / peak for c in strength] if peak > 0 else (0, 0, 0)
        # Blender's watts are of a light that shines in all directions.
        light.energy = peak if kind == "SUN" else 4 * np.pi * peak
        if kind == "SUN":
            light.angle = 0.0
        else:
            light.shadow_soft_size = 0.0
        made = self._object(kind.lower(), light)
        made.location = position
        made.rotation_mode = "QUATERNION"
        made.rotation_quaternion = mathutils.Vector(direction).to_track_quat("-Z", "Y")
        return light

    def _add_spot(self, spot: dict[str, Any]) -> None:
        """Blender's own fall-off is another one: a cone that is as wide, with ours within."""
        inner, outer = spot["inner"], spot["outer"]
        wide = 2 * outer * 1.001 + 1e-3
        kind = "SPOT" if wide < np.pi else "POINT"
        light = self._add_light(kind, spot["intensity"], spot["position"], spot["direction"])
        if kind == "SPOT":
            light.spot_size, light.spot_blend = wide, 0.0
        nodes = _Nodes(light)
        normal = nodes.add("ShaderNodeTexCoord").outputs["Normal"]
        along = nodes.add("ShaderNodeSeparateXYZ", {0: normal}).outputs["Z"]
        cosine = nodes.add("ShaderNodeMath", {0: along, 1: -1.0}, operation="MULTIPLY").outputs[0]
        least, most = float(np.cos(outer)), float(np.cos(inner))
        most = max(most, least + 1e-6)
        ramp = nodes.add("ShaderNodeMapRange", {"Value": cosine, 1: least, 2: most}).outputs[0]
        square = nodes.add("ShaderNodeMath", {0: ramp, 1: ramp}, operation="MULTIPLY").outputs[0]
        emission = nodes.add("ShaderNodeEmission", {"Strength": square}).outputs[0]
        nodes.add("ShaderNodeOutputLight", {"Surface": emission})

    def _set_world(self) -> None:
        self._scene.world = bpy.data.worlds.new("world")
        nodes = _Nodes(self._scene.world)
        environment = self._about["environment"]
        inputs: dict[str, Any] = {"Strength": 1.0, "Color": (0.0, 0.0, 0.0, 1.0)}
        if environment is not None:
            inputs["Color"] = self._environment(nodes, environment)
        background = nodes.add("ShaderNodeBackground", inputs).outputs[0]
        nodes.add("ShaderNodeOutputWorld", {"Surface": background})

    def _environment(self, nodes: _Nodes, environment: dict[str, Any]) -> Any:
        if environment["constant"] is not None:
            return _rgba(environment["constant"])
        # Blender's maps have +Z up and +X in the middle.
        s, c = np.sin(environment["rotation"]), np.cos(environment["rotation"])
        to_map = mathutils.Matrix(((-s, 0, -c), (-c, 0, s), (0, 1, 0)))
        direction = nodes.add("ShaderNodeNewGeometry").outputs["Incoming"]
        away = nodes.add(
            "ShaderNodeVectorMath", {0: direction, 1: (-1, -1, -1)}, operation="MULTIPLY"
        ).outputs[0]
        place = nodes.add(
            "ShaderNodeMapping",
            {"Vector": away, "Rotation": to_map.to_euler("XYZ")},
            vector_type="VECTOR",
        ).outputs[0]
        color = nodes.add(
            "ShaderNodeTexEnvironment", {"Vector": place}, image=self._image("environment.exr")
        ).outputs["Color"]
        return self._product(nodes, color, environment["scale"])

    def _set_camera(self) -> None:
        about = self._about["camera"]
        camera = bpy.data.cameras.new("camera")
        camera.sensor_fit = "VERTICAL"
        camera.angle_y = about["vertical_fov"]
        camera.clip_start, camera.clip_end = 1e-5, 1e9
        radius = about["aperture_radius"]
        camera.dof.use_dof = radius > 0
        if radius > 0:
            camera.dof.focus_distance = about["focus_distance"]
            camera.dof.aperture_fstop = camera.lens / (2000 * radius)
        made = self._object("camera", camera)
        origin = mathutils.Vector(about["origin"])
        forward = (mathutils.Vector(about["target"]) - origin).normalized()
        right = forward.cross(mathutils.Vector(about["up"])).normalized()
        axes = mathutils.Matrix((right, right.cross(forward), -forward)).transposed()
        made.matrix_world = mathutils.Matrix.Translation(origin) @ axes.to_4x4()
        self._scene.camera = made

    def _set_render(self) -> None:
        about = self._about["settings"]
        render = self._scene.render
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y = about["size"]
        render.resolution_percentage = 100
        render.threads_mode, render.threads = "FIXED", about["threads"]
        render.use_persistent_data = True
        render.film_transparent = False
        layer = self._scene.view_layers[0]
        layer.use_pass_emit = layer.use_pass_environment = True
        image = render.image_settings
        if hasattr(image, "media_type"):  # Blender 5
            image.media_type = "MULTI_LAYER_IMAGE"
        image.file_format = "OPEN_EXR_MULTILAYER"
        image.color_depth, image.exr_codec = "32", "NONE"
        self._set_cycles(about)

    def _set_cycles(self, about: dict[str, Any]) -> None:
        """Nothing that is biased, and what is ours: a box for the filter of pixels."""
        cycles = self._scene.cycles
        cycles.device = "CPU"
        cycles.use_light_tree = about["light_tree"]
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        cycles.pixel_filter_type = "BOX"
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
        cycles.blur_glossy = 0.0
        bounces = about["max_depth"] - 2
        for kind in ("max", "diffuse", "glossy", "transmission"):
            setattr(cycles, f"{kind}_bounces", bounces)


def _render(first: int, samples: int, seed: int, path: str) -> float:
    scene, cycles = bpy.context.scene, bpy.context.scene.cycles
    # Number 0 is always through the middle of its pixel.
    cycles.seed, cycles.sample_offset, cycles.samples = seed, first + 1, samples
    if hasattr(cycles, "use_sample_subset"):  # from 4.5 on: a part of all samples
        cycles.use_sample_subset, cycles.sample_subset_length = True, samples
        cycles.samples = first + 1 + samples
    scene.render.filepath = path
    start = time.process_time()
    bpy.ops.render.render(write_still=True)
    return time.process_time() - start


def _answer(seconds: float) -> None:
    layers = ("Emission", "Environment") if bpy.app.version >= (5, 0) else ("Emit", "Env")
    print(f"\n{ANSWER}{json.dumps({'seconds': seconds, 'emission': layers})}", flush=True)


def main() -> None:
    folder = Path(sys.argv[-1])
    _Builder(folder).build()
    _answer(_render(0, 1, 0, str(folder / "first.exr")))
    for line in sys.stdin:
        _answer(_render(**json.loads(line)))


if __name__ == "__main__":
    main()
