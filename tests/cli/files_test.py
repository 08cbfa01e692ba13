# SPDX-License-Identifier: Apache-2.0
"""What the program writes: samplers, samples, pictures, MERL tables, the demo's folder."""
import ast
import shutil
import struct
import unittest
import xml.etree.ElementTree

from program import ProgramTest


class Files(ProgramTest):
    def names(self):
        return sorted(p.name for p in self.folder.iterdir())

    def test_saved_and_fresh_samplers_agree(self):
        self.run_program("build", "ggx:alpha=0.3", "-o", "g.rfl")
        saved, fresh = self.json_of("info", "g.rfl"), self.json_of("info", "ggx:alpha=0.3")
        self.assertEqual(saved.pop("bytes_on_disk"), (self.folder / "g.rfl").stat().st_size)
        for facts in (saved, fresh):
            facts.pop("build_seconds"), facts.pop("bytes_on_disk", None)
        self.assertEqual(saved, fresh)
        for mode in ("exact", "one-shot"):
            self.assertEqual(self.run_program("sample", "g.rfl", "--mode", mode)[0],
                             self.run_program("sample", "ggx:alpha=0.3", "--mode", mode)[0])

    def test_files_do_not_depend_on_threads(self):
        for threads in (1, 2, 3):
            self.run_program("build", "plastic", "-o", f"{threads}.rfl", "--threads", threads)
            self.run_program("bake", "plastic", "-o", f"{threads}.binary", "--threads", threads)
            self.run_program("bake", "ward:alpha_x=.2,alpha_y=.4", "--format", "rgl", "--normals", "32", "--colours", "8",
                             "-o", f"{threads}.bsdf", "--threads", threads)
        for suffix in ("rfl", "binary", "bsdf"):
            one, *others = ((self.folder / f"{n}.{suffix}").read_bytes() for n in (1, 2, 3))
            self.assertTrue(all(other == one for other in others), suffix)

    def test_an_rgl_file_is_baked_and_read(self):
        text, _ = self.run_program("bake", "ggx:alpha=0.3", "--format", "rgl", "-o", "g.bsdf")
        self.assertRegex(text, r"^g.bsdf  isotropic, 1 x 16 viewers, 1.[0-9] MiB; differs from the material by 0?.?[0-9.]+ %$")
        self.assertEqual(self.run_program("list", "g.bsdf")[0], "g.bsdf\n")
        facts = self.json_of("bake", "ggx:alpha_x=.1,alpha_y=.3,phi_deg=20", "--format", "rgl", "--normals", "48",
                             "--azimuths", "3", "--elevations", "6", "-o", "a.bsdf")
        self.assertEqual((facts["reduction"], facts["azimuths"], facts["elevations"]), (2, 5, 6))
        self.assertLess(facts["error"], .1)
        self.assertEqual(facts["bytes"], (self.folder / "a.bsdf").stat().st_size)
        self.run_program("bake", "ggx", "--format", "pdf", "-o", "x", code=2)
        self.run_program("bake", "ggx", "--format", "rgl", "--normals", "1", "-o", "x", code=2)

    def test_options_of_building_matter(self):
        plain = self.json_of("info", "ggx:alpha=0.2")
        loose = self.json_of("info", "ggx:alpha=0.2", "--trials", "2", "--variance", "0.1")
        self.assertGreater(plain["exact_leaves"], loose["exact_leaves"])
        self.assertGreater(plain["one_shot_leaves"], loose["one_shot_leaves"])
        self.assertEqual(self.json_of("info", "ggx", "--domain", "equal_area")["domain"], "equal_area")
        self.assertEqual(self.json_of("info", "ggx", "--target", "channel:2")["target"], "channel:2")

    def test_measured_files_are_found_in_the_folder_of_data(self):
        header = "material," + ",".join(f"{p}_{c}" for p in ("kd", "A") for c in "rgb") + ",B,C,ior"
        (self.folder / "data").mkdir()
        self.write("data/abc.csv", (header + "\none,.1,.1,.1,1,1,1,100,1,1.5\n").encode())
        self.assertIn("no such file", self.run_program("list", "abc.csv#one", code=2)[1])
        self.assertEqual(self.run_program("list", "abc.csv#one", "--data", "data")[0], "abc.csv#one\n")
        self.assertEqual(self.run_program("list", "abc.csv#one", REFLECTREE_DATA="data")[0], "abc.csv#one\n")
        self.run_program("build", "abc.csv#one", "-o", "a.rfl", "--data", "data", "--trials", "2", "--variance", ".5")
        self.run_program("info", "a.rfl", "--data", "data")
        # A sampler finds its material beside itself, wherever it is called from.
        shutil.copy(self.folder / "a.rfl", self.folder / "data" / "a.rfl")
        self.run_program("info", "a.rfl", code=2)
        self.run_program("info", "data/a.rfl")

    def test_npy_is_what_numpy_reads(self):
        self.run_program("sample", "lambert", "-n", 100, "-o", "s.npy")
        self.run_program("sample", "lambert", "-n", 100, "-o", "s.csv")
        data = (self.folder / "s.npy").read_bytes()
        self.assertEqual(data[:8], b"\x93NUMPY\x01\x00")
        length = struct.unpack("<H", data[8:10])[0]
        header = ast.literal_eval(data[10:10 + length].decode())
        self.assertEqual(header, {"descr": "<f4", "fortran_order": False, "shape": (100, 7)})
        values = struct.unpack(f"<{700}f", data[10 + length:])
        rows = (self.folder / "s.csv").read_text().splitlines()[1:]
        numbers = [float(x) for row in rows for x in row.split(",")]
        self.assertTrue(all(abs(a - b) < 1e-6 * (1 + abs(a)) for a, b in zip(values, numbers)))

    def test_drawings(self):
        self.run_program("build", "ggx", "-o", "g.rfl")
        for output in ("g.svg", "g.html", "pictures"):
            out, _ = self.run_program("draw", "g.rfl", "-o", output, "--theta-o-deg", "10,80")
            for line in out.splitlines():
                self.assertTrue((self.folder / line).is_file(), line)
                if line.endswith(".svg"):
                    self.assertIn("svg", xml.etree.ElementTree.parse(self.folder / line).getroot().tag)
        self.assertEqual(len(out.splitlines()), 2 * 4 + 2 + 1)
        page = (self.folder / "g.html").read_text()
        self.assertIn("ggx:alpha=0.1", page)
        self.assertNotIn("http://", page.replace("http://www.w3.org/", ""))
        self.assertEqual(self.names(), ["g.html", "g.rfl", "g.svg", "pictures"])

    def test_bake_writes_a_merl_file(self):
        result = self.json_of("bake", "plastic:alpha=0.3", "-o", "p.binary")
        data = (self.folder / "p.binary").read_bytes()
        self.assertEqual(struct.unpack("<3i", data[:12]), (90, 90, 180))
        self.assertEqual(result["bytes"], len(data))
        self.assertEqual(len(data), 12 + 3 * 90 * 90 * 180 * 8)
        self.assertEqual(self.run_program("list", "p.binary")[0], "p.binary\n")
        self.run_program("bake", "lambert", "--non-reciprocal", "-o", "l.binary")
        self.assertEqual(struct.unpack("<3i", (self.folder / "l.binary").read_bytes()[:12]), (90, 90, 360))

    def test_demo_of_one_material(self):
        out, words = self.run_program("demo", "lambert", "-o", "shown")
        table = out.splitlines()
        self.assertTrue(table[0].startswith("material"))
        self.assertIn(" pass ", table[1])
        self.assertEqual(out.splitlines()[-1], "shown/index.html")
        self.assertIn("1/1  lambert", words)
        self.assertEqual(sorted(p.name for p in (self.folder / "shown").iterdir()), ["index.html", "lambert.rfl"])
        self.run_program("info", "shown/lambert.rfl")


if __name__ == "__main__":
    unittest.main()
