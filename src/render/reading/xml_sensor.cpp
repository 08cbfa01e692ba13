// SPDX-License-Identifier: Apache-2.0
#include "xml_sensor.hpp"

#include <algorithm>

namespace reflectree::render {

namespace {

constexpr double radian = pi_v<double> / 180;

void read_filter(const XmlReader& xml, Node n, Filter& filter) {
  const std::string type = n ? XmlReader::type(n) : "gaussian";
  using Kind = Filter::Kind;
  if (type == "box") {
    xml.only(n, {"radius"});
    filter = {Kind::box, float(xml.property(n, "radius", .5))};
  } else if (type == "tent") {
    xml.only(n, {"radius"});
    filter = {Kind::tent, float(xml.property(n, "radius", 1))};
  } else if (type == "gaussian") {
    xml.only(n, {"stddev"});
    filter = {Kind::gaussian, float(xml.property(n, "stddev", .5))};
  } else {
    xml.unknown(n);
  }
  if (!(filter.width > 0)) xml.fail(n, "the filter has no width", "make it positive");
}

// A film's word that changes no pixel of ours, unless it asks for another file than we write.
void want(const XmlReader& xml, Node film, const char* name, Names words) {
  const std::string word = xml.word(film, name, std::string(*words.begin()));
  if (std::find(words.begin(), words.end(), word) == words.end())
    xml.fail(XmlReader::named(film, name), "no " + std::string(name) + " '" + word + "'",
             "write " + std::string(*words.begin()));
}

void read_film(const XmlReader& xml, Node n, Scene& scene) {
  if (XmlReader::type(n) != "hdrfilm") xml.unknown(n);
  xml.only(n, {"width", "height", "rfilter", "pixel_format", "file_format", "component_format", "banner",
               "compensate", "sample_border"});
  want(xml, n, "pixel_format", {"rgb", "rgba"});
  want(xml, n, "file_format", {"openexr", "exr"});
  want(xml, n, "component_format", {"float32", "float16"});
  xml.flag(n, "banner", false), xml.flag(n, "compensate", false);
  for (const char* word : {"pixel_format", "file_format", "component_format", "banner", "compensate"})
    xml.idle(XmlReader::named(n, word));
  read_filter(xml, xml.child(n, "rfilter"), scene.filter);
  scene.filter.beyond = xml.flag(n, "sample_border", false);
  const int width = xml.integer(n, "width", 768), height = xml.integer(n, "height", 576);
  if (!(width >= 1 && height >= 1 && width <= 65536 && height <= 65536))
    xml.fail(n, "a film without pixels", "give it a positive width and height");
  scene.width = width, scene.height = height;
}

void read_points(const XmlReader& xml, Node n, Scene& scene) {
  if (!n) return;
  const auto points = points_of(XmlReader::type(n));
  if (!points) xml.unknown(n);
  xml.only(n, {"sample_count", "seed", "jitter"});
  xml.integer(n, "seed", 0);  // the command's counts
  if (!xml.flag(n, "jitter", true))
    xml.fail(XmlReader::named(n, "jitter"), "points without jitter are not drawn here", "write true");
  for (const char* word : {"seed", "jitter"}) xml.idle(XmlReader::named(n, word));
  scene.points.kind = *points;
  scene.samples = xml.integer(n, "sample_count", 16);
  if (!(scene.samples >= 1)) xml.fail(n, "sample_count is not positive", "give a positive number");
}

// Half the picture's width at distance 1. Mitsuba's default is a lens of 50 mm before a film of 36 by 24,
// whose diagonal the picture's own is to fill.
double tangent(const XmlReader& xml, Node n, double aspect) {
  const double over_diagonal = 1 / std::sqrt(1 + 1 / (aspect * aspect));  // width over diagonal
  const Node fov = XmlReader::named(n, "fov"), length = XmlReader::named(n, "focal_length"),
             axis = XmlReader::named(n, "fov_axis");
  if (fov && length) xml.fail(length, "both 'fov' and 'focal_length'", "keep one of the two");
  if (axis && !fov) xml.fail(axis, "'fov_axis' without 'fov'", "add 'fov'");
  if (!fov) {
    std::string mm = xml.word(n, "focal_length", "50mm");
    if (mm.size() > 2 && mm.substr(mm.size() - 2) == "mm") mm.resize(mm.size() - 2);
    const auto v = xml.numbers(length ? length : n, mm);
    if (v.size() != 1 || !(v[0] > 0))
      xml.fail(length, "no focal length '" + mm + "'", "write 50mm, for example");
    return std::hypot(36., 24.) / (2 * v[0]) * over_diagonal;
  }
  const double degrees = xml.property(n, "fov", 0), t = std::tan(degrees / 2 * radian);
  if (!(degrees > 0 && degrees < 180)) xml.fail(fov, "fov is not between 0 and 180 degrees", "mend it");
  const std::string along = xml.word(n, "fov_axis", "x");
  if (along == "diagonal") return t * over_diagonal;
  if (along != "x" && along != "y" && along != "smaller" && along != "larger")
    xml.fail(axis, "no fov_axis '" + along + "'", "use x, y, diagonal, smaller or larger");
  const bool vertical =
      along == "y" || (along == "smaller" && aspect > 1) || (along == "larger" && aspect <= 1);
  return vertical ? t * aspect : t;
}

}  // namespace

void read_sensor(const XmlReader& xml, Node n, Scene& scene) {
  if (XmlReader::type(n) != "perspective") xml.unknown(n);
  xml.only(n, {"fov", "fov_axis", "focal_length", "near_clip", "far_clip", "focus_distance", "shutter_open",
               "shutter_close", "to_world", "principal_point_offset_x", "principal_point_offset_y", "sampler",
               "film"});
  const Node film = xml.child(n, "film");
  if (!film) xml.fail(n, "a sensor without a film", "add an hdrfilm");
  scene.width = scene.height = 1;
  xml.attempt([&] { return read_film(xml, film, scene), true; }, false);
  xml.attempt([&] { return read_points(xml, xml.child(n, "sampler"), scene), true; }, false);
  for (const char* word :
       {"focus_distance", "shutter_open", "shutter_close"}) {  // a pinhole, and nothing moves
    xml.property(n, word, 0);
    xml.idle(XmlReader::named(n, word));
  }
  const double aspect = double(scene.width) / scene.height, t = tangent(xml, n, aspect);
  const Matrix m = xml.transform(XmlReader::named(n, "to_world"));
  const LocalFrame<float> frame = xml.rotation(n, "to_world");
  Camera& c = scene.camera;
  c = {apply(m, {}, 1), frame.s, frame.t, frame.n, float(t), float(t / aspect)};
  c.shift_x = float(xml.property(n, "principal_point_offset_x", 0));
  c.shift_y = float(xml.property(n, "principal_point_offset_y", 0));
  c.near = float(xml.property(n, "near_clip", 1e-2)), c.far = float(xml.property(n, "far_clip", 1e4));
  if (!(c.near > 0 && c.far > c.near))
    xml.fail(n, "clips that are not 0 < near_clip < far_clip", "mend near_clip and far_clip");
}

}  // namespace reflectree::render
