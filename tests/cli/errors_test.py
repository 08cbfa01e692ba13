# SPDX-License-Identifier: Apache-2.0
"""Every way to go wrong: exit code 2, nothing on stdout, one line with what, where and how to mend it."""
import struct
import unittest
import zlib

from program import ProgramTest


def chunks(file):
    """(tag, start of payload, length) of each chunk of a sampler file."""
    at = 8
    while at < len(file) - 4:
        length = struct.unpack_from("<Q", file, at + 8)[0]
        yield file[at:at + 4], at + 16, length
        at += 16 + length


def with_material(file, text):
    """The sampler file with another material's text, and a right checksum."""
    text = text.encode()
    payload = struct.pack("<I", len(text)) + text
    for tag, start, length in chunks(file):
        if tag == b"MATL":
            body = file[:start - 8] + struct.pack("<Q", len(payload)) + payload + file[start + length:-4]
            return body + struct.pack("<I", zlib.crc32(body))
    raise ValueError("no chunk MATL")


class Errors(ProgramTest):
    def assert_error(self, expected, *args):
        out, words = self.run_program(*args, code=2)
        self.assertEqual(out, "", args)
        self.assertEqual(words.count("\n"), 1, words)
        self.assertTrue(words.startswith("error: "), words)
        self.assertIn("; ", words, "how to mend it")
        self.assertIn(expected, words)

    def test_usage(self):
        self.assert_error("subcommand is required")
        self.assert_error("did you mean 'info'", "inof", "lambert")
        self.assert_error("reflectree info: SAMPLER is required", "info")
        self.assert_error("--output is required", "build", "lambert")
        self.assert_error("--frob", "list", "--frob")
        self.assert_error("extra", "info", "lambert", "extra")
        self.assert_error("not negative", "info", "lambert", "--seed", "-1")
        self.assert_error("--threads", "info", "lambert", "--threads", "-1")
        self.assert_error("--threads", "info", "lambert", "--threads", "many")
        self.assert_error("--count", "sample", "lambert", "-n", "0")
        self.assert_error("--mode", "sample", "lambert", "--mode", "fast")
        self.assert_error("--plant", "verify", "lambert", "--plant", "bug")

    def test_values(self):
        self.assert_error("90 is not above the surface", "sample", "lambert", "--theta-o-deg", "90")
        self.assert_error("no list of elevations", "draw", "lambert", "--theta-o-deg", "10,x", "-o", "a")
        self.assert_error("no list of elevations", "verify", "lambert", "--theta-o-deg", "")
        self.assert_error("--trials", "info", "lambert", "--trials", "1")
        self.assert_error("--variance", "info", "lambert", "--variance", "0")
        self.assert_error("no target 'blue'", "info", "lambert", "--target", "blue")
        self.assert_error("no channel 3: the material has 3", "info", "lambert", "--target", "channel:3")
        self.assert_error("no target 'channel:-1'", "info", "lambert", "--target", "channel:-1")
        self.assert_error("no domain 'round'", "info", "lambert", "--domain", "round")
        self.assert_error("no exponent", "info", "lambert", "--domain", "stretched:2")

    def test_materials(self):
        self.assert_error("did you mean 'ggx'", "info", "gggx")
        self.assert_error("unknown parameter 'alpa'", "info", "ggx:alpa=1")
        self.assert_error("out of range", "info", "ggx:alpha=9")
        self.assert_error("expected a number", "info", "lambert:rho=nan")
        self.assert_error("weight out of range", "info", "1e30*lambert")
        self.assert_error("expected a model or a file", "list", "0.3*")

    def test_files(self):
        self.assert_error("missing.bsdf: no such file", "info", "missing.bsdf")
        self.assert_error("is a directory", "info", "./")
        self.write("empty.bsdf", b"")
        self.assert_error("empty.bsdf: empty", "info", "empty.bsdf")
        self.write("foreign.bsdf", b"\x89PNG\r\n\x1a\n" + b"x" * 1000)
        self.assert_error("foreign.bsdf: a PNG picture; name an RGL", "info", "foreign.bsdf")
        self.write("foreign.bsdf", b"tensor")
        self.assert_error("foreign.bsdf: not a material", "info", "foreign.bsdf")
        self.write("cut.bsdf", b"tensor_file\0\1\0")
        self.assert_error("cut.bsdf", "verify", "cut.bsdf")

    def test_what_stands_in_the_place_of_a_file_is_called_by_its_name(self):
        pull = "x.y: a Git LFS pointer; fetch the file with git lfs pull"
        speos = "x.y: a Speos surface file, a format that is not read; name "
        kinds = ((b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 3\n", pull),
                 (b"<!DOCTYPE html><html>404</html>", "x.y: an HTML page; fetch the file itself"),
                 (b"OPTIS - brdf surface file v8.0\n", speos),
                 (b"PK\x03\x04x", "x.y: a ZIP archive; unpack it"),
                 (b"\x1f\x8b\x08x", "x.y: compressed by gzip; unpack it with gunzip"),
                 (b"", "x.y: empty; fetch the file again"))
        scene = b"""<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="40"/>
                    <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/></film>
                    </sensor>%s</scene>"""
        self.write("mesh.xml", scene % b"<shape type='obj'><string name='filename' value='x.y'/></shape>")
        self.write("ply.xml", scene % b"<shape type='ply'><string name='filename' value='x.y'/></shape>")
        self.write("sky.xml", scene % b"<emitter type='envmap'><string name='filename' value='x.y'/></emitter>")
        for content, expected in kinds:
            self.write("x.y", content)
            for args in (("info", "x.y"), ("info", "0.5*x.y"), ("info", "x.y#linear"), ("list", "x.y"),
                         ("bake", "x.y", "-o", "b"), ("image-compare", "x.y", "x.y"),
                         ("render", "mesh.xml", "-o", "p.exr"), ("render", "ply.xml", "-o", "p.exr"),
                         ("render", "sky.xml", "-o", "p.exr"), ("render", "x.y", "-o", "p.exr")):
                self.assert_error(expected.split("; name")[0], *args)
        self.write("x.y", b"v 0 0 0\nv 1 0 0\nl 1 2\n")
        self.assert_error("x.y: an OBJ mesh without faces", "render", "mesh.xml", "-o", "p.exr")
        self.write("x.y", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n")
        self.assert_error("x.y: a PLY mesh without faces", "render", "ply.xml", "-o", "p.exr")
        (self.folder / "folder").mkdir()
        for name in ("folder", "./folder", "folder#linear"):
            self.assert_error("folder: is a directory; name a file inside it", "info", name)
        self.assert_error("folder: is a directory", "render", "folder", "-o", "p.exr")
        self.assert_error("folder: is a directory", "image-compare", "folder", "folder")

    def test_outputs(self):
        self.assert_error("no such folder", "build", "lambert", "-o", "nowhere/l.rfl")
        self.assert_error("is a folder", "build", "lambert", "-o", ".")
        self.assert_error("nowhere/l.csv", "sample", "lambert", "-o", "nowhere/l.csv")
        self.write("file", b"")
        self.assert_error("the folder cannot be made", "demo", "lambert", "-o", "file")

    def test_samplers(self):
        self.run_program("build", "lambert", "-o", "l.rfl")
        file = (self.folder / "l.rfl").read_bytes()
        self.write("cut.rfl", file[:len(file) // 2])
        self.assert_error("checksum", "info", "cut.rfl")
        flipped = bytearray(file)
        flipped[len(file) // 2] ^= 1
        self.write("flipped.rfl", flipped)
        self.assert_error("checksum", "sample", "flipped.rfl")
        self.write("other.rfl", with_material(file, "lambert:rho=0.6"))
        self.assert_error("built for another BRDF", "info", "other.rfl")
        self.write("lost.rfl", with_material(file, "lost.bsdf"))
        self.assert_error("lost.bsdf: no such file", "draw", "lost.rfl", "-o", "a.svg")
        self.assert_error("options of building", "info", "l.rfl", "--trials", "2")
        self.assert_error("is a sampler", "bake", "l.rfl", "-o", "l.binary")
        self.assert_error("is a sampler already", "build", "l.rfl", "-o", "m.rfl")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()),
                         ["cut.rfl", "flipped.rfl", "l.rfl", "lost.rfl", "other.rfl"])

    def test_a_copy_with_the_same_material_is_accepted(self):
        # The twin of "other" and "lost": it is the material that is refused there.
        self.run_program("build", "lambert", "-o", "l.rfl")
        file = (self.folder / "l.rfl").read_bytes()
        self.write("same.rfl", with_material(file, "lambert:rho=0.5"))
        self.run_program("info", "same.rfl")

    def test_the_demo_finds_typing_errors_first(self):
        self.assert_error("did you mean", "demo", "lambert", "gggx")
        self.assertFalse((self.folder / "reflectree-demo").exists())


if __name__ == "__main__":
    unittest.main()
