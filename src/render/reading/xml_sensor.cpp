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

// The film's whole picture, of which the scene's is a window with its left upper corner at (x, y).
struct Whole {
  int width = 1, height = 1, x = 0, y = 0;
};

Whole read_film(const XmlReader& xml, Node n, Scene& scene) {
  if (XmlReader::type(n) != "hdrfilm") xml.unknown(n);
  xml.only(n,
           {"width", "height", "rfilter", "ref", "pixel_format", "file_format", "component_format", "banner",
            "compensate", "sample_border", "crop_width", "crop_height", "crop_offset_x", "crop_offset_y"});
  xml.refer_to(n, {"rfilter"});
  want(xml, n, "pixel_format", {"rgb", "rgba"});
  want(xml, n, "file_format", {"openexr", "exr"});
  want(xml, n, "component_format", {"float32", "float16"});
  xml.flag(n, "banner", false), xml.flag(n, "compensate", false);
  for (const char* word : {"pixel_format", "file_format", "component_format", "banner", "compensate"})
    xml.idle(XmlReader::named(n, word));
  read_filter(xml, xml.part(n, "rfilter"), scene.filter);
  scene.filter.beyond = xml.flag(n, "sample_border", false);
  const int width = xml.integer(n, "width", 768), height = xml.integer(n, "height", 576);
  if (!(width >= 1 && height >= 1 && width <= 65536 && height <= 65536))
    xml.fail(n, "a film without pixels", "give it a positive width and height");
  scene.width = xml.integer(n, "crop_width", width), scene.height = xml.integer(n, "crop_height", height);
  const int x = xml.integer(n, "crop_offset_x", 0), y = xml.integer(n, "crop_offset_y", 0);
  if (!(scene.width >= 1 && scene.height >= 1 && x >= 0 && y >= 0 && scene.width <= width - x &&
        scene.height <= height - y)) {
    scene.width = scene.height = 1;
    xml.fail(n, "a crop window that is not inside of the film", "mend crop_offset_x, crop_width, ...");
  }
  return {width, height, x, y};
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

}  // namespace

// Mitsuba's default is a lens of 50 mm before a film of 36 by 24, whose diagonal the picture's own is to fill.
double half_width(const XmlReader& xml, Node n, double aspect) {
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

namespace {

// The window's share of what the whole picture shows, as a picture of its own.
void crop(Camera& c, const Whole& whole, const Scene& scene) {
  const auto along = [](float& tangent, float& shift, int begin, int size, int all) {
    const double share = double(size) / all;
    tangent = float(share * double(tangent));
    shift = float((share - 1) / (2 * share) + (double(begin) / all + double(shift)) / share);
  };
  if (scene.width != whole.width) along(c.tan_x, c.shift_x, whole.x, scene.width, whole.width);
  if (scene.height != whole.height) along(c.tan_y, c.shift_y, whole.y, scene.height, whole.height);
}

// Parallel rays from a square, or what the transform makes of it, whose width is the picture's; the clips
// begin at the near one, which the transform scales as well.
void place_parallel(const XmlReader& xml, Node n, double aspect, Camera& c) {
  const Matrix m = xml.transform(XmlReader::named(n, "to_world"));
  const Direction along = apply(m, {0, 0, 1}, 0);
  const float scale = length(along);
  if (!(scale > 0)) xml.fail(XmlReader::named(n, "to_world"), "a camera that looks nowhere", "mend it");
  const float between = c.far - c.near;
  c.origin = apply(m, {}, 1), c.forward = (1 / scale) * along;
  c.left = apply(m, {1, 0, 0}, 0), c.up = apply(m, {0, 1, 0}, 0);
  c.tan_x = 1, c.tan_y = float(1 / aspect), c.parallel = true;
  c.near = scale * c.near, c.far = c.near + between;
}

}  // namespace

void read_sensor(const XmlReader& xml, Node n, Scene& scene) {
  const std::string type = XmlReader::type(n);
  const bool lens = type == "thinlens", parallel = type == "orthographic";
  if (type == "perspective")
    xml.only(n, {"fov", "fov_axis", "focal_length", "near_clip", "far_clip", "focus_distance", "shutter_open",
                 "shutter_close", "to_world", "principal_point_offset_x", "principal_point_offset_y",
                 "sampler", "film", "ref"});
  else if (lens)
    xml.only(n, {"fov", "fov_axis", "focal_length", "near_clip", "far_clip", "focus_distance",
                 "aperture_radius", "shutter_open", "shutter_close", "to_world", "sampler", "film", "ref"});
  else if (parallel)
    xml.only(n, {"near_clip", "far_clip", "focus_distance", "shutter_open", "shutter_close", "to_world",
                 "sampler", "film", "ref"});
  else
    xml.unknown(n);
  xml.refer_to(n, {"sampler", "film"});
  const Node film = xml.part(n, "film");
  if (!film) xml.fail(n, "a sensor without a film", "add an hdrfilm");
  scene.width = scene.height = 1;
  const Whole whole = xml.attempt([&] { return read_film(xml, film, scene); }, Whole{});
  xml.attempt([&] { return read_points(xml, xml.part(n, "sampler"), scene), true; }, false);
  for (const char* word : {"focus_distance", "shutter_open", "shutter_close"}) {  // nothing moves
    xml.property(n, word, 0);
    if (!lens || word != std::string_view("focus_distance")) xml.idle(XmlReader::named(n, word));
  }
  const double aspect = double(whole.width) / whole.height;
  Camera& c = scene.camera;
  c = {};
  c.near = float(xml.property(n, "near_clip", 1e-2)), c.far = float(xml.property(n, "far_clip", 1e4));
  if (!(c.near > 0 && c.far > c.near))
    xml.fail(n, "clips that are not 0 < near_clip < far_clip", "mend near_clip and far_clip");
  if (parallel) {
    place_parallel(xml, n, aspect, c);
    return crop(c, whole, scene);
  }
  const double t = half_width(xml, n, aspect);
  const LocalFrame<float> frame = xml.rotation(n, "to_world");
  c.origin = apply(xml.transform(XmlReader::named(n, "to_world")), {}, 1);
  c.left = frame.s, c.up = frame.t, c.forward = frame.n, c.tan_x = float(t), c.tan_y = float(t / aspect);
  c.shift_x = float(xml.property(n, "principal_point_offset_x", 0));
  c.shift_y = float(xml.property(n, "principal_point_offset_y", 0));
  if (lens) {
    if (!XmlReader::named(n, "aperture_radius"))
      xml.fail(n, "a lens without 'aperture_radius'", "add it, or write perspective");
    c.lens = float(xml.property(n, "aperture_radius", 0));
    c.focus = std::min(float(xml.property(n, "focus_distance", double(c.far))), float(largest_coordinate));
    if (!(c.lens >= 0 && c.lens <= float(largest_coordinate) && c.focus > 0))
      xml.fail(n, "a lens that is not aperture_radius >= 0 and focus_distance > 0", "mend the two");
  }
  crop(c, whole, scene);
}

}  // namespace reflectree::render
