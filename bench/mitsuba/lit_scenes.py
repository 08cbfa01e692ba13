# SPDX-License-Identifier: Apache-2.0
"""Three small scenes as Mitsuba's dictionaries: plates under lamps, balls under a sky with a sun, a room. bsdf(d) makes
of the description of a BSDF the one that is rendered. Import after a variant is set."""

import mitsuba as mi
import numpy as np


def matrix():
    return mi.ScalarTransform4f()


def camera(pixels, origin, target, fov):
    return {"type": "perspective", "fov": fov, "to_world": matrix().look_at(origin, target, [0, 0, 1]),
            "film": {"type": "hdrfilm", "width": pixels, "height": pixels * 2 // 3, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"}}


def rgb(*value):
    return {"type": "rgb", "value": list(value)}


def lamp(center, radius, *radiance):
    return {"type": "sphere", "center": center, "radius": radius, "emitter": {"type": "area", "radiance": rgb(*radiance)}}


def plates(pixels, bsdf):
    """Four plates of growing roughness, tilted so that each mirrors the lamps, as in Veach's scene; a dim sky."""
    kinds = ({"type": "roughconductor", "distribution": "ggx", "alpha": 0.03, "material": "Al"},
             {"type": "principled", "roughness": 0.3, "metallic": 0.9, "base_color": rgb(0.9, 0.7, 0.4)},
             {"type": "roughplastic", "distribution": "ggx", "alpha": 0.15, "diffuse_reflectance": rgb(0.1, 0.2, 0.3)},
             {"type": "roughconductor", "distribution": "ggx", "alpha": 0.4, "material": "Cu"})
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": 4},
             "sensor": camera(pixels, [0, -9, 4], [0, 0, 1.2], 38),
             "sky": {"type": "constant", "radiance": rgb(0.03, 0.04, 0.05)},
             "small": lamp([-2.4, 1.5, 4.5], 0.05, 900, 900, 900), "middle": lamp([0, 1.5, 4.5], 0.25, 36, 40, 36),
             "large": lamp([2.4, 1.5, 4.5], 0.7, 5, 5, 6),
             "floor": {"type": "rectangle", "to_world": matrix().scale(20), "bsdf": {"type": "diffuse"}}}
    for k, kind in enumerate(kinds):
        y = 1.6 - 1.3 * k
        # Half way between the lamps and the camera.
        normal = sum(np.asarray(v) / np.linalg.norm(v) for v in (np.array([0, 1.5 - y, 3.9]), np.array([0, -9 - y, 3.4])))
        place = matrix().look_at([0, y, 0.9 - 0.22 * k], [0, float(y + normal[1]), float(0.9 - 0.22 * k + normal[2])], [1, 0, 0])
        scene[f"plate{k}"] = {"type": "rectangle", "to_world": place @ matrix().scale([0.55, 2.6, 1]), "bsdf": bsdf(kind)}
    return scene


def sun_and_sky(height=128):
    """A sky that brightens towards the horizon, and a sun of 1.5 degrees that gives three quarters of the floor's light."""
    theta = (np.arange(height) + 0.5) / height * np.pi
    phi = (np.arange(2 * height) + 0.5) / height * np.pi
    t, p = np.meshgrid(theta, phi, indexing="ij")
    up = np.cos(t)[..., None]
    sky = np.where(up > 0, (1 - up) * [0.8, 0.8, 0.8] + up * [0.2, 0.35, 0.7], [0.15, 0.13, 0.1])
    toward = np.cos(t) * np.cos(0.9) + np.sin(t) * np.sin(0.9) * np.cos(p - 2.2)
    sky[toward > np.cos(np.radians(1.5))] = [4400, 4000, 3200]
    return {"type": "envmap", "bitmap": mi.Bitmap(sky.astype(np.float32)), "to_world": matrix().rotate([1, 0, 0], 90)}


def sun(pixels, bsdf, measured):
    """Four balls on a dull floor: measured materials where there are some, principled ones elsewhere."""
    kinds = [{"type": "principled", "roughness": 0.35, "clearcoat": 0.8, "clearcoat_gloss": 0.3, "base_color": rgb(0.6, 0.05, 0.05)},
             {"type": "principled", "roughness": 0.25, "metallic": 1.0, "base_color": rgb(1, 0.75, 0.35)},
             {"type": "principled", "roughness": 0.6, "sheen": 0.8, "base_color": rgb(0.2, 0.3, 0.5)},
             {"type": "principled", "roughness": 0.45, "spec_tint": 0.5, "base_color": rgb(0.2, 0.5, 0.2)}]
    kinds[2:] = (measured + kinds[2:])[:2]
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": 5},
             "sensor": camera(pixels, [0, -9, 3], [0, 0, 0.8], 36), "sky": sun_and_sky(),
             "floor": {"type": "rectangle", "to_world": matrix().scale(30),
                       "bsdf": bsdf({"type": "roughplastic", "alpha": 0.3, "diffuse_reflectance": rgb(0.3, 0.3, 0.3)})}}
    for k, kind in enumerate(kinds):
        scene[f"ball{k}"] = {"type": "sphere", "center": [2.1 * k - 3.15, 0, 1], "radius": 1, "bsdf": bsdf(kind)}
    return scene


def interior(pixels, bsdf):
    """A closed room, lit by a lamp that shines at the ceiling: nearly all light is indirect."""
    plaster = bsdf({"type": "roughplastic", "alpha": 0.4, "diffuse_reflectance": rgb(0.7, 0.65, 0.6)})
    wood = bsdf({"type": "principled", "roughness": 0.35, "specular": 0.6, "base_color": rgb(0.45, 0.25, 0.12)})
    def side(turn, shift, kind):
        return {"type": "rectangle", "to_world": matrix().translate(shift) @ turn @ matrix().scale(3), "bsdf": kind}
    def about(axis, degrees):
        return matrix().rotate(axis, degrees)
    return {"type": "scene", "integrator": {"type": "path", "max_depth": 10},
            "sensor": camera(pixels, [0, -2.8, 1.7], [0, 3, 1.3], 70),
            "floor": side(about([1, 0, 0], 0), [0, 0, 0], wood),
            "ceiling": side(about([1, 0, 0], 180), [0, 0, 3], {"type": "diffuse", "reflectance": rgb(0.8, 0.8, 0.8)}),
            "back": side(about([1, 0, 0], 90), [0, 3, 0], plaster),
            "front": side(about([1, 0, 0], -90), [0, -3, 0], plaster),
            "left": side(about([0, 1, 0], 90), [-3, 0, 0], bsdf(
                {"type": "principled", "roughness": 0.5, "base_color": rgb(0.6, 0.1, 0.1), "sheen": 0.5})),
            "right": side(about([0, 1, 0], -90), [3, 0, 0], bsdf(
                {"type": "principled", "roughness": 0.5, "base_color": rgb(0.1, 0.3, 0.6)})),
            "ball": {"type": "sphere", "center": [-1, 1.2, 0.7], "radius": 0.7, "bsdf": bsdf(
                {"type": "roughconductor", "distribution": "ggx", "alpha": 0.1, "material": "Au"})},
            "block": {"type": "cube", "to_world": matrix().translate([1.1, 1, 0.6]) @ about([0, 0, 1], 25) @ matrix().scale(
                [0.5, 0.5, 0.6]), "bsdf": bsdf({"type": "principled", "roughness": 0.4, "metallic": 0.9,
                                               "base_color": rgb(0.8, 0.8, 0.85)})},
            "lamp": {"type": "disk", "to_world": matrix().translate([1.8, -1, 2]) @ matrix().scale(0.3),
                     "emitter": {"type": "area", "radiance": rgb(300, 270, 225)}}}
