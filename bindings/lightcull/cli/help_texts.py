"""How the command line explains itself: what there is, and examples for each command."""

from __future__ import annotations

from ..scenes import NAMES

_SCENES = "\n".join(f"  {name:10} {description}" for name, description in NAMES.items())

OVERVIEW = f"""\
Renders scenes lit by up to millions of lights, and compares the ways to choose among them.

SCENE is a file (.glb, .gltf, .obj, .ply), an .xml of Mitsuba's, which Mitsuba then renders with the
integrator lightcull_path (media with lightcull_volpath), or the name of an example:
{_SCENES}

SAMPLER is the way to choose a light for a point:
  uniform     every light alike
  power       in proportion to its power
  light_bvh   down a tree of clusters (Conty Estevez & Kulla 2018)
  culled      stochastic light culling, resampled
  learned     culled, and what it learns from shadow rays of what is hidden: the default
  paper       stochastic light culling as published (Tokuyoshi & Harada 2016)
  clamped     lights with a limited range: biased, for comparison
  exhaustive  weighs every light for every point: slow, the floor for error
  path        Mitsuba's own integrator, for an .xml only
Options follow at colons: culled:sets=16, culled:accepted=32, paper:list=0:error_bound=auto,
light_bvh:importance=means (means over a cluster in place of the published bounds: less noise)."""

EXAMPLES = """\
examples:
  lightcull render lanterns -o lanterns.exr --seconds 10
  lightcull compare lanterns --samplers uniform,light_bvh,learned --seconds 30 -o report
  lightcull info city

Ctrl-C ends a render after the pass under way and keeps what there is; twice, at once. Exit codes:
0 done, 1 error, 2 wrong usage, 130 interrupted. `lightcull COMMAND --help` says more."""

RENDER = """\
examples:
  lightcull render lanterns -o lanterns.exr               10 seconds, linear radiance
  lightcull render city -o city.png --size 640x360        a picture to look at
  lightcull render room.glb -o room.exr --max-depth 6 --spp 256
  lightcull render car.glb -o car.png --camera-from 4,2,6 --fov 30 --environment sky.exr
  lightcull render scene.xml -o scene.exr -D max_depth=8 --camera front
  lightcull render cornell -o a.exr --sampler uniform --spp 16 --seed 7
  lightcull render cornell -o b.exr --method vpl_culled:lights=16384 --spp 8
  lightcull render cornell -o c.exr --virtual-lights 16384 --sampler light_bvh

  lightcull render city -o city.exr --spp 4096 --checkpoint city.checkpoint
  lightcull render city -o city.exr --spp 4096 --resume city.checkpoint

  lightcull render city -o city.exr --spp 4096 --cluster tcp://10.0.0.1:8786
  lightcull render shot.####.glb -o out.####.exr --frames 1:100 --spp 64 --cluster local:4

A render that was resumed has the same bits as one that never stopped. The checkpoint is whole at any
moment; one of another scene, sampler, size, depth, seed or build is refused.

The same seed gives the same image, whatever the number of threads. An .exr holds what made it:
scene, method, sampler, seed, samples, seconds.

METHOD is how light that bounces is found, with --max-depth 3 (the default here) to 5:
  path         by paths
  vpl_culled   by virtual lights where light paths meet surfaces, with stochastic tiled lighting
               (Tokuyoshi & Harada 2016, 2017)
  vpl_clamped  the same with constant ranges: too dark, for comparison
  vpl_grid     far virtual lights taken together, by a lighting grid hierarchy (Lin & Yuksel 2019)
  vpl_all      every virtual light at every pixel: slow
Options follow at colons: lights=65536 (light paths), shadows=rays|maps|none (maps:
imperfect shadow maps, not of vpl_grid), accepted=32 (virtual lights per pixel; or error_bound=),
interleave=8 (1, 2, 4), filter=on|off, volume=spheroid|sphere_around|
sphere_at_light, tile=16 (pixels along the edge of a tile; small ones are often faster),
culling=tiles|splatting (with shadows=none), source=paths|shadow_map (of spots, directional lights and
the environment, lights= texels each); of vpl_grid alpha=2 (accuracy) and samples=4 (shadow rays per
pixel). New virtual lights are drawn in each pass. --sampler is for direct light."""

COMPARE = """\
examples:
  lightcull compare lanterns --samplers uniform,learned --seconds 20 --repeats 5
  lightcull compare city --samplers light_bvh,culled,learned -o report-city
  lightcull compare cornell --samplers culled:sets=16,culled:sets=64 --spp 64
  lightcull compare --host mitsuba scene.xml --samplers path,learned
  lightcull compare lanterns --samplers learned,cycles,cycles:light_tree=off
  lightcull compare cornell --methods path,vpl_culled,vpl_clamped,vpl_grid -o report-methods

Builds and refits count as render time. The samplers take turns, so that a noisy machine is fair to
all. With --repeats each renders several times with other seeds, all side by side: from two on
figures have 95 % intervals, and variance is told from bias. What is measured is the light that falls
on surfaces; the error of lamps that the camera sees directly, which is the same for all, is shown
beside. A reference is rendered first, for 8 times as long, by learned with seeds of its own, and kept
in ~/.cache/lightcull; its noise is taken off the errors. The folder gets index.html, report.json,
report.csv and the images.

cycles and pbrt, among the samplers, are other renderers, by equal time of processors: Cycles where
Python has Blender's module bpy (or one that LIGHTCULL_BPY_PYTHON names), with its light tree or with
light_tree=off; pbrt-v4 where its program is on the path.

With --methods each method renders for --seconds, and then virtual lights are counted and timed from
1,024 light paths to --most-lights: stochastic tiled lighting against constant ranges, spheroids
against spheres, tiles against splatting, imperfect shadow maps, the lighting grid hierarchy. The folder gets index.html,
report.json, a CSV file for each table and the images."""

BENCH = """\
examples:
  lightcull bench                                         every example scene and the series
  lightcull bench lanterns --json bench.json
  lightcull bench series --samplers light_bvh,culled --threads 2
  lightcull bench city --targets all --samplers culled
  lightcull bench city --device vulkan --samplers culled  a GPU beside the processor

Times are wall time, the median of five repetitions in which the samplers take turns:
  batch    nanoseconds of a selection, many points to a call. All that a pass needs is in it: of
           culled, the sorting of the points AND the pass's refit for every set of ranges
  per s    selections of batches per second, to hold a device against the processor
  single   nanoseconds of a selection, one point to a call; the pass's refit is not in it
  ray      nanoseconds of one shadow ray from these points to the lights that the sampler chose
  arrive   share of those rays that reach their light
  refit    nanoseconds of a pass's refit, per light and set of ranges; about 0 where there is none
  build s  the build of the sampler, calibration included
Counts: tree nodes visited and lights tested per point. B/light: memory of the sampler.
Points are what camera rays hit; scattered: what paths hit after one bounce and after two; uniform:
anywhere in the scene's bounds. exhaustive has fewer points where there are many lights. --json
writes a list of rows with the keys scene, lights, points (camera, scattered, uniform), sampler,
device, entry (batch, single), target, threads, ns_per_selection, selections_per_second,
shadow_ray_ns, rays_arrived, nodes_per_point, lights_tested_per_point, refit_ns_per_light,
build_seconds, bytes_per_light, cells and publish_seconds (of a sampler that learns: after 24 rounds of
reports at these points). All of it takes half an hour or so; a scene takes one or two minutes."""

INFO = """\
examples:
  lightcull info lanterns
  lightcull info room.glb                                 also names what is not supported
  lightcull info city --size 3840x2160 --sampler light_bvh
  lightcull info cornell --method vpl_culled:lights=1000000

The memory is that of `lightcull render` with the same options, which is set up to find it out."""

SELFTEST = """\
examples:
  lightcull selftest                                      a minute or two
  lightcull selftest --json selftest.json                 and a row for each case and instruction set
  lightcull selftest --noise                              two minutes: is learned ever noisier?

Numbers that are hard to compute with: tiny, huge and distant scenes, points on lights and in their
planes, powers over twelve decades, needles, edges of ranges, furnaces. Each case shows our error
beside a closed form or an exhaustive answer, what rounding in single precision (or noise) allows, and
how many of the instruction sets pass, the scalar path among them. It ends with a line `N passed, 0
failed`; the exit code is 1 if any fails.

--noise: 63 situations of few lights, each with a closed form or a sum in double precision. Of each the
table has the variance of a sample of learned, over the square of its mean, on average over 48x48 pixels
and 64 passes; that of the best of uniform, power, light_bvh, light_bvh:importance=means and exhaustive;
the ratio of the two, variances below 0.001 being all alike (0.4 % of a pixel after 64 samples); and how
many standard deviations the mean of learned is off. OK is a ratio of at most 1.25; worse, one that is
known and being worked on; WORSE and WRONG (5 standard deviations) make the exit code 1."""
