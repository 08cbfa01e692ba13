# SPDX-License-Identifier: Apache-2.0
"""One small scene for each word of Mitsuba's XML, or for one way in which pixels, numbers and texture coordinates
enter. rows_*.py hold them; words_test.py renders them by ours and compares with Mitsuba's stored numbers, which
bench/mitsuba/words.py makes anew."""
import dataclasses
import math

PI = repr(math.pi)


@dataclasses.dataclass
class Row:
    group: str
    word: str             # what is tried
    scene: str
    files: dict = dataclasses.field(default_factory=dict)
    error: str = ""       # a part of the sentence with which ours refuses it; its line is then checked as well
    why: str = ""         # where ours differs on purpose
    like: str = ""        # then: the row whose numbers ours has
    slack: float = .004   # relative, beside the noise
    spp: int = 256


def scene(body, width=8, height=8, sensor='<float name="fov" value="90"/>', film="", integrator=None, rfilter="box",
          sampler="independent"):
    if integrator is None:
        integrator = '<integrator type="path"><integer name="max_depth" value="4"/></integrator>'
    rfilter = f'<rfilter type="{rfilter}"/>' if rfilter and "<" not in rfilter else rfilter
    return f"""<scene version="3.0.0">
{integrator}
<sensor type="perspective">
{sensor}
<film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/>
{film}{rfilter}</film>
<sampler type="{sampler}"><integer name="sample_count" value="16"/></sampler>
</sensor>
{body}
</scene>
"""


# What faces the camera of `scene` and fills its picture: u to the left, since the camera looks along +z.
FACING = '<transform name="to_world"><rotate y="1" angle="180"/><translate z="1"/></transform>'
HEADLIGHT = f'<emitter type="directional"><vector name="direction" x="0" y="0" z="1"/><rgb name="irradiance" value="{PI}"/></emitter>'
WHITE_SKY = '<emitter type="constant"/>'


def wall(bsdf, light=HEADLIGHT, **more):
    return scene(f'<shape type="rectangle">{FACING}\n{bsdf}\n</shape>\n{light}', **more)


def diffuse(inside):
    return f'<bsdf type="diffuse">{inside}</bsdf>'


def bitmap(file, more="", name="reflectance"):
    return (f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>\n{more}</texture>')


def picture(file, data, more=""):
    """A wall that shows a picture."""
    return wall(diffuse(bitmap(file, more))), {file: data}


def sky(file, data, more="", sensor='<float name="fov" value="100"/>', **others):
    return scene(f'<emitter type="envmap"><string name="filename" value="{file}"/>\n{more}</emitter>', sensor=sensor,
                 **others), {file: data}
