// SPDX-License-Identifier: Apache-2.0
// A sampler that `reflectree doctor --exec build/bin/example_doctor_client` judges: a cosine lobe on a
// surface that returns half of the light, in binary. Put your own three functions in; nothing of Reflectree
// is needed. docs/doctor.md has the protocol.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <vector>

constexpr double pi = 3.14159265358979323846;
bool faulty = false;  // forgets the cosine in the pdf, to see it found

// sr^-1, without cosine.
double eval(const double* wo, const double* wi) { return wo[2] > 0 && wi[2] > 0 ? 0.5 / pi : 0; }
double pdf(const double* wo, const double* wi) {  // per solid angle
  return wo[2] > 0 && wi[2] > 0 ? (faulty ? 1 : wi[2]) / pi : 0;
}
// wi, pdf, weight f cos / pdf; zeros where there is none.
void sample(const double* wo, std::mt19937_64& random, double* out) {
  std::uniform_real_distribution<double> u;
  const double r2 = u(random), phi = 2 * pi * u(random), r = std::sqrt(r2);
  const double wi[] = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r2)};
  std::copy_n(wi, 3, out);
  out[3] = pdf(wo, wi);
  out[4] = out[3] > 0 ? eval(wo, wi) * wi[2] / out[3] : 0;
}

int main(int argc, char** argv) {
  faulty = argc > 1 && std::strcmp(argv[1], "--faulty") == 0;
  std::printf("reflectree-doctor 1 name=cosine channels=1 eval=f sample=weight format=binary\n");
  std::fflush(stdout);
  char line[256];
  while (std::fgets(line, sizeof line, stdin)) {
    char word[16] = "";
    unsigned long long rows = 0, seed = 0;
    if (std::sscanf(line, "%15s %llu %llu", word, &rows, &seed) < 2) return 0;  // quit
    const bool samples = std::string(word) == "sample", evaluates = std::string(word) == "eval";
    const std::size_t columns_in = samples ? 3 : 6, columns_out = samples ? 5 : 1;
    std::vector<double> in(rows * columns_in), out(rows * columns_out);
    if (std::fread(in.data(), sizeof(double), in.size(), stdin) != in.size()) return 1;
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < rows; ++i) {
      const double* wo = in.data() + i * columns_in;
      if (samples) sample(wo, random, out.data() + i * columns_out);
      if (!samples) out[i] = evaluates ? eval(wo, wo + 3) : pdf(wo, wo + 3);
    }
    std::fwrite(out.data(), sizeof(double), out.size(), stdout);
    std::fflush(stdout);
  }
}
