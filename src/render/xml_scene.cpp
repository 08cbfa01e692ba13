// SPDX-License-Identifier: Apache-2.0
// Mitsuba 3's XML: what is known is read, everything else is an Error with line and column.
#include <filesystem>

#include "reflectree/error.hpp"
#include "reflectree/io/file.hpp"
#include "reflectree/io/file_kind.hpp"
#include "xml_shapes.hpp"

namespace reflectree::render {

namespace {

class SceneReader {
 public:
  SceneReader(const XmlReader& xml, const Host& host) : xml_(xml), materials_(xml, host) {}

  Scene read(const std::string& path) {
    for (const Node n : xml_.root().children()) {
      if (n.type() != pugi::node_element) continue;
      const std::string_view tag = n.name();
      if (tag == "integrator")
        read_integrator(n);
      else if (tag == "sensor")
        read_sensor(n);
      else if (tag == "shape")
        read_shape(xml_, materials_, n, scene_);
      else if (tag == "emitter")
        read_emitter(n);
      else if (tag != "default" && tag != "bsdf" && tag != "texture")  // those are read where they are named
        xml_.fail(n, "<" + std::string(tag) + "> is not known here", "leave it out");
    }
    if (scene_.width == 0) throw Error("no <sensor>", path, "add a perspective sensor");
    return std::move(scene_);
  }

 private:
  void read_integrator(Node n) {
    const auto method = method_of(XmlReader::type(n));
    if (!method) xml_.unknown(n);
    Transport& t = scene_.transport;
    t.method = *method;
    if (t.method == Transport::Method::direct) {
      xml_.only(n, {"shading_samples"});
      t.split = xml_.integer(n, "shading_samples", 0);
      return;
    }
    if (t.method == Transport::Method::photons) {
      xml_.only(n, {"max_depth", "rr_depth", "split", "photon_count", "radius", "alpha", "final_gather"});
      t.photons.count = xml_.integer(n, "photon_count", 0);
      t.photons.radius = float(xml_.property(n, "radius", 0));
      t.photons.shrink = float(xml_.property(n, "alpha", 2 / 3.));
      t.photons.gather = xml_.flag(n, "final_gather", true);
    } else if (t.method == Transport::Method::path) {
      xml_.only(n, {"max_depth", "rr_depth"});
    } else {
      xml_.only(n, {"max_depth", "rr_depth", "split"});
    }
    t.split = xml_.integer(n, "split", 0);
    scene_.max_depth = xml_.integer(n, "max_depth", -1);
    scene_.rr_depth = xml_.integer(n, "rr_depth", 5);
  }

  void read_filter(Node n) {
    const std::string type = n ? XmlReader::type(n) : "gaussian";
    using Kind = Filter::Kind;
    if (type == "box") {
      xml_.only(n, {"radius"});
      scene_.filter = {Kind::box, float(xml_.property(n, "radius", .5))};
    } else if (type == "tent") {
      xml_.only(n, {"radius"});
      scene_.filter = {Kind::tent, float(xml_.property(n, "radius", 1))};
    } else if (type == "gaussian") {
      xml_.only(n, {"stddev"});
      scene_.filter = {Kind::gaussian, float(xml_.property(n, "stddev", .5))};
    } else {
      xml_.unknown(n);
    }
    if (!(scene_.filter.width > 0)) xml_.fail(n, "the filter has no width", "make it positive");
  }

  void read_sensor(Node n) {
    if (XmlReader::type(n) != "perspective") xml_.unknown(n);
    xml_.only(n,
              {"fov", "fov_axis", "near_clip", "far_clip", "focus_distance", "to_world", "sampler", "film"});
    const Node film = n.child("film"), sampler = n.child("sampler");
    if (!film) xml_.fail(n, "a sensor without a film", "add an hdrfilm");
    if (XmlReader::type(film) != "hdrfilm") xml_.unknown(film);
    if (sampler) {
      const auto points = points_of(XmlReader::type(sampler));
      if (!points) xml_.unknown(sampler);
      xml_.only(sampler, {"sample_count", "seed"});  // the seed is the command's
      scene_.points.kind = *points;
    }
    xml_.only(film, {"width", "height", "rfilter", "pixel_format"});
    read_filter(film.child("rfilter"));
    const double width = xml_.property(film, "width", 768), height = xml_.property(film, "height", 576);
    const double samples = xml_.property(sampler, "sample_count", 16);
    if (!(width >= 1 && height >= 1 && width <= 65536 && height <= 65536))
      xml_.fail(film, "a film without pixels", "give it a positive width and height");
    if (!(samples >= 1 && samples <= 1e9))
      xml_.fail(sampler, "sample_count is not positive", "give a positive number");
    scene_.width = int(width), scene_.height = int(height), scene_.samples = int(samples);
    read_camera(n, width, height);
  }

  void read_camera(Node n, double width, double height) {
    const std::string along = xml_.word(n, "fov_axis", "x");
    if (along != "x" && along != "y" && along != "smaller" && along != "larger")
      xml_.fail(n, "no fov_axis '" + along + "'", "use x, y, smaller or larger");
    const bool vertical =
        along == "y" || (along == "smaller" && height < width) || (along == "larger" && height > width);
    const float t = float(std::tan(xml_.property(n, "fov", 50) * pi_v<double> / 360)),
                aspect = float(width / height);
    const Matrix m = xml_.transform(XmlReader::named(n, "to_world"));
    const auto axis = [&](Vec3<double> v) { return normalize(apply(m, v, 0)); };
    scene_.camera = {apply(m, {}, 1), axis({1, 0, 0}),           axis({0, 1, 0}),
                     axis({0, 0, 1}), vertical ? t * aspect : t, vertical ? t : t / aspect};
  }

  void set_environment(Node n, Environment e) {
    if (scene_.environment) xml_.fail(n, "a second environment", "keep one of the two");
    scene_.environment = std::move(e);
  }

  void read_emitter(Node n) {
    const std::string type = XmlReader::type(n);
    const Rgb white{1, 1, 1};
    const Matrix m = xml_.transform(XmlReader::named(n, "to_world"));
    if (type == "area" && n.attribute("id")) return;  // reached through references
    if (type == "constant") {
      xml_.only(n, {"radiance"});
      set_environment(n, Environment(xml_.colour(n, "radiance", white, false)));
    } else if (type == "envmap") {
      xml_.only(n, {"filename", "scale", "to_world"});
      const auto axis = [&](Vec3<double> v) { return normalize(apply(m, v, 0)); };
      const std::string file = xml_.beside(xml_.word(n, "filename", ""));
      set_environment(n, Environment(read_image(file), {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})},
                                     float(xml_.property(n, "scale", 1)), file));
    } else if (type == "point") {
      xml_.only(n, {"position", "intensity", "to_world"});
      const auto place = apply_double(m, xml_.point(n, "position", {}), 1);
      if (!within_reach(place)) xml_.fail(n, "the light is beyond 1e15", "use larger units");
      scene_.point_lights.push_back({to_float(place), xml_.colour(n, "intensity", white, false)});
    } else if (type == "directional") {
      xml_.only(n, {"direction", "irradiance", "to_world"});
      const Direction d = apply(m, xml_.point(n, "direction", {0, 0, 1}), 0);
      if (!(length(d) > 0)) xml_.fail(n, "the light goes nowhere", "give it a direction");
      scene_.directional_lights.push_back({normalize(d), xml_.colour(n, "irradiance", white, false)});
    } else {
      xml_.unknown(n);
    }
  }

  const XmlReader& xml_;
  MaterialReader materials_;
  Scene scene_;
};

}  // namespace

std::optional<Transport::Method> method_of(std::string_view name) {
  using Method = Transport::Method;
  if (name == "path") return Method::path;
  if (name == "direct") return Method::direct;
  if (name == "recursive") return Method::recursive;
  if (name == "photons") return Method::photons;
  return std::nullopt;
}

std::optional<PointSet::Kind> points_of(std::string_view name) {
  using Kind = PointSet::Kind;
  if (name == "independent") return Kind::independent;
  if (name == "stratified") return Kind::stratified;
  if (name == "sobol" || name == "ldsampler") return Kind::sobol;
  return std::nullopt;
}

Scene parse_scene(std::string_view xml, const std::string& path, const SceneOptions& options,
                  const Host& host) {
  const XmlReader reader(xml, path, options);
  Scene scene = SceneReader(reader, host).read(path);
  scene.identity = reader.fingerprint();
  return scene;
}

Scene load_scene(const std::string& path, const SceneOptions& options, const Host& host) {
  const Bytes bytes = read_file(path, std::uint64_t(1) << 26U);
  if (!recognise_file(bytes).may_be_scene) refuse_recognised(bytes, path, "name a Mitsuba 3 scene");
  return parse_scene(std::string(bytes.begin(), bytes.end()), path, options, host);
}

}  // namespace reflectree::render
