// SPDX-License-Identifier: Apache-2.0
#include "hard_functions_list.hpp"

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree::study {

namespace {

constexpr float degree = pi / 180;

Direction mirror(Direction wo) { return {-wo.x, -wo.y, wo.z}; }
float distance2(Direction a, Direction b) {
  const Direction d = a - b;
  return dot(d, d);
}
float gauss(Direction a, Direction b, float width) { return std::exp(-distance2(a, b) / (width * width)); }

// wi turned so that wo has azimuth 0: what an isotropic function may depend on.
Direction beside(Direction wo, Direction wi) {
  const float s = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const float c = s > 0 ? wo.x / s : 1, t = s > 0 ? wo.y / s : 0;
  return {wi.x * c + wi.y * t, wi.y * c - wi.x * t, wi.z};
}
float azimuth_between(Direction wo, Direction wi) {
  const Direction w = beside(wo, wi);
  return std::atan2(w.y, w.x);
}
float angle_to(Direction a, Direction b) {
  return 2 * std::asin(min(0.5f * std::sqrt(distance2(a, b)), 1.f));
}

// A needle that stands at a fixed place beside wo, on a ground.
struct Needle {
  float theta, phi, width, height, ground;
  Direction centre() const { return direction_from_angles(theta, phi); }
  float operator()(Direction wo, Direction wi) const {
    return ground + height * gauss(beside(wo, wi), centre(), width);
  }
};
// The same, which says where it is sharp.
struct DeclaredNeedle : Needle {
  BrdfTraits traits() const {
    BrdfTraits t;
    t.name = "needle that tells";
    t.sharp = [n = Needle(*this)](Direction) { return std::vector<SharpLobe>{{n.centre(), n.width}}; };
    return t;
  }
};

float phong(Direction o, Direction i, float n) {
  const float r = max(0.f, o.z * i.z - o.x * i.x - o.y * i.y);
  return (n + 1) / (2 * pi) * std::pow(r, n) / max(o.z, i.z);
}

float clamped_ross_li(Direction o, Direction i) {
  const float so = std::sqrt(max(0.f, 1 - o.z * o.z)), si = std::sqrt(max(0.f, 1 - i.z * i.z));
  const float cp = so > 0 && si > 0 ? clamp((o.x * i.x + o.y * i.y) / (so * si), -1.f, 1.f) : 1.f;
  const float cx = clamp(o.z * i.z + so * si * cp, -1.f, 1.f), sx = std::sqrt(max(0.f, 1 - cx * cx));
  const float volume = ((pi / 2 - std::acos(cx)) * cx + sx) / (i.z + o.z) - pi / 4;
  const float to = so / o.z, ti = si / i.z, sec = 1 / o.z + 1 / i.z;
  const float d2 = max(0.f, to * to + ti * ti - 2 * to * ti * cp) + to * ti * (to * ti) * (1 - cp * cp);
  const float ct = clamp(2 * std::sqrt(d2) / sec, -1.f, 1.f), t = std::acos(ct);
  const float shade = (t - std::sin(t) * ct) * sec / pi - sec + 0.5f * (1 + cx) / (o.z * i.z);
  return max(0.f, (0.1f + 0.05f * volume + 0.03f * shade) / pi);
}

struct FiftyLobes {
  struct Lobe {
    Direction centre;
    float width, height;
  };
  std::vector<Lobe> lobes;
  FiftyLobes() {
    Pcg32 u(50);
    for (int k = 0; k < 50; ++k) {
      const float theta = 1.3f * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
      const float width = 0.03f + 0.1f * to_unit_float(u());
      lobes.push_back({direction_from_angles(theta, phi), width, 0.02f / (width * width)});
    }
  }
  float operator()(Direction wo, Direction wi) const {
    const Direction w = beside(wo, wi);
    float sum = 0.02f;
    for (const Lobe& lobe : lobes) sum += lobe.height * gauss(w, lobe.centre, lobe.width);
    return sum;
  }
};

template <int channels>
Spectrum coloured(Direction wo, Direction wi) {
  Spectrum s(channels);
  for (int c = 0; c < channels; ++c) s[c] = 0.1f + float(c) / channels * gauss(wi, mirror(wo), 0.2f);
  return s;
}

bool odd(float x) { return (int(std::floor(x)) & 1) != 0; }

template <class F>
HardFunction of(const char* name, const char* what, F f) {
  return {name, what, [f] { return AnyBrdf(f); }};
}
template <class F>
HardFunction refused(const char* name, const char* what, F f) {
  return {name, what, [f] { return AnyBrdf(f); }, true};
}
HardFunction near(HardFunction f, std::function<Direction(Direction)> centre) {
  f.centre = std::move(centre);
  return f;
}

void add_smooth(std::vector<HardFunction>& list) {
  list.push_back(of("constant", "0.3", [](Direction, Direction) { return 0.3f; }));
  list.push_back(
      of("seeliger", "0.3 / (cos_o + cos_i)", [](Direction o, Direction i) { return 0.3f / (o.z + i.z); }));
  list.push_back(of("ggx", "GGX 0.1, for comparison", Ggx{0.1f}));
  list.push_back(of("abg", "A / (B + |beta - beta_0|^g), g = 2.3", [](Direction o, Direction i) {
    const float b = std::hypot(i.x + o.x, i.y + o.y);
    return 1e-3f / (1e-5f + std::pow(b, 2.3f));
  }));
  list.push_back(
      of("hapke surge", "opposition surge of width 0.01 on lunar dust", [](Direction o, Direction i) {
        const float g = angle_to(o, i);
        return 0.1f / (o.z + i.z) * (1 + 1 / (1 + std::tan(0.5f * min(g, 3.1f)) / 0.01f));
      }));
  list.push_back(of("fifty lobes", "50 Gaussian lobes of width 0.03 to 0.13 beside wo", FiftyLobes()));
  list.push_back(
      of("grating", "orders of a grating: cos^8 of 20 times the slope", [](Direction o, Direction i) {
        const Direction w = beside(o, i);
        const float c = std::cos(20 * (w.x + std::sqrt(max(0.f, 1 - o.z * o.z))));
        return 0.05f + c * c * c * c * c * c * c * c;
      }));
  list.push_back(of("ross-li", "Ross-Thick Li-Sparse, clamped at 0", clamped_ross_li));
  list.push_back(of("minnaert", "(cos_o cos_i)^-0.5",
                    [](Direction o, Direction i) { return 0.2f / std::sqrt(o.z * i.z); }));
  list.push_back(of("phong 1975", "no cosine in the denominator's favour: (0.1 + cos^20) / cos_i",
                    [](Direction o, Direction i) {
                      const float r = max(0.f, o.z * i.z - o.x * i.x - o.y * i.y);
                      return (0.1f + std::pow(r, 20.f)) / i.z;
                    }));
}

void add_needles(std::vector<HardFunction>& list) {
  for (const float width : {0.1f, 0.01f, 0.001f}) {
    const std::string name = "mirror gauss " + std::string(width > 0.05f   ? "0.1"
                                                           : width > 5e-3f ? "0.01"
                                                                           : "0.001");
    list.push_back(of(name.c_str(), "exp(-|wi - mirror|^2 / a^2) / a^2", [width](Direction o, Direction i) {
      return 0.2f / (width * width) * gauss(i, mirror(o), width);
    }));
  }
  for (const float n : {100.f, 3000.f, 10000.f, 100000.f}) {
    list.push_back(of(("float phong " + std::to_string(int(n))).c_str(),
                      "(n + 1) / 2 pi r^n / max(cos_o, cos_i), in float",
                      [n](Direction o, Direction i) { return phong(o, i, n); }));
  }
  list.push_back(of("inverse distance", "0.1 / |wi - mirror|", [](Direction o, Direction i) {
    return 0.1f / max(std::sqrt(distance2(i, mirror(o))), 1e-7f);
  }));
  list.push_back(near(of("needle at wo", "retro-reflection of width 1e-4 on a ground",
                         [](Direction o, Direction i) { return 0.1f + 1e6f * gauss(i, o, 1e-4f); }),
                      [](Direction o) { return o; }));
  const auto at_normal = [](float ground) {
    return [ground](Direction, Direction i) {
      const float s2 = i.x * i.x + i.y * i.y;
      return ground + 1e5f * std::exp(-s2 / 1e-6f);
    };
  };
  const auto normal = [](Direction) { return Direction{0, 0, 1}; };
  list.push_back(
      near(of("needle at normal", "width 1e-3 about the normal, on a ground", at_normal(0.1f)), normal));
  list.push_back(
      near(of("needle at normal alone", "width 1e-3 about the normal, else 0", at_normal(0)), normal));
  const auto needle = [&list](const char* name, const char* what, Needle n, bool declared) {
    HardFunction f = declared ? of(name, what, DeclaredNeedle{n}) : of(name, what, n);
    f.centre = [n](Direction) { return n.centre(); };
    f.may_be_refused = !declared;
    list.push_back(std::move(f));
  };
  needle("needle beside", "width 1e-3 off the plane of incidence, on a ground",
         {0.7f, 1.9f, 1e-3f, 1e5f, 0.1f}, false);
  needle("needle beside alone", "the same, else 0", {0.7f, 1.9f, 1e-3f, 1e5f, 0}, false);
  needle("needle beside, declared", "the same on a ground, with its place told",
         {0.7f, 1.9f, 1e-3f, 1e5f, 0.1f}, true);
  needle("needle 1e-4, declared", "width 1e-4 on a ground, with its place told",
         {0.7f, 1.9f, 1e-4f, 1e7f, 0.1f}, true);
}

void add_steps(std::vector<HardFunction>& list) {
  const auto ring = [](float radius, float width) {
    return [radius, width](Direction o, Direction i) {
      return std::abs(angle_to(i, mirror(o)) - radius) < 0.5f * width ? 2.f : 0.01f;
    };
  };
  list.push_back(
      of("ring 42", "1 degree wide, 42 degrees about the mirror direction", ring(42 * degree, degree)));
  list.push_back(of("ring 0.2", "0.05 degrees wide, 0.2 degrees about the mirror direction",
                    ring(0.2f * degree, 0.05f * degree)));
  list.push_back(of("soft ring 42", "the same with a Gaussian profile", [](Direction o, Direction i) {
    return 0.01f + 2 * std::exp(-sqr((angle_to(i, mirror(o)) - 42 * degree) / (0.5f * degree)));
  }));
  for (std::size_t k = list.size() - 3; k < list.size(); ++k) list[k].may_be_refused = true;
  list.push_back(of("step in theta_i", "1 where cos_i > 0.7071, else 0",
                    [](Direction, Direction i) { return i.z > 0.7071f ? 1.f : 0.f; }));
  list.push_back(of("step in theta_o", "1 up to 30 degrees, 0.3 beyond",
                    [](Direction o, Direction) { return o.z > std::cos(30 * degree) ? 1.f : 0.3f; }));
  list.push_back(of("zero beyond 60", "0.3 up to theta_o = 60 degrees, 0 beyond",
                    [](Direction o, Direction) { return o.z > 0.5f ? 0.3f : 0.f; }));
  list.push_back(of("lobe from 50", "a mirror lobe of width 0.05 that begins at theta_o = 50 degrees",
                    [](Direction o, Direction i) {
                      return 0.1f + (o.z < std::cos(50 * degree) ? 50 * gauss(i, mirror(o), 0.05f) : 0.f);
                    }));
  list.push_back(
      of("step in theta_h", "1 inside 20 degrees of the half vector, else 0.05",
         [](Direction o, Direction i) { return normalize(o + i).z > std::cos(20 * degree) ? 1.f : 0.05f; }));
  list.push_back(of("step in theta_d", "1 where wo.wi > 0.5, else 0.2",
                    [](Direction o, Direction i) { return dot(o, i) > 0.5f ? 1.f : 0.2f; }));
  list.push_back(of("sector", "1 within 30 degrees of azimuth of the mirror direction, else 0.05",
                    [](Direction o, Direction i) {
                      return std::abs(azimuth_between(mirror(o), i)) < 30 * degree ? 1.f : 0.05f;
                    }));
  const auto checkerboard = [](float n) {
    return [n](Direction o, Direction i) {
      const bool a = odd(n * i.z), b = odd(n * (azimuth_between(o, i) + pi) / pi);
      return a != b ? 0.5f : 0.1f;
    };
  };
  list.push_back(of("checkerboard 4", "4 by 8 squares of cos_i and azimuth", checkerboard(4)));
  list.push_back(of("checkerboard 16", "16 by 32 squares of cos_i and azimuth", checkerboard(16)));
  list.push_back(of("thirty rings", "0.3 and 0.33 in turn, rings about wo", [](Direction o, Direction i) {
    return 0.3f + (odd(30 * max(dot(o, i), 0.f)) ? 0.03f : 0.f);
  }));
  list.push_back(of("cap", "1 within 3 degrees of the normal, else 0",
                    [](Direction, Direction i) { return i.z > std::cos(3 * degree) ? 1.f : 0.f; }));
}

void add_scales(std::vector<HardFunction>& list) {
  const auto scaled_lobe = [](float scale) {
    return [scale](Direction o, Direction i) {
      const float g = gauss(i, mirror(o), 0.2f);
      return Rgb{scale * (0.1f + g), scale * (0.1f + 0.5f * g), scale * 0.1f};
    };
  };
  list.push_back(of("1e-24", "an RGB lobe whose squares underflow", scaled_lobe(1e-24f)));
  list.push_back(of("1e22", "the same, whose squares overflow", scaled_lobe(1e22f)));
  list.push_back(refused("2e38", "the same near the end of float", scaled_lobe(2e38f)));
  list.push_back(refused("1e-42", "the same among the subnormal floats", scaled_lobe(1e-42f)));
  list.push_back(of("black", "0 everywhere", [](Direction, Direction) { return 0.f; }));
  list.push_back(refused("rounded below 0", "-1e-9 where it should be 0", [](Direction o, Direction i) {
    return (o.z > 0.3f && i.z < 0.4f) ? -1e-9f : 0.2f;
  }));
  list.push_back(refused("negative", "-0.1 at grazing",
                         [](Direction, Direction i) { return i.z < 0.05f ? -0.1f : 0.2f; }));
  list.push_back(refused("nan", "NaN where cos_i < 0.02", [](Direction, Direction i) {
    return i.z < 0.02f ? std::numeric_limits<float>::quiet_NaN() : 0.2f;
  }));
  list.push_back(refused("infinite", "infinite where cos_i < 0.02", [](Direction, Direction i) {
    return i.z < 0.02f ? std::numeric_limits<float>::infinity() : 0.2f;
  }));
}

void add_values(std::vector<HardFunction>& list) {
  list.push_back(of("spectrum 1", "Spectrum(1), traits left out", coloured<1>));
  list.push_back(of("spectrum 2", "Spectrum(2), traits left out", coloured<2>));
  list.push_back(of("spectrum 4", "Spectrum(4), traits left out", coloured<4>));
  list.push_back(of("spectrum 40", "40 channels", coloured<40>));
  list.push_back(
      of("double", "returns double", [](Direction o, Direction i) { return 0.3 / double(o.z + i.z); }));
  list.push_back(of("int", "returns int", [](Direction, Direction) { return 1; }));
  list.push_back(of("array", "returns std::array<double, 5>", [](Direction, Direction i) {
    return std::array<double, 5>{0.1, 0.2, 0.3, 0.1 * double(i.z), 0.5};
  }));
  list.push_back(refused("changing channels", "3 channels, 2 at grazing",
                         [](Direction, Direction i) { return Spectrum(i.z < 0.2f ? 2 : 3); }));
}

bool is_near_one_radian(Direction w, float degrees) {
  return std::abs(std::remainder(std::atan2(w.y, w.x) - 1, 2 * pi)) < degrees * degree;
}

void add_azimuths(std::vector<HardFunction>& list) {
  list.push_back(of("bright azimuth", "1.3 times brighter for wi within 3 degrees of one azimuth",
                    [](Direction, Direction i) { return is_near_one_radian(i, 3) ? 0.26f : 0.2f; }));
  list.push_back(of("bright viewers", "the same for wo",
                    [](Direction o, Direction) { return is_near_one_radian(o, 3) ? 0.26f : 0.2f; }));
  list.push_back(of("few viewers", "the same within half a degree",
                    [](Direction o, Direction) { return is_near_one_radian(o, 0.5f) ? 0.26f : 0.2f; }));
  list.push_back(of("cos 2 phi", "1.5 % of cos 2 phi", [](Direction, Direction i) {
    return 0.2f * (1 + 0.015f * std::cos(2 * std::atan2(i.y, i.x)));
  }));
  list.push_back(of("cos 16 phi", "16 periods of the viewer's azimuth", [](Direction o, Direction) {
    return 0.2f * (1 + 0.3f * std::cos(16 * std::atan2(o.y, o.x)) * (o.x * o.x + o.y * o.y));
  }));
}

void add_manners(std::vector<HardFunction>& list) {
  list.push_back(of("slow", "2 microseconds per call", [](Direction o, Direction i) {
    double sum = 0;
    for (int k = 1; k < 200; ++k) sum += std::sin(double(k) * double(i.z)) / k;
    return float(0.2 + 0.02 * sum) + gauss(i, mirror(o), 0.2f);
  }));
  list.push_back({"stateful", "grows by 1e-6 with every call",
                  [] {
                    const auto calls = std::make_shared<std::atomic<int>>(0);
                    return AnyBrdf(
                        [calls](Direction, Direction) { return 0.2f + 1e-6f * float((*calls)++); });
                  },
                  true});
  list.push_back(refused("throwing", "throws where cos_i < 0.01", [](Direction, Direction i) {
    if (i.z < 0.01f) throw std::runtime_error("no data below 0.6 degrees");
    return 0.2f;
  }));
}

}  // namespace

std::vector<HardFunction> hard_functions() {
  std::vector<HardFunction> list;
  add_smooth(list);
  add_needles(list);
  add_steps(list);
  add_scales(list);
  add_values(list);
  add_azimuths(list);
  add_manners(list);
  return list;
}

}  // namespace reflectree::study
