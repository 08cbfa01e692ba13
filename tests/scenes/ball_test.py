# SPDX-License-Identifier: Apache-2.0
"""The committed meshes of the material ball are those of tools/model_ball.py, and they are well made."""
import math
import pathlib
import struct
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import model_ball  # noqa: E402


def read(ply):
    """Vertices and triangles of a PLY as the generator writes it."""
    header, body = ply.split(b"end_header\n", 1)
    counts = {line.split()[1]: int(line.split()[2]) for line in header.decode().splitlines() if line.startswith("element")}
    vertices = list(struct.iter_unpack("<6f", body[:24 * counts["vertex"]]))
    triangles = [t[1:] for t in struct.iter_unpack("<B3i", body[24 * counts["vertex"]:])]
    assert len(triangles) == counts["face"]
    return vertices, triangles


def alike(a, b):
    """The same triangles, and vertices but for what another libm may round differently."""
    return (a[1] == b[1] and len(a[0]) == len(b[0]) and
            all(abs(x - y) <= 1e-6 for p, q in zip(a[0], b[0]) for x, y in zip(p, q)))


class Ball(unittest.TestCase):
    def meshes(self):
        for name, (profile, around) in model_ball.MESHES.items():
            yield name, read((ROOT / "scenes" / name).read_bytes()), model_ball.turned(profile(), around)

    def test_the_generator_makes_what_is_committed(self):
        for name, committed, made in self.meshes():
            made = read(model_ball.to_ply(*made))
            self.assertTrue(alike(committed, made), name)
            x, *rest = made[0][7]
            dented = (made[0][:7] + [(x + 1e-4, *rest)] + made[0][8:], made[1])
            self.assertFalse(alike(committed, dented), f"{name}: the twin")
        self.assertLess(sum((ROOT / "scenes" / name).stat().st_size for name in model_ball.MESHES), 400_000)

    def test_shading_normals_are_those_of_the_surface(self):
        for name, (vertices, triangles), _ in self.meshes():
            for vertex in vertices:
                self.assertAlmostEqual(math.hypot(*vertex[3:]), 1, places=5)
            worst = min(self.cosine(vertices, t) for t in triangles)
            # The tightest bevel has a radius of .014 and turns 90 degrees in four steps.
            self.assertGreater(worst, math.cos(math.radians(16)), name)
            flipped = min(self.cosine(vertices, t[::-1]) for t in triangles[:50])
            self.assertLess(flipped, 0, f"{name}: the twin")

    def test_no_holes(self):
        for name, (vertices, triangles), _ in self.meshes():
            sides = {}
            for a, b, c in triangles:
                for edge in ((a, b), (b, c), (c, a)):
                    self.assertNotIn(edge, sides, f"{name}: an edge is walked twice the same way")
                    sides[edge] = True
            # What has one side alone lies on the first or the last ring of the profile.
            rim = {vertices[a][2] for a, b in sides if (b, a) not in sides}
            self.assertLessEqual(len(rim), 2, name)

    @staticmethod
    def cosine(vertices, triangle):
        """The least cosine between the triangle's own normal and its corners'."""
        a, b, c = (vertices[i] for i in triangle)
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        return min(sum(n[k] * p[3 + k] for k in range(3)) for p in (a, b, c)) / math.hypot(*n)


if __name__ == "__main__":
    unittest.main()
