// SPDX-License-Identifier: Apache-2.0
// Small files of every kind that is read, made in memory from formulas: tests hold no measured data.
#pragma once

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "reflectree/brdf/models/neural_brdf.hpp"
#include "reflectree/formats/bytes.hpp"

namespace reflectree::synthetic {

struct Field {
  std::string name;
  std::uint8_t type;
  std::vector<std::uint64_t> shape;
  Bytes data;
};

inline void append_u16(Bytes& out, unsigned v) {
  out.push_back(std::uint8_t(v & 0xffU));
  out.push_back(std::uint8_t(v >> 8U));
}

inline Bytes tensor_file(const std::vector<Field>& fields) {
  std::uint64_t offset = 18;
  for (const Field& f : fields) offset += 2 + f.name.size() + 2 + 1 + 8 + 8 * f.shape.size();
  Bytes out;
  append_text(out, std::string_view("tensor_file\0\x01\x00", 14));
  append_u32(out, std::uint32_t(fields.size()));
  for (const Field& f : fields) {
    append_u16(out, unsigned(f.name.size()));
    append_text(out, f.name);
    append_u16(out, unsigned(f.shape.size()));
    out.push_back(f.type);
    append_u64(out, offset);
    for (const std::uint64_t n : f.shape) append_u64(out, n);
    offset += f.data.size();
  }
  for (const Field& f : fields) out.insert(out.end(), f.data.begin(), f.data.end());
  return out;
}

inline Field floats(const std::string& name, std::vector<std::uint64_t> shape,
                    const std::vector<float>& values) {
  Field field{name, 10, std::move(shape), {}};
  for (const float v : values) append_f32(field.data, v);
  return field;
}

// An isotropic RGB material; u and v lie in [0, 1], t is the index of theta_o.
struct RglRecipe {
  std::vector<float> theta_o{0.f, 0.5f, 1.1f, 1.5707964f};
  std::function<float(float u)> sigma = [](float u) { return 1 - 0.8f * u; };
  std::function<float(float u)> ndf = [](float u) { return 0.3f + 2 * (1 - u); };
  std::function<float(int t, float u, float v)> vndf = [](int t, float u, float v) {
    return 1 + 0.3f * float(t) * u + std::cos(6.2831853f * v) * (1 - u);
  };
  std::function<float(int t, int c, float x, float y)> rgb = [](int t, int c, float x, float y) {
    return 0.2f + 0.1f * float(c) + 0.05f * float(t) * x + 0.3f * y * (1 - x);
  };
  int width = 11, height = 9, colours = 5, nodes = 8;  // of the warp, of the colours, of sigma and ndf
  bool jacobian = true;
};

inline std::vector<Field> rgl_fields(const RglRecipe& r) {
  const auto at = [](int i, int n) { return float(i) / float(n - 1); };
  const auto u64 = [](std::size_t n) { return std::uint64_t(n); };
  std::vector<float> sigma, ndf, vndf, rgb;
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i < r.nodes; ++i)
      sigma.push_back(r.sigma(at(i, r.nodes))), ndf.push_back(r.ndf(at(i, r.nodes)));
  }
  for (int t = 0; t < int(r.theta_o.size()); ++t) {
    for (int y = 0; y < r.height; ++y) {
      for (int x = 0; x < r.width; ++x) vndf.push_back(r.vndf(t, at(x, r.width), at(y, r.height)));
    }
    for (int c = 0; c < 3; ++c) {
      for (int y = 0; y < r.colours; ++y) {
        for (int x = 0; x < r.colours; ++x) rgb.push_back(r.rgb(t, c, at(x, r.colours), at(y, r.colours)));
      }
    }
  }
  const std::uint64_t n = u64(r.theta_o.size()), w = std::uint64_t(r.width), h = std::uint64_t(r.height),
                      m = std::uint64_t(r.colours), k = std::uint64_t(r.nodes);
  return {floats("phi_i", {1}, {0}),
          floats("theta_i", {n}, r.theta_o),
          floats("sigma", {2, k}, sigma),
          floats("ndf", {2, k}, ndf),
          floats("vndf", {1, n, h, w}, vndf),
          floats("rgb", {1, n, 3, m, m}, rgb),
          Field{"jacobian", 1, {1}, {std::uint8_t(r.jacobian)}}};
}

inline Bytes rgl_file(const RglRecipe& recipe = {}) { return tensor_file(rgl_fields(recipe)); }

// A material of several azimuths, or of several wavelengths; p is the index of phi_o.
struct RglWideRecipe {
  std::vector<float> phi_o, theta_o{0.f, 0.5f, 1.1f, 1.5707964f}, wavelengths;  // none: RGB
  std::function<float(float u, float v)> sigma = [](float u, float v) { return 1 - 0.7f * u + 0.1f * v; };
  std::function<float(float u, float v)> ndf = [](float u, float v) {
    return 0.3f + 2 * (1 - u) + v * (1 - v);
  };
  std::function<float(int p, int t, float u, float v)> vndf = [](int p, int t, float u, float v) {
    return 1 + 0.3f * float(t) * u + std::cos(6.2831853f * v + 0.4f * float(p)) * (1 - u);
  };
  std::function<float(int p, int t, int c, float x, float y)> colour = [](int p, int t, int c, float x,
                                                                          float y) {
    return 0.2f + 0.1f * float(c % 7) + 0.05f * float(t) * x + 0.3f * y * (1 - x) + 0.02f * float(p) * x;
  };
  int width = 11, height = 9, colours = 5, nodes = 8;
  bool jacobian = true;
};
// `count` nodes from -pi over a turn divided by `reduction`.
inline std::vector<float> azimuths(int count, int reduction) {
  std::vector<float> phi;
  const double pi_d = 3.14159265358979323846;
  for (int i = 0; i < count; ++i)
    phi.push_back(float(-pi_d + 2 * pi_d / reduction * double(i) / double(count - 1)));
  return phi;
}
inline std::vector<Field> rgl_wide_fields(const RglWideRecipe& r) {
  const auto at = [](int i, int n) { return float(i) / float(n - 1); };
  const bool spectral = !r.wavelengths.empty();
  const int channels = spectral ? int(r.wavelengths.size()) : 3;
  std::vector<float> sigma, ndf, vndf, colours;
  for (int y = 0; y < r.nodes; ++y) {
    for (int x = 0; x < r.nodes; ++x) {
      sigma.push_back(r.sigma(at(x, r.nodes), at(y, r.nodes)));
      ndf.push_back(r.ndf(at(x, r.nodes), at(y, r.nodes)));
    }
  }
  for (int p = 0; p < int(r.phi_o.size()); ++p) {
    for (int t = 0; t < int(r.theta_o.size()); ++t) {
      for (int y = 0; y < r.height; ++y) {
        for (int x = 0; x < r.width; ++x) vndf.push_back(r.vndf(p, t, at(x, r.width), at(y, r.height)));
      }
      for (int c = 0; c < channels; ++c) {
        for (int y = 0; y < r.colours; ++y) {
          for (int x = 0; x < r.colours; ++x)
            colours.push_back(r.colour(p, t, c, at(x, r.colours), at(y, r.colours)));
        }
      }
    }
  }
  const std::uint64_t n_p = r.phi_o.size(), n_t = r.theta_o.size(), w = std::uint64_t(r.width),
                      h = std::uint64_t(r.height), m = std::uint64_t(r.colours), k = std::uint64_t(r.nodes);
  std::vector<Field> fields{
      floats("phi_i", {n_p}, r.phi_o),
      floats("theta_i", {n_t}, r.theta_o),
      floats("sigma", {k, k}, sigma),
      floats("ndf", {k, k}, ndf),
      floats("vndf", {n_p, n_t, h, w}, vndf),
      floats(spectral ? "spectra" : "rgb", {n_p, n_t, std::uint64_t(channels), m, m}, colours),
      Field{"jacobian", 1, {1}, {std::uint8_t(r.jacobian)}}};
  if (spectral) fields.push_back(floats("wavelengths", {r.wavelengths.size()}, r.wavelengths));
  return fields;
}
inline Bytes rgl_wide_file(const RglWideRecipe& recipe) { return tensor_file(rgl_wide_fields(recipe)); }

inline Bytes as_bytes(const std::string& text) { return {text.begin(), text.end()}; }

// A network of two materials, `one` and `two`, with weights from a small congruence.
inline std::string neural_csv() {
  std::string header = "material", rows[2] = {"one", "two"};
  const std::size_t sizes[] = {NeuralBrdf::inputs, NeuralBrdf::hidden, NeuralBrdf::hidden,
                               NeuralBrdf::outputs};
  unsigned state = 1;
  const auto add = [&](const std::string& name) {
    header += "," + name;
    for (std::string& row : rows) {
      state = state * 1664525U + 1013904223U;
      row += "," + std::to_string(float(state >> 8U) / 16777216.f * 0.4f - 0.15f);
    }
  };
  for (std::size_t layer = 1; layer <= 3; ++layer) {
    const std::string l = std::to_string(layer) + "_";
    for (std::size_t i = 0; i < sizes[layer - 1]; ++i) {
      for (std::size_t j = 0; j < sizes[layer]; ++j)
        add("w" + l + std::to_string(i) + "_" + std::to_string(j));
    }
    for (std::size_t j = 0; j < sizes[layer]; ++j) add("b" + l + std::to_string(j));
  }
  return header + "\n" + rows[0] + "\n" + rows[1] + "\n";
}

// One material of each fitted model; the constant c of the first channel overflows a float.
inline std::string sgd_csv() {
  return "material,kd_r,kd_g,kd_b,ks_r,ks_g,ks_b,alpha_r,alpha_g,alpha_b,p_r,p_g,p_b,F0_r,F0_g,F0_b,F1_r,F1_"
         "g,F1_b,"
         "kap_r,kap_g,kap_b,lambda_r,lambda_g,lambda_b,c_r,c_g,c_b,k_r,k_g,k_b,theta0_r,theta0_g,theta0_b\n"
         "varnish,0.05,0.03,0.02,0.04,0.6,0.3,0.015,0.03,0.05,0.46,0.45,0.53,0.9,0.25,0.6,0.1,0.2,0.5,"
         "46,25,15,2.6,3,2.8,1e49,1.1e-07,5e-08,250,36,32,0.2,0.07,-0.07\r\n";
}
inline std::string abc_csv() {
  return "material,kd_r,kd_g,kd_b,A_r,A_g,A_b,B,C,ior\nbronze,0.025,0.022,0.016,51.7,37.9,27.4,10482.13,0."
         "8167,2.2365\n";
}

// A Zemax .bsdf of angles in degrees; value(curve, rotation, incidence, azimuth, radial) in radians.
struct ZemaxRecipe {
  std::string symmetry = "Asymmetrical4D", content = "Monochrome", type = "BRDF";
  std::vector<double> rotation{0, 120, 240, 360}, incidence{10, 50}, azimuth{0, 90, 180, 270, 360},
      radial{0, 20, 60, 100};
  std::function<double(int c, double r, double i, double a, double s)> value = [](int c, double r, double i,
                                                                                  double a, double s) {
    return 0.3 + 0.1 * c + 0.1 * std::cos(r) + 0.05 * std::sin(a + i) * std::sin(s);
  };
};
inline std::string zemax_text(const ZemaxRecipe& r) {
  constexpr double degree = 3.14159265358979323846 / 180;
  char number[32];
  const auto printed = [&number](double v) {
    std::snprintf(number, sizeof number, "%.9g", v);
    return std::string(number);
  };
  const auto list = [&](const char* name, const std::vector<double>& angles) {
    std::string text = std::string(name) + "\t" + std::to_string(angles.size()) + "\r\n";
    for (const double a : angles) text += printed(a) + "\t";
    return text + "\r\n";
  };
  std::string text = "# made by a test\r\nSource\tMeasured\r\nSymmetry\t" + r.symmetry +
                     "\r\nSpectralContent  " + r.content + "\r\nScatterType " + r.type + "\r\n" +
                     list("SampleRotation", r.rotation) + list("AngleOfIncidence", r.incidence) +
                     list("ScatterAzimuth", r.azimuth) + list("ScatterRadial", r.radial) + "\r\n";
  const bool xyz = r.content == "XYZ";
  for (int c = 0; c < (xyz ? 3 : 1); ++c) {
    text += (xyz ? std::string("Tristimulus") + "XYZ"[c] : "Monochrome") + "\r\nDataBegin\r\n";
    for (const double rotation : r.rotation) {
      for (const double incidence : r.incidence) {
        text += "TIS\t0.5\r\n";
        for (const double azimuth : r.azimuth) {
          for (const double radial : r.radial)
            text += printed(r.value(c, rotation * degree, incidence * degree, azimuth * degree,
                                    radial * degree)) +
                    "\t";
          text += "\r\n";
        }
      }
    }
    text += "DataEnd\r\n";
  }
  return text;
}
inline Bytes zemax_file(const ZemaxRecipe& recipe = {}) { return as_bytes(zemax_text(recipe)); }

// A BSDF XML of one basis; value(wavelength, front, in, out) in sr^-1.
struct KlemsRecipe {
  std::string structure = "Columns", basis = "LBNL/Test";
  bool defined = true;  // the basis in the file
  std::vector<double> theta{0, 20, 60, 90};
  std::vector<int> patches{1, 4, 6};
  std::vector<std::string> wavelengths{"Visible"},
      directions{"Transmission Front", "Reflection Back", "Reflection Front"};
  std::function<double(int w, bool front, int in, int out)> value = [](int w, bool front, int in, int out) {
    return 0.01 * w + (front ? 0.1 : 0.2) + 0.001 * in + 0.0001 * out;
  };
};
inline std::string klems_xml(const KlemsRecipe& r) {
  int size = 0;
  for (const int n : r.patches) size += n;
  std::string text =
      "Recover using: a command\n<?xml version=\"1.0\"?>\n<!-- by a <test> -->\n<WindowElement xmlns='x'>\n"
      "<Optical><Layer>\n<Material><Name>cloth &amp; paint</Name><Thickness unit=\"Meter\"/></Material>\n"
      "<DataDefinition><IncidentDataStructure>" +
      r.structure + "</IncidentDataStructure>\n";
  if (r.defined) {
    text += "<AngleBasis><AngleBasisName>" + r.basis + "</AngleBasisName>\n";
    for (std::size_t i = 0; i < r.patches.size(); ++i) {
      text += "<AngleBasisBlock><Theta>0</Theta><nPhis>" + std::to_string(r.patches[i]) +
              "</nPhis><ThetaBounds><LowerTheta>" + std::to_string(r.theta[i]) + "</LowerTheta><UpperTheta>" +
              std::to_string(r.theta[i + 1]) + "</UpperTheta></ThetaBounds></AngleBasisBlock>\n";
    }
    text += "</AngleBasis>\n";
  }
  text += "</DataDefinition>\n";
  for (std::size_t w = 0; w < r.wavelengths.size(); ++w) {
    text += "<WavelengthData><Wavelength unit=\"Integral\">" + r.wavelengths[w] + "</Wavelength>\n";
    for (const std::string& direction : r.directions) {
      text += "<WavelengthDataBlock><WavelengthDataDirection>" + direction +
              "</WavelengthDataDirection><ColumnAngleBasis>" + r.basis +
              "</ColumnAngleBasis><RowAngleBasis>" + r.basis + "</RowAngleBasis>\n<ScatteringData>\n";
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          const bool rows = r.structure == "Rows", front = direction.ends_with("Front");
          const double v = r.value(int(w), front, rows ? row : column, rows ? column : row);
          text += std::to_string(v) + (row % 2 ? ", " : "\t");
        }
        text += "\n";
      }
      text += "</ScatteringData></WavelengthDataBlock>\n";
    }
    text += "</WavelengthData>\n";
  }
  return text + "</Layer></Optical></WindowElement>\n";
}
inline Bytes klems_file(const KlemsRecipe& recipe = {}) { return as_bytes(klems_xml(recipe)); }

}  // namespace reflectree::synthetic
