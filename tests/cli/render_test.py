# SPDX-License-Identifier: Apache-2.0
"""What surrounds a render: where its time goes, whose film it goes on with, how different two pictures look."""
import pathlib
import sys
import unittest

from program import ProgramTest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "words"))
from pixels import exr, png  # noqa: E402

SCENE = """<scene version="3.0.0"><default name="grey" value="0.5"/><integrator type="path"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0, -3, 1" target="0, 0, 0.8" up="0, 0, 1"/>
</transform><film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/></film></sensor>
<emitter type="constant"/><shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="$grey"/></bsdf>
</shape><shape type="sphere"><float name="radius" value="0.5"/></shape></scene>"""


class Render(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.xml", SCENE.encode())

    def test_profile_shares_the_time_out(self):
        # A fifth as a rule; of ninety rings the share was once 0.06, of four times as many it is steady.
        found = self.json_of("render", self.scene, "--spp", 4096, "--profile")
        self.assertGreater(found["timer_rings"], 10)
        self.assertGreater(found["traversal"], 0.1)
        self.assertAlmostEqual(sum(found[k] for k in ("traversal", "sample", "eval", "rest")), 1, places=6)

    def test_profile_books_every_integrator(self):
        # Drawing directions exactly is what takes longest here; lights alone are a twentieth.
        glossy = self.write("glossy.xml", SCENE.replace("diffuse", "reflectree").replace(
            '<rgb name="reflectance" value="$grey"/>', '<string name="material" value="ggx:alpha=0.3"/>').encode())
        for options in (["recursive", "--technique", "brdf", "--spp", 192], ["photons", "--radius", 0.1, "--spp", 384],
                        ["direct", "--technique", "resampled", "--spp", 384]):
            found = self.json_of("render", glossy, "--sampler", "exact", "--profile", "--integrator", *options)
            self.assertGreater(found["timer_rings"], 20)
            self.assertGreater(found["sample"], 0.15, f"{options}: {found}")

    def test_a_film_goes_on_with_its_own_scene_alone(self):
        self.run_program("render", self.scene, "--spp", 2)
        self.run_program("render", self.scene, "--spp", 4, "--resume")
        for options in (["-D", "grey=0.4"], ["--technique", "power"], ["--seed", 2], ["--integrator", "recursive"]):
            _, said = self.run_program("render", self.scene, "--spp", 6, "--resume", *options, code=2)
            self.assertIn("another scene", said, options)

    def test_a_name_that_the_scene_does_not_say_is_an_error(self):
        _, said = self.run_program("render", self.scene, "--spp", 1, "-D", "gray=0.4", code=2)
        self.assertIn("the scene does not say $gray", said)

    def test_comparing_a_png_compares_light(self):
        # 128 of 255 is .2159 in linear light.
        self.write("a.png", png([[(128, 128, 128)] * 8] * 8))
        self.write("b.exr", exr([[(.2159, .2159, .2159)] * 8] * 8, "RGB"))
        for channel in self.json_of("image-compare", "a.png", "b.exr")["channels"]:
            self.assertAlmostEqual(channel["mean_a"], .2159, places=4)
            self.assertAlmostEqual(channel["mean_a"] / channel["mean_b"], 1, places=3)

    def test_flip(self):
        self.run_program("render", self.scene, "--spp", 4, "-o", "a.exr")
        self.run_program("render", self.scene, "--spp", 4, "-o", "b.exr", "-D", "grey=0.2")
        self.assertEqual(self.json_of("image-compare", "a.exr", "a.exr")["flip"], 0)
        exr = self.json_of("image-compare", "b.exr", "a.exr", "--flip", "seen.png")["flip"]
        self.assertGreater(exr, 0.01)
        self.assertTrue((self.folder / "seen.png").exists())
        png = self.json_of("image-compare", "b.png", "a.png")["flip"]
        self.assertAlmostEqual(png, exr, delta=0.02)


if __name__ == "__main__":
    unittest.main()
