"""What lights send to a floor, in double precision: closed forms, and rules that sum them up."""

from __future__ import annotations

import numpy as np


def solid_angle(place: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Of the rectangle low..high (x, z) of the plane y = 0, from places (N, 3) above it: (N,)."""
    place = np.asarray(place, float)
    h = place[:, 1]

    def corner(x: float, z: float) -> np.ndarray:
        a, b = x - place[:, 0], z - place[:, 2]
        return np.arctan2(a * b, h * np.sqrt(h * h + a * a + b * b))

    seen = (
        corner(high[0], high[1]) - corner(low[0], high[1])
        - corner(high[0], low[1]) + corner(low[0], low[1])
    )  # fmt: skip
    return np.where(h > 0, seen, 0.0)


def triangle_irradiance(places: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """At places (P, 3) of a floor that faces up, from triangles (T, 3, 3) of radiance 1 above it
    that emit to the side where their corners run anticlockwise (Lambert 1760): (P, T).
    """
    to_corner = corners[None] - places[:, None, None]
    x, y, z = (to_corner[..., i] for i in range(3))
    length = np.sqrt(x * x + y * y + z * z)
    total = np.zeros(x.shape[:2])
    for i, j in ((0, 1), (1, 2), (2, 0)):
        cross_x = y[..., i] * z[..., j] - z[..., i] * y[..., j]
        cross_y = z[..., i] * x[..., j] - x[..., i] * z[..., j]
        cross_z = x[..., i] * y[..., j] - y[..., i] * x[..., j]
        cross = np.sqrt(cross_x * cross_x + cross_y * cross_y + cross_z * cross_z)
        angle = np.arcsin(np.minimum(cross / (length[..., i] * length[..., j]), 1.0))
        obtuse = x[..., i] * x[..., j] + y[..., i] * y[..., j] + z[..., i] * z[..., j] < 0
        angle = np.where(obtuse, np.pi - angle, angle)
        total += np.divide(angle * cross_y, cross, out=np.zeros_like(angle), where=cross > 0)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    in_front = np.einsum("tj,ptj->pt", normal, to_corner[:, :, 0]) < 0
    return np.where(in_front, 0.5 * np.abs(total), 0.0)


def spot_falloff(cosine: np.ndarray, inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
    """The part of its intensity that a spot emits (glTF's KHR_lights_punctual); angles: radians."""
    ramp = (cosine - np.cos(outer)) / (np.cos(inner) - np.cos(outer))
    return np.clip(ramp, 0.0, 1.0) ** 2


def spot_flux(inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
    """The flux of a spot of intensity 1, the integral of spot_falloff() over directions."""
    return 2 * np.pi * ((1 - np.cos(inner)) + (np.cos(inner) - np.cos(outer)) / 3)


def gauss_places(half: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (count^2, 3) of a floor from -half to half, and weights that sum to 1 (Gauss 1814)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    x, z = np.meshgrid(nodes * half, nodes * half)
    places = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    return places, np.outer(weights, weights).ravel() / 4



def hidden(a: np.ndarray, b: np.ndarray, plate: np.ndarray) -> np.ndarray:
    """Whether a plate (3, 3), of a corner and two edges, lies between places a (P, 3) and b (L, 3):
    (P, L)."""
    corner, u, v = plate
    normal = np.cross(u, v)
    height_a, height_b = (a - corner) @ normal, (b - corner) @ normal
    apart = height_a[:, None] - height_b[None]
    t = height_a[:, None] / np.where(apart == 0, 1.0, apart)
    # Lights that lie on the plate are not behind it.
    crossing = (t > 0) & (t < 1 - 1e-6) & (apart != 0)
    # The coordinate along u at the crossing is linear in t, from that of a to that of b.
    inside = crossing
    for edge, other in ((u, v), (v, u)):
        dual = np.cross(other, normal)
        dual = dual / (edge @ dual)
        of_a, of_b = (a - corner) @ dual, (b - corner) @ dual
        along = of_a[:, None] + t * (of_b[None] - of_a[:, None])
        inside = inside & (along >= 0) & (along <= 1)
    return inside


def metal_radiance(
    places: np.ndarray, eye: np.ndarray, lights: np.ndarray, f0: float, diffuse: float, alpha: float
) -> np.ndarray:
    """What places (P, 3) of a floor that faces up send to the eye (3,) of an irradiance of 1 that
    faces each of lights (L, 3): GGX with Smith's masking and Schlick's Fresnel term (glTF 2.0,
    appendix B), over a diffuse base: (P, L).
    """
    view = eye - places
    view = view / np.linalg.norm(view, axis=1, keepdims=True)
    way = lights[None] - places[:, None]
    way = way / np.linalg.norm(way, axis=2, keepdims=True)
    half = way + view[:, None]
    half = half / np.linalg.norm(half, axis=2, keepdims=True)
    n_v, n_l, n_h = view[:, None, 1], way[:, :, 1], half[:, :, 1]
    fresnel = f0 + (1 - f0) * (1 - np.einsum("pj,plj->pl", view, half)) ** 5
    a2 = alpha * alpha
    density = a2 / (np.pi * (n_h * n_h * (a2 - 1) + 1) ** 2)
    masking_l = n_l + np.sqrt(a2 + (1 - a2) * n_l * n_l)
    masking_v = n_v + np.sqrt(a2 + (1 - a2) * n_v * n_v)
    return n_l * (fresnel * density / (masking_l * masking_v) + (1 - fresnel) * diffuse / np.pi)
