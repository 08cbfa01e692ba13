# SPDX-License-Identifier: Apache-2.0
"""info tells what is doubtful in a measured file, and how often it reaches a value."""
import struct
import unittest

from program import ProgramTest

BUILD = ("--trials", "4", "--variance", "1")


def tensor_file(fields):
    """A tensor_file of 32-bit floats, and of bytes where `type` is 1."""
    offset = 18 + sum(2 + len(name) + 3 + 8 + 8 * len(shape) for name, _, shape, _ in fields)
    head, body = b"tensor_file\0\1\0" + struct.pack("<I", len(fields)), b""
    for name, kind, shape, values in fields:
        data = bytes(values) if kind == 1 else struct.pack(f"<{len(values)}f", *values)
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", len(shape), kind, offset + len(body))
        head += struct.pack(f"<{len(shape)}Q", *shape)
        body += data
    return head + body


def rgl(red):
    """Grey but for red(theta_o's index, x)."""
    rgb = [red(t, x) if c == 0 else .3 for t in range(3) for c in range(3) for _ in range(3) for x in range(3)]
    return tensor_file([("phi_i", 10, (1,), [0]), ("theta_i", 10, (3,), [0, .8, 1.4]),
                        ("sigma", 10, (2, 2), [.25] * 4), ("ndf", 10, (2, 2), [1] * 4),
                        ("vndf", 10, (1, 3, 2, 2), [1] * 12), ("rgb", 10, (1, 3, 3, 3, 3), rgb),
                        ("jacobian", 1, (1,), [0])])


class Measured(ProgramTest):
    def test_negative_entries_are_counted_and_so_are_values(self):
        self.write("m.bsdf", rgl(lambda t, x: -.2 if t == 2 and x == 2 else .3))
        (facts,) = self.json_of("info", "m.bsdf", *BUILD)["measured"]
        self.assertEqual((facts["file"], facts["kind"]), ("m.bsdf", "RGL tensor_file"))
        self.assertEqual((facts["entries"], facts["negative_entries"]), (2 + 81, 3))
        self.assertEqual([node["negative"] for node in facts["negative_by_theta_o"]], [0, 0, 3])
        red, green, blue = facts["clipped_share"]
        self.assertTrue(0 < red < .2, red)
        self.assertEqual((green, blue), (0, 0))
        text, _ = self.run_program("info", "m.bsdf", *BUILD)
        self.assertIn("3 of 83 entries are negative (3.61 %), 3 of them at theta_o = 80.2 deg", text)
        self.assertRegex(text, r"clipped at 0 +red [0-9.]+ %, green 0, blue 0 of 20000 random pairs; most where")
        self.assertIn("nothing was measured for theta_o beyond 80.2 deg", text)

    def test_sound_files_say_so_and_models_say_nothing(self):
        self.write("m.bsdf", rgl(lambda t, x: .3))
        self.run_program("build", "0.5*lambert + 0.5*m.bsdf", "-o", "m.rfl", *BUILD)
        text, _ = self.run_program("info", "m.rfl")
        self.assertIn("m.bsdf: RGL tensor_file, none of 83 entries is negative", text)
        self.assertNotIn("clipped at 0", text)
        self.assertEqual(self.json_of("info", "lambert")["measured"], [])
        self.assertNotIn("measured", self.run_program("info", "lambert")[0])

    def test_missing_entries_of_a_merl_file(self):
        self.run_program("bake", "lambert:rho=0.5", "-o", "m.binary")
        data = bytearray((self.folder / "m.binary").read_bytes())
        cells = 90 * 90 * 180
        for cell in range(cells):
            if cell // 180 % 90 >= 70:  # theta_d above 70 degrees, blue
                data[12 + 8 * (2 * cells + cell):20 + 8 * (2 * cells + cell)] = struct.pack("<d", -1)
        self.write("m.binary", data)
        for member in ("nearest", "linear"):
            (facts,) = self.json_of("info", "m.binary#" + member, *BUILD, "--target", "channel:0")["measured"]
            self.assertEqual((facts["negative_entries"], facts["not_measured_entries"]), (0, 20 * 90 * 180))
            self.assertEqual(facts["clipped_share"], [0, 0, 0])
            self.assertEqual(facts["dark_share"][:2], [0, 0])
            self.assertGreater(facts["dark_share"][2], .01)
            self.assertEqual(facts["bridged_share"][2] > 0, member == "linear")

    def test_a_zemax_file_tells_what_was_decided(self):
        rows = "\n".join(".1 .1 .1 0" for _ in range(3))
        self.write("m.bsdf", ("Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\n"
                              "ScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 2\n10 60\nScatterAzimuth 3\n"
                              "0 90 180\nScatterRadial 4\n0 20 60 90\nMonochrome\nDataBegin\n"
                              f"TIS .2\n{rows}\nTIS .3\n{rows}\nDataEnd\n").encode())
        (facts,) = self.json_of("info", "m.bsdf", *BUILD)["measured"]
        self.assertEqual(facts["kind"], "Zemax BSDF of 1 rotation, 2 incidences, 3 azimuths and 4 radial angles")
        self.assertEqual(facts["notes"][0], "wo is the file's incident direction")
        self.assertGreater(facts["bridged_share"][0], 0)
        text, _ = self.run_program("info", "m.bsdf", *BUILD)
        self.assertIn("nothing was measured for theta_o below 10.0 deg", text)
        self.assertIn("nothing was measured for theta_o beyond 60.0 deg", text)
        self.assertRegex(text, r"bridged gaps +[0-9.]+ % of 20000 random pairs; most where")
        self.assertIn("the last value before a gap or the horizon stands in up to it", text)


if __name__ == "__main__":
    unittest.main()
