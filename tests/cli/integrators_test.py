# SPDX-License-Identifier: Apache-2.0
"""Every integrator and point set by the command line: pictures that agree, the same when stopped and resumed."""
import unittest

from program import ProgramTest

SCENE = b"""<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="4"/></integrator>
<sensor type="perspective"><float name="fov" value="60"/>
<transform name="to_world"><lookat origin="0, -3, 1" target="0, 0, 0.8" up="0, 0, 1"/></transform>
<film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/><rfilter type="box"/></film>
</sensor>
<shape type="rectangle"><transform name="to_world"><scale value="2"/></transform>
<bsdf type="reflectree"><string name="material" value="ggx:alpha=0.4,f0=0.7 + 0.2*lambert"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate x="1" angle="90"/>
<translate y="1.5"/></transform><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
<shape type="disk"><transform name="to_world"><rotate x="1" angle="180"/><translate z="3"/></transform>
<emitter type="area"><rgb name="radiance" value="5"/></emitter></shape></scene>"""


class Integrators(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.xml", SCENE)

    def render(self, name, *options):
        self.run_program("render", self.scene, "-o", name, *options)
        self.assertTrue((self.folder / name).with_suffix(".png").exists())
        return (self.folder / (name + ".sums")).read_bytes()

    def means(self, name):
        found = self.json_of("image-compare", name, "path.exr")["channels"]
        return [(c["mean_a"], c["mean_b"], c["mean_error"]) for c in found]

    def test_they_agree(self):
        self.render("path.exr", "--spp", 256)
        for spp, options in ((16, ["recursive", "--split", 8]), (48, ["photons", "--radius", 0.1, "--photons", 3000]),
                             (48, ["photons", "--radius", 0.1, "--photons", 3000, "--adjoint", "one-shot",
                                   "--no-gather"]),
                             (256, ["path", "--points", "stratified"]), (256, ["path", "--points", "sobol"])):
            self.render("other.exr", "--spp", spp, "--seed", 2, "--integrator", *options)
            for a, b, error in self.means("other.exr"):
                self.assertLess(abs(a - b), 6 * error + 0.01 * b, options)
                self.assertGreater(abs(1.2 * a - b), 6 * error + 0.01 * b, f"{options}: a planted bias of 20 %")

    def test_direct_light_alone_is_darker(self):
        self.render("path.exr", "--spp", 64)
        for technique in ("balance", "resampled"):
            self.render("direct.exr", "--spp", 64, "--integrator", "direct", "--technique", technique)
            for a, b, error in self.means("direct.exr"):
                self.assertLess(a, b - 6 * error, technique)

    def test_resumed_is_uninterrupted(self):
        for options in (["--integrator", "photons"], ["--integrator", "recursive", "--points", "sobol"]):
            whole = self.render("whole.exr", "--spp", 12, *options)
            # Strata follow from the first render's samples; Sobol' points and photons do not ask.
            self.render("parts.exr", "--spp", 5, *options)
            self.assertNotEqual(self.render("parts.exr", "--spp", 9, "--resume", *options), whole)
            parts = self.render("parts.exr", "--spp", 12, "--resume", *options)
            self.assertEqual(parts[-8 * 6 * 24 * 16:], whole[-8 * 6 * 24 * 16:], options)

    def test_what_does_not_go_together_is_said(self):
        for options, words in ((["--technique", "resampled"], "--integrator direct"),
                               (["--integrator", "photons", "--technique", "light"], "balance or power"),
                               (["--integrator", "guessing"], "guessing")):
            _, said = self.run_program("render", self.scene, *options, code=2)
            self.assertIn(words, said)


if __name__ == "__main__":
    unittest.main()
