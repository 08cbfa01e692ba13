# SPDX-License-Identifier: Apache-2.0
"""eval: values and densities at pairs from arguments, tables and stdin; what is refused, with line and column."""
import ast
import math
import struct
import subprocess
import unittest

from program import PROGRAM, ProgramTest, environment

HEAD = ["wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"]


def direction(theta_deg, phi_deg=0.0):
    theta, phi = math.radians(theta_deg), math.radians(phi_deg)
    return (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))


def text(vector):
    return ",".join(f"{x:.9g}" for x in vector)


class Eval(ProgramTest):
    def rows(self, *args, **more):
        out, words = self.run_program("-q", "eval", *args, **more)  # no progress, however slow the machine
        self.assertEqual(words, "")
        head, *lines = out.splitlines()
        return [dict(zip(head.split(","), map(float, line.split(",")))) for line in lines]

    def test_columns_and_values_of_a_known_function(self):
        wi = direction(60, 20)
        out, _ = self.run_program("eval", "lambert:rho=0.25/0.5/0.75", "--wo", "0,0,1", "--wi", text(wi))
        self.assertEqual(out.splitlines()[0].split(","),
                         HEAD + ["f_r", "f_g", "f_b", "f_cos_r", "f_cos_g", "f_cos_b", "pdf_exact", "pdf_one_shot"])
        (row,) = self.rows("lambert:rho=0.25/0.5/0.75", "--wo", "0,0,1", "--wi", text(wi))
        for channel, rho in zip("rgb", (.25, .5, .75)):
            self.assertAlmostEqual(row["f_" + channel], rho / math.pi, places=6)
            self.assertAlmostEqual(row["f_cos_" + channel], rho / math.pi * .5, places=6)
        # The exact density of a constant function is that of a cosine; the one-shot one is close to it.
        self.assertAlmostEqual(row["pdf_exact"], .5 / math.pi, places=4)
        self.assertAlmostEqual(row["pdf_one_shot"], .5 / math.pi, delta=.02)
        for name, x in zip(HEAD[3:], wi):
            self.assertAlmostEqual(row[name], x, places=6)

    def test_densities_are_those_of_sample(self):
        for mode, column in (("exact", "pdf_exact"), ("one-shot", "pdf_one_shot")):
            out, _ = self.run_program("sample", "plastic", "-n", 50, "--theta-o-deg", 50, "--mode", mode)
            drawn = [list(map(float, line.split(","))) for line in out.splitlines()[1:]]
            self.write("pairs.csv", "".join(f"{text(direction(50))},{text(d[:3])}\n" for d in drawn).encode())
            for row, sample in zip(self.rows("plastic", "--pairs", "pairs.csv"), drawn):
                self.assertAlmostEqual(row[column] / sample[3], 1, places=3)
                for channel, weight in zip("rgb", sample[4:]):
                    self.assertAlmostEqual(row["f_cos_" + channel] / sample[3], weight, delta=2e-3 * weight)

    def test_the_densities_integrate_to_one(self):
        lines = []
        n = 60
        for i in range(n):
            z = (i + .5) / n
            for k in range(2 * n):
                phi, r = math.pi * (k + .5) / n, math.sqrt(1 - z * z)
                lines.append(text((*direction(40), r * math.cos(phi), r * math.sin(phi), z)) + "\n")
        self.write("grid.csv", "".join(lines).encode())
        rows = self.rows("ggx:alpha=0.5", "--pairs", "grid.csv")
        for column in ("pdf_exact", "pdf_one_shot"):
            self.assertAlmostEqual(sum(r[column] for r in rows) * 2 * math.pi / len(rows), 1, delta=.01)

    def test_ways_of_giving_pairs_agree(self):
        angles = [(30, 40, 180), (60, 10, 90), (0, 80, 7.5)]
        lists = [",".join(map(str, column)) for column in zip(*angles)]
        wanted = self.rows("ggx", "--theta-o-deg", lists[0], "--theta-i-deg", lists[1], "--phi-deg", lists[2])
        self.assertEqual(len(wanted), 3)
        pairs = [(direction(o), direction(i, phi)) for o, i, phi in angles]
        vectors = []
        for wo, wi in pairs:
            vectors += ["--wo", text(wo), "--wi", text(wi)]
        self.write("plain.csv", "".join(f"{text(wo)},{text(wi)}\r\n" for wo, wi in pairs).encode())
        self.write("named.csv", ("wi_z,name,wo_x,wo_y,wo_z,wi_x,wi_y\n" + "".join(
            f"{wi[2]:.9g},a {n},{text(wo)},{wi[0]:.9g}, {wi[1]:.9g}\n\n" for n, (wo, wi) in enumerate(pairs))).encode())
        self.write("angles.csv", ("\ufeffphi_deg,theta_o_deg,theta_i_deg\n" + "".join(
            f"{phi},{o},{i}\n" for o, i, phi in angles)).encode())
        for args in (vectors, ["--pairs", "plain.csv"], ["--pairs", "named.csv"], ["--pairs", "angles.csv"]):
            got = self.rows("ggx", *args)
            self.assertEqual(len(got), 3, args)
            for row, other in zip(got, wanted):
                for name, value in row.items():
                    self.assertAlmostEqual(value, other[name], delta=1e-5 * (1 + abs(value)), msg=(args, name))

    def test_a_single_entry_serves_for_all(self):
        rows = self.rows("lambert", "--theta-o-deg", "45", "--theta-i-deg", "10,20,30", "--phi-deg", "0")
        self.assertEqual([round(math.degrees(math.acos(r["wi_z"]))) for r in rows], [10, 20, 30])
        self.assertEqual({r["wo_z"] for r in rows}, {rows[0]["wo_z"]})
        rows = self.rows("lambert", "--wo", "0,0,1", "--wo", "0.6,0,0.8", "--wi", "-0.6,0,0.8")
        self.assertEqual([r["wo_z"] for r in rows], [1, .8])
        self.assertEqual([r["wi_x"] for r in rows], [-.6, -.6])

    def test_stdin_and_no_pdf(self):
        done = subprocess.run([PROGRAM, "eval", "ward:alpha_x=.1,alpha_y=.3", "--no-pdf", "--pairs", "-"],
                              input=b"0,0,1,0.6,0,0.8\n0,0,1,0,0.6,0.8\n", capture_output=True, env=environment(),
                              check=True, timeout=60)
        head, *lines = done.stdout.decode().splitlines()
        self.assertEqual(head.split(",")[-1], "f_cos_b", "no densities")
        x, y = (list(map(float, line.split(",")))[6] for line in lines)
        self.assertLess(x, y)  # of an anisotropic function

    def test_samplers_and_files(self):
        self.run_program("build", "ggx:alpha=0.3", "-o", "g.rfl")
        pair = ("--theta-o-deg", "30", "--theta-i-deg", "40", "--phi-deg", "170")
        self.assertEqual(self.rows("g.rfl", *pair), self.rows("ggx:alpha=0.3", *pair))
        self.assertEqual(self.rows("g.rfl", *pair, "--no-pdf")[0]["f_r"], self.rows("g.rfl", *pair)[0]["f_r"])
        self.assertIn("--no-pdf: options of building do not apply",
                      self.run_program("eval", "ggx", *pair, "--no-pdf", "--trials", "2", code=2)[1])

    def test_output_files_and_json(self):
        args = ("eval", "plastic", "--theta-o-deg", "10,80", "--theta-i-deg", "20", "--phi-deg", "180")
        out, _ = self.run_program(*args)
        self.assertIn("saved e.csv (2 rows)", self.run_program(*args, "-o", "e.csv")[1])
        self.assertEqual((self.folder / "e.csv").read_text(), out)
        self.assertEqual(self.run_program(*args, "-o", "e.npy")[0], "")
        data = (self.folder / "e.npy").read_bytes()
        self.assertEqual(data[:8], b"\x93NUMPY\x01\x00")
        length = struct.unpack("<H", data[8:10])[0]
        self.assertEqual((10 + length) % 64, 0)
        header = ast.literal_eval(data[10:10 + length].decode())
        self.assertEqual(header, {"descr": "<f8", "fortran_order": False, "shape": (2, 14)})
        numbers = [float(x) for line in out.splitlines()[1:] for x in line.split(",")]
        values = struct.unpack("<28d", data[10 + length:])
        self.assertTrue(all(abs(a - b) <= 1e-6 * abs(a) for a, b in zip(values, numbers)))
        result = self.json_of(*args)
        self.assertEqual(result["columns"], out.splitlines()[0].split(","))
        self.assertEqual([x for row in result["rows"] for x in row], numbers)

    def refused(self, expected, *args):
        out, words = self.run_program("eval", "lambert", *args, code=2)
        self.assertEqual(out, "")
        self.assertEqual(words.count("\n"), 1, words)
        self.assertTrue(words.startswith("error: "), words)
        self.assertIn(expected, words)

    def test_arguments_that_are_refused(self):
        self.refused("no pairs of directions")
        self.refused("--wo: alone", "--wo", "0,0,1")
        self.refused("--wo: missing", "--wi", "0,0,1")
        self.refused("in two ways", "--wo", "0,0,1", "--wi", "0,0,1", "--phi-deg", "0")
        self.refused("--wo 0,0,2, column 1: wo is 2 long", "--wo", "0,0,2", "--wi", "0,0,1")
        self.refused("--wi 0.6,0,-0.8, column 7: wi is not above the surface: its z is -0.8",
                     "--wo", "0,0,1", "--wi", "0.6,0,-0.8")
        self.refused("(number 2), column 5: 'x' is no number", "--wo", "0,0,1", "--wi", "0,0,1", "--wi", "0,0,x")
        self.refused("2 numbers in place of 3", "--wo", "0,1", "--wi", "0,0,1")
        self.refused("lists of 2 and 3 entries", *["--wo", "0,0,1"] * 2, *["--wi", "0,0,1"] * 3)
        self.refused("all three", "--theta-o-deg", "10", "--phi-deg", "0")
        angles = ("--theta-i-deg", "10", "--phi-deg", "0")
        self.refused("--theta-o-deg 10,90, column 4: theta_o of 90 degrees is not above", "--theta-o-deg", "10,90", *angles)
        self.refused("--theta-o-deg -1, column 1", "--theta-o-deg", "-1", *angles)
        self.refused("'nan' is no number", "--theta-o-deg", "nan", *angles)

    def test_tables_that_are_refused_with_line_and_column(self):
        good = "0,0,1,0.6,0,0.8\n"
        for content, expected in (
                (good + "0,0,1, 0.6,0,0.9\n", "p.csv:2:8: wi is 1.08167 long"),
                (good + "\n0.6,0,-0.8,0,0,1\n", "p.csv:3:7: wo is not above the surface: its z is -0.8"),
                (good + "0,0,1,0.6,0\n", "p.csv:2:1: 5 numbers in place of 6"),
                (good + "0,0,1,0.6,,0.8\n", "p.csv:2:11: '' is no number"),
                (good + "0,0,1,0.6,0x,0.8\n", "p.csv:2:11: '0x' is no number"),
                ("wo_x,wo_y\n1,2\n", "p.csv:1:1: a header without the columns of a pair"),
                ("wo_x,wo_y,wo_z,wi_x,wi_y,wi_z,wo_y\n", "p.csv:1:31: column 'wo_y' stands twice"),
                ("theta_o_deg,theta_i_deg,phi_deg\n10,95,0\n", "p.csv:2:4: theta_i of 95 degrees"),
                ("wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n", "p.csv: no pairs"),
                ("", "p.csv: empty"),
                ("<html>gone</html>", "p.csv: an HTML page"),
                ("\x00\x01", "p.csv:1:1: "),
        ):
            self.write("p.csv", content.encode())
            self.refused(expected, "--pairs", "p.csv")
        self.refused("no.csv: no such file", "--pairs", "no.csv")
        self.refused("stdin: empty", "--pairs", "-")

    def test_rounded_vectors_are_taken_and_normalised(self):
        (row,) = self.rows("lambert", "--wo", "0,0,1", "--wi", "0.6003,0,0.8003")
        self.assertAlmostEqual(row["wi_x"] ** 2 + row["wi_z"] ** 2, 1, places=6)
        self.refused("long", "--wo", "0,0,1", "--wi", "0.601,0,0.801")


if __name__ == "__main__":
    unittest.main()
