#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The guards' twins: each planted fault must be caught, and a clean file must not be."""
import pathlib
import sys
import tempfile
import unittest

import house_rules
import layers
import links
import site_pages

TREE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TREE / "docs/site"))
import cpp_comments  # noqa: E402

TOP = "// SPDX-License-Identifier: Apache-2.0\n#pragma once\n"


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.plant("include/reflectree/math/scalar.hpp", "#include <cmath>\n")
        self.plant("include/reflectree/brdf/value.hpp", '#include "reflectree/math/scalar.hpp"\n')
        self.plant("src/picture/png.cpp", '#include <png.h>\n#include "reflectree/brdf/value.hpp"\n')

    def tearDown(self):
        self.folder.cleanup()

    def plant(self, path: str, text: str, top: str = TOP):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(top + text, encoding="utf-8")

    def assert_caught(self, guard, words: str):
        found = guard(self.root)
        self.assertEqual(len(found), 1, found)
        self.assertIn(words, found[0])

    def test_clean_tree_passes(self):
        self.assertEqual(layers.broken_arrows(self.root), [])
        self.assertEqual(house_rules.broken_rules(self.root), [])

    def test_upward_include(self):
        self.plant("include/reflectree/math/frame.hpp", '#include "reflectree/brdf/value.hpp"\n')
        self.assert_caught(layers.broken_arrows, "math may not see brdf")

    def test_upward_include_in_a_source(self):
        self.plant("src/sampler/build/build.cpp", '  #  include "reflectree/formats/sampler_file.hpp"\n')
        self.assert_caught(layers.broken_arrows, "sampler may not see formats")

    def test_sideways_include_at_the_rim(self):
        self.plant("src/verify/furnace.cpp", '#include "reflectree/draw/page.hpp"\n')
        self.assert_caught(layers.broken_arrows, "verify may not see draw")

    def test_small_rooms_beside_each_other(self):
        self.plant("include/reflectree/sampler/known/albedo.hpp", '#include "reflectree/sampler/square/tree.hpp"\n')
        self.assert_caught(layers.broken_arrows, "sampler/known may not see sampler/square")

    def test_samplers_do_not_see_the_builder(self):
        self.plant("src/sampler/build/leaf.hpp", "")
        self.plant("src/sampler/pack.cpp", '#include "build/leaf.hpp"\n')
        self.assert_caught(layers.broken_arrows, "sampler/ may not see sampler/build")

    def test_library_in_the_core(self):
        self.plant("src/brdf/material/registry.cpp", "#include <fmt/core.h>\n")
        self.assert_caught(layers.broken_arrows, "standard library alone")

    def test_private_header_of_another_room(self):
        self.plant("src/math/secret.hpp", "")
        self.plant("src/sampler/build/build.cpp", '#include "../../math/secret.hpp"\n')
        self.assert_caught(layers.broken_arrows, "reaches into another folder")

    def test_private_header_of_the_room(self):
        self.plant("src/verify/parallel.hpp", "")
        self.plant("src/verify/doctor/light.cpp", '#include "parallel.hpp"\n')
        self.assertEqual(layers.broken_arrows(self.root), [])
        self.plant("src/verify/doctor/light.cpp", '#include "serial.hpp"\n')
        self.assert_caught(layers.broken_arrows, "nor in its room")

    def test_embree_elsewhere(self):
        self.plant("src/render/film/film.cpp", "#include <embree3/rtcore.h>\n")
        self.assert_caught(layers.broken_arrows, "embree_scene alone")

    def test_unknown_room(self):
        self.plant("src/cellar/box.cpp", "")
        self.assert_caught(layers.broken_arrows, "no room is called cellar")

    def test_missing_spdx(self):
        self.plant("src/math/map.cpp", "int x;\n", top="")
        self.assert_caught(house_rules.broken_rules, "SPDX")

    def test_header_without_pragma(self):
        self.plant("src/math/map.hpp", "int x;\n", top=TOP.split("\n")[0] + "\n")
        self.assert_caught(house_rules.broken_rules, "#pragma once")

    def test_left_for_later(self):
        self.plant("src/math/map.cpp", "// TO" + "DO: the inverse\n")
        self.assert_caught(house_rules.broken_rules, "left for later")

    def test_absolute_path(self):
        self.plant("src/formats/data.cpp", 'const char* folder = "/' + 'home/someone/data";\n')
        self.assert_caught(house_rules.broken_rules, "absolute path")


class DeadEnds(unittest.TestCase):
    """links.py over a small tree of documents."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.plant("src/math/map.cpp", "int the_map;\n")
        self.plant("README.md", "# A\n\n[Pages](docs/page.md) and [`docs`](docs).\n\n    [code](is/left/alone)\n")
        self.plant("docs/page.md", "# A page\n\n## The *one* place\n\n`src/math/{map}.cpp`, `src/NAME.cpp`, "
                   "[source](../src/math/map.cpp), [above](#a-page), [elsewhere](https://example.org)\n")
        self.ask("[README](../README.md) → [page](page.md) → [map.cpp](../src/math/map.cpp) `the_map`")

    def tearDown(self):
        self.folder.cleanup()

    def plant(self, path: str, text: str):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def ask(self, path: str):
        sound = "Path: [README](../README.md) → [page](page.md#the-one-place)\n\n"
        questions = "".join(f"## Question {i}?\n\n{sound}" for i in range(links.QUESTIONS))
        self.plant("docs/questions.md", f"# Questions\n\n{questions}## Where?\n\nPath: {path}\n")

    def assert_caught(self, words: str):
        found = links.dead_ends(self.root)
        self.assertEqual(len(found), 1, found)
        self.assertIn(words, found[0])

    def test_clean_tree_passes(self):
        self.assertEqual(links.dead_ends(self.root), [])

    def test_dead_link(self):
        self.plant("docs/other.md", "[gone](gone.md)\n")
        self.assert_caught("docs/other.md:1: the link (gone.md) leads nowhere")

    def test_dead_anchor(self):
        self.plant("docs/other.md", "[gone](page.md#another-place)\n")
        self.assert_caught("names no heading")

    def test_dead_path_in_backticks(self):
        self.plant("docs/other.md", "See `src/math/gone.cpp`.\n")
        self.assert_caught("there is no src/math/gone.cpp")

    def test_dead_header_named_from_a_room(self):
        self.plant("docs/other.md", "See `math/gone.hpp`.\n")
        self.assert_caught("there is no math/gone.hpp")

    def test_dead_path_in_a_comment(self):
        self.plant("src/math/map.cpp", "int the_map;  // the inverse: math/map.cpp, map.cpp, NAME.hpp\n")
        self.assertEqual(links.dead_ends(self.root), [])
        self.plant("src/math/map.cpp", "int the_map;  // the inverse: gone/map.cpp\n")
        self.assert_caught("src/math/map.cpp:1: there is no gone/map.cpp")
        self.plant("src/math/map.cpp", "int the_map;\n// The inverse is in gone.hpp.\n")
        self.assert_caught("src/math/map.cpp:2: there is no gone.hpp")

    def test_dead_header_in_code(self):
        self.plant("docs/other.md", "As in\n\n    #include \"reflectree/math/gone.hpp\"\n")
        self.assert_caught("docs/other.md:3: there is no include/reflectree/math/gone.hpp")

    def test_step_that_is_not_linked(self):
        self.ask("[README](../README.md) → [map.cpp](../src/math/map.cpp)")
        self.assert_caught("README.md does not link to src/math/map.cpp")

    def test_path_that_begins_elsewhere(self):
        self.ask("[page](page.md) → [map.cpp](../src/math/map.cpp)")
        self.assert_caught("does not begin at README.md")

    def test_path_of_four_steps(self):
        self.plant("docs/other.md", "[page](page.md)\n")
        self.plant("docs/page.md", "# A page\n\n## The *one* place\n\n[source](../src/math/map.cpp), "
                   "[other](other.md)\n")
        self.ask("[README](../README.md) → [page](page.md) → [other](other.md) → [page](page.md) → "
                 "[map.cpp](../src/math/map.cpp)")
        self.assert_caught("4 steps from README")

    def test_word_that_is_not_there(self):
        self.ask("[README](../README.md) → [page](page.md) → [map.cpp](../src/math/map.cpp) `another_map`")
        self.assert_caught("`another_map` does not stand in src/math/map.cpp")

    def test_question_without_a_path(self):
        self.plant("docs/questions.md", (self.root / "docs/questions.md").read_text() + "\n## And where else?\n")
        self.assert_caught("no path answers 'And where else?'")


class SitePages(unittest.TestCase):
    PAGE = '<html><body><h1 id="top">A</h1><a href="other.html#end">b</a> <a href="https://example.org">c</a>%s</body></html>'

    def faults(self, more: str) -> list[str]:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "page.html").write_text(self.PAGE % more, encoding="utf-8")
            (root / "other.html").write_text('<html><body><p id="end">d</p></body></html>', encoding="utf-8")
            return site_pages.faults_of(root)

    def test_a_sound_site(self):
        self.assertEqual(self.faults('<a href="#top">e</a><img src="data:image/png;base64,AA==">'), [])

    def test_faults(self):
        for more, words in (('<a href="gone.html">x</a>', "gone.html leads nowhere"),
                            ('<a href="other.html#middle">x</a>', "has no such anchor"),
                            ('<a href="#bottom">x</a>', "has no such anchor"),
                            ('<script src="https://example.org/x.js"></script>', "from the network"),
                            ('<img src="gone.png">', "gone.png leads nowhere")):
            found = self.faults(more)
            self.assertEqual(len(found), 1, found)
            self.assertIn(words, found[0])

    def test_no_page_is_a_fault(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(len(site_pages.faults_of(pathlib.Path(folder))), 1)


class CppComments(unittest.TestCase):
    """What Doxygen gets to read; the lines are those of the header."""

    HEADER = """// SPDX-License-Identifier: Apache-2.0
// Boxes, with a *true* `a < b`:
//   open(box)   twice
#pragma once

#include <vector>  // nothing

namespace reflectree {  // nothing

// Not of a declaration.

class Later;  // later.hpp

// A box.
template <class T>
class Box {
 public:
  // Its
  // width.
  float width() const {
    // A remark.
    return width_;  // another
  }
  enum class Kind { open };  // how

 private:
  float width_ = 1'000.f;  // radians;
                           // never 0
};

// clang-format off
template <class F> concept Open = requires(const F& f) {
  f.open();  // nothing
};
// clang-format on

// Of two.
float wider(const Box<float>& a,  // nothing
            const Box<float>& b);

}  // namespace reflectree
"""
    EXPECTED = r"""/// \file
/// Boxes, with a <em>true</em> <code>a \< b</code>:
/// <pre>   open(box)   twice</pre>
#pragma once

#include <vector>  // nothing

namespace reflectree {  // nothing

// Not of a declaration.

class Later;  // later.hpp

/// \brief \copybrief box.hpp \details \copydetails box.hpp \n A box.
template <class T>
class Box {
 public:
  /// Its
  /// width.
  float width() const {
    // A remark.
    return width_;  // another
  }
  enum class Kind { open };  ///< how

/** \cond */  private:
  float width_ = 1'000.f;  ///< radians;
                           ///< never 0
/** \endcond */ };

// clang-format off
template <class F> concept Open = requires(const F& f) {
  f.open();  // nothing
};
// clang-format on

/// Of two.
float wider(const Box<float>& a,  // nothing
            const Box<float>& b);

}  // namespace reflectree
"""

    def test_what_doxygen_reads(self):
        self.assertEqual(cpp_comments.filtered(self.HEADER, pathlib.Path("box.hpp")).split("\n"), self.EXPECTED.split("\n"))

    def test_lines_stay(self):
        for header in sorted((TREE / "include").rglob("*.hpp")):
            text = header.read_text(encoding="utf-8")
            seen = cpp_comments.filtered(text, header)
            self.assertEqual(seen.count("\n"), text.count("\n"), header)
            self.assertEqual(seen.count("\\cond"), seen.count("\\endcond"), header)


if __name__ == "__main__":
    unittest.main()
