// SPDX-License-Identifier: Apache-2.0
// Mitsuba 3's XML: what is known is read, everything else is an Error with line and column.
#include <algorithm>
#include <filesystem>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "xml_sensor.hpp"
#include "xml_shapes.hpp"

namespace reflectree::render {

namespace {

class SceneReader {
 public:
  SceneReader(const XmlReader& xml, const Host& host)
      : xml_(xml), materials_(xml, host), shapes_(xml, materials_, scene_) {}

  Scene read(const std::string& path) {
    scene_.max_depth = -1;  // what Mitsuba does without an integrator
    xml_.attempt([&] { return xml_.child(xml_.root(), "integrator"); }, Node());
    bool seen = false;
    for (const Node n : xml_.root().children()) {
      if (n.type() != pugi::node_element) continue;
      const bool first_sensor = n.name() == std::string_view("sensor") && !seen;
      seen = seen || first_sensor;
      xml_.attempt([&] { return read_part(n, first_sensor), true; }, false);
    }
    if (volumes_ && materials_.lets_pass() && shines_from_a_point())
      xml_.attempt(
          [&]() -> bool {
            xml_.fail(volumes_, "lamps of a point or a direction do not shine through masks and panes here",
                      "write type=\"path\", which shows the same in Mitsuba");
          },
          false);
    const auto mirrors = [](const Surface& s) {
      return s.scattering && s.scattering->lobes() != Lobes::finite;
    };
    if (lights_alone_ && std::any_of(scene_.surfaces.begin(), scene_.surfaces.end(), mirrors))
      xml_.attempt(
          [&]() -> bool {
            xml_.fail(lights_alone_,
                      "mirrors, glass and masks without a direction of their own are not drawn here",
                      "write bsdf_samples 1 or more");
          },
          false);
    xml_.throw_problems();
    if (!seen) throw Error("no <sensor>", path, "add a perspective sensor");
    if (const std::string words = xml_.idle_words(); !words.empty())
      scene_.notes.push_back(path + ": " + words);
    if (light_samples_ > 1 && shines_from_a_point())
      scene_.notes.push_back(path + ": lamps of a point or a direction count once here, and in Mitsuba " +
                             std::to_string(light_samples_) + " times, once for each of their samples");
    return std::move(scene_);
  }

 private:
  bool shines_from_a_point() const {
    return !(scene_.point_lights.empty() && scene_.spot_lights.empty() && scene_.directional_lights.empty());
  }

  // The first sensor takes the picture, as in Mitsuba.
  void read_part(Node n, bool first_sensor) {
    const std::string_view tag = n.name();
    if (tag == "integrator")
      read_integrator(n);
    else if (tag == "sensor")
      first_sensor ? read_sensor(xml_, n, scene_) : void();
    else if (tag == "shape")
      shapes_.read(n);
    else if (tag == "emitter")
      read_emitter(n);
    else if (tag != "default" && tag != "alias" && tag != "bsdf" && tag != "texture" && tag != "sampler" &&
             tag != "film" && tag != "rfilter")  // read where they are named
      xml_.fail(n, "<" + std::string(tag) + "> is not known here", "leave it out");
  }

  void read_integrator(Node n) {
    const std::string type = XmlReader::type(n);
    if (type == "moment" || type == "aov") return read_around(n);
    // Without a medium, which is refused where it stands, Mitsuba's volume integrators are path tracers.
    const bool in_volumes = type == "volpath" || type == "volpathmis";
    if (in_volumes) volumes_ = n;
    const auto method = in_volumes ? Transport::Method::path : method_of(type);
    if (!method) xml_.unknown(n);
    Transport& t = scene_.transport;
    t.method = *method;
    scene_.hide_lamps = xml_.flag(n, "hide_emitters", false);
    if (t.method == Transport::Method::direct) {
      return read_direct(n);
    }
    if (t.method == Transport::Method::photons) {
      xml_.only(n, {"max_depth", "rr_depth", "split", "photon_count", "radius", "alpha", "final_gather",
                    "hide_emitters"});
      t.photons.count = xml_.integer(n, "photon_count", 0);
      t.photons.radius = float(xml_.property(n, "radius", 0));
      t.photons.shrink = float(xml_.property(n, "alpha", 2 / 3.));
      t.photons.gather = xml_.flag(n, "final_gather", true);
    } else if (t.method == Transport::Method::path) {
      xml_.only(n, {"max_depth", "rr_depth", "hide_emitters"});
    } else {
      xml_.only(n, {"max_depth", "rr_depth", "split", "hide_emitters"});
    }
    t.split = xml_.integer(n, "split", 0);
    scene_.max_depth = xml_.integer(n, "max_depth", -1);
    scene_.rr_depth = xml_.integer(n, "rr_depth", 5);
    if (scene_.rr_depth < 1) xml_.fail(n, "rr_depth is not positive", "write 1 or more");
  }

  // Without directions of the surface's own, lamps are found by light alone, and without such of lamps by the
  // surface alone; how many there are of both tells of noise, not of light.
  void read_direct(Node n) {
    xml_.only(n, {"shading_samples", "emitter_samples", "bsdf_samples", "hide_emitters"});
    Transport& t = scene_.transport;
    const Node own = XmlReader::named(n, "bsdf_samples"), lights = XmlReader::named(n, "emitter_samples");
    if ((own || lights) && XmlReader::named(n, "shading_samples"))
      xml_.fail(n, "both shading_samples and one of emitter_samples and bsdf_samples", "leave the first out");
    const int both = xml_.integer(n, "shading_samples", 1),
              of_lights = xml_.integer(n, "emitter_samples", both),
              of_surface = xml_.integer(n, "bsdf_samples", both);
    if (!(of_lights >= 0 && of_surface >= 0 && of_lights + of_surface > 0))
      xml_.fail(n, "numbers of samples that are negative or all 0", "write 1 or more");
    light_samples_ = of_lights;
    if (own || lights || XmlReader::named(n, "shading_samples")) t.split = std::max(of_lights, of_surface);
    if (of_lights == 0) t.technique = Technique::surface;
    if (of_surface == 0) t.technique = Technique::light, lights_alone_ = own;
  }

  // Further statistics about the picture of the integrator inside, which is all that is computed.
  void read_around(Node n) {
    xml_.only(n, {"integrator", "aovs"});
    xml_.idle(XmlReader::named(n, "aovs"));
    const Node inner = xml_.child(n, "integrator");
    if (!inner) xml_.fail(n, "no integrator inside, and nothing else has a picture here", "put one there");
    read_integrator(inner);
  }

  void set_environment(Node n, Environment e) {
    if (scene_.environment) xml_.fail(n, "a second environment", "keep one of the two");
    scene_.environment = std::move(e);
  }

  // A light is placed by its transform or by this, not by both.
  void either(Node n, const char* name) const {
    if (XmlReader::named(n, name) && XmlReader::named(n, "to_world"))
      xml_.fail(n, "both '" + std::string(name) + "' and 'to_world'", "keep one of the two");
  }

  void read_emitter(Node n) {
    const std::string type = XmlReader::type(n);
    const Rgb white{1, 1, 1};
    const Matrix m = xml_.transform(XmlReader::named(n, "to_world"));
    if (type == "area" && n.attribute("id")) return;  // reached through references
    if (type == "constant") {
      xml_.only(n, {"radiance"});
      set_environment(n, Environment(xml_.colour(n, "radiance", white, ColourOf::light)));
    } else if (type == "envmap") {
      xml_.only(n, {"filename", "scale", "to_world"});
      const LocalFrame<float> frame = xml_.rotation(n, "to_world");
      const std::string file = xml_.file(n);
      const float scale = float(xml_.property(n, "scale", 1));
      if (!(scale >= 0)) xml_.fail(n, "the sky's scale is negative", "write a number from 0 on");
      xml_.placed(n, [&] { set_environment(n, {rgb_of(read_image(file), file), frame, scale, file}); });
    } else if (type == "point") {
      xml_.only(n, {"position", "intensity", "to_world"});
      either(n, "position");
      const auto place = apply_double(m, xml_.point(n, "position", {}), 1);
      if (!within_reach(place)) xml_.fail(n, "the light is beyond 1e15", "use larger units");
      scene_.point_lights.push_back({to_float(place), xml_.colour(n, "intensity", white, ColourOf::light)});
    } else if (type == "spot") {
      xml_.only(n, {"intensity", "texture", "cutoff_angle", "beam_width", "to_world"});
      const double cutoff = xml_.property(n, "cutoff_angle", 20),
                   beam = xml_.property(n, "beam_width", .75 * cutoff);
      if (!(cutoff > 0 && cutoff < 90 && beam >= 0 && beam <= cutoff))
        xml_.fail(n, "angles that are not 0 <= beam_width <= cutoff_angle < 90", "mend them");
      const auto radians = [](double degrees) { return float(degrees * pi_v<double> / 180); };
      scene_.spot_lights.push_back({apply(m, {}, 1), xml_.rotation(n, "to_world"),
                                    xml_.colour(n, "intensity", white, ColourOf::light), radians(beam),
                                    radians(cutoff), materials_.emission(n, "texture")});
      if (XmlReader::named(n, "texture") && !scene_.spot_lights.back().picture)
        xml_.fail(XmlReader::named(n, "texture"), "a spot light's texture is a picture",
                  "write one colour as 'intensity'");
    } else if (type == "projector") {
      read_projector(n);
    } else if (type == "directional") {
      xml_.only(n, {"direction", "irradiance", "to_world"});
      either(n, "direction");
      const Direction d = apply(m, xml_.point(n, "direction", {0, 0, 1}), 0);
      if (!(length(d) > 0)) xml_.fail(n, "the light goes nowhere", "give it a direction");
      scene_.directional_lights.push_back(
          {normalize(d), xml_.colour(n, "irradiance", white, ColourOf::light)});
    } else {
      xml_.unknown(n);
    }
  }

  void read_projector(Node n) {
    xml_.only(n, {"irradiance", "scale", "fov", "fov_axis", "focal_length", "to_world"});
    SpotLight p{apply(xml_.transform(XmlReader::named(n, "to_world")), {}, 1),
                xml_.rotation(n, "to_world"),
                {1, 1, 1},
                0,
                0,
                materials_.emission(n, "irradiance")};
    if (!p.picture) p.intensity = xml_.colour(n, "irradiance", p.intensity, ColourOf::light);
    const double scale = xml_.property(n, "scale", 1);
    if (!(scale >= 0)) xml_.fail(n, "a negative scale", "write a number from 0 on");
    p.intensity = (pi * float(scale)) * p.intensity;
    const bool seen = p.picture && p.picture->picture;
    const double aspect = seen ? double(p.picture->picture->width) / p.picture->picture->height : 1,
                 t = half_width(xml_, n, aspect);
    p.tan_x = float(t), p.tan_y = float(t / aspect);
    p.beam = p.cutoff = float(std::atan(std::hypot(t, t / aspect)));
    scene_.spot_lights.push_back(std::move(p));
  }

  const XmlReader& xml_;
  MaterialReader materials_;
  Scene scene_;
  ShapeReader shapes_;
  Node volumes_;       // an integrator that looks for volumes
  Node lights_alone_;  // bsdf_samples, if it is 0
  int light_samples_ = 1;
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
  if (name == "stratified" || name == "multijitter" || name == "orthogonal") return Kind::stratified;
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
