// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/square_maps.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

// [0, 1) -> [-1, 1).
template <class T>
Vec2<T> random_square(Pcg32& u) {
  return {T(2 * to_unit_double(u()) - 1), T(2 * to_unit_double(u()) - 1)};
}

// The values of u where maps break, as coordinates of the square: the ends, the centre, and each +- 1 ulp.
std::vector<float> hard_coordinates() {
  std::vector<float> list;
  for (const float u : {0.f, 0x1p-24f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f}) {
    const float x = 2 * u - 1;
    for (const float y : {x, std::nextafter(x, -2.f), std::nextafter(x, 2.f)}) {
      if (y >= -1 && y <= 1) list.push_back(y);
    }
  }
  return list;
}

template <class Map>
double jacobian(const Map& map, Vec2<double> p) {
  const double e = 1e-5;
  const auto a = map({p.x + e, p.y}), b = map({p.x - e, p.y}), c = map({p.x, p.y + e}),
             d = map({p.x, p.y - e});
  const double k = 0.25 / (e * e);
  if constexpr (std::is_same_v<decltype(map(p)), Vec2<double>>) {
    return k * std::abs((a.x - b.x) * (c.y - d.y) - (a.y - b.y) * (c.x - d.x));
  } else {
    return k * length(cross(a - b, c - d));
  }
}

TEST(SquareMaps, RoundTripInDouble) {
  Pcg32 u(5);
  for (int i = 0; i < 20000; ++i) {
    const auto p = random_square<double>(u);
    const auto disk = square_to_disk(p);
    const auto square = disk_to_square(disk);
    EXPECT_NEAR(square.x, p.x, 1e-14);
    EXPECT_NEAR(square.y, p.y, 1e-14);
    const auto back = hemisphere_to_disk_equal_area(disk_to_hemisphere_equal_area(disk));
    EXPECT_NEAR(back.x, disk.x, 1e-13);
    EXPECT_NEAR(back.y, disk.y, 1e-13);
    EXPECT_EQ(hemisphere_to_disk_projected(disk_to_hemisphere_projected(disk)), disk);
  }
}

TEST(SquareMaps, RoundTripInFloatEverywhere) {
  const auto hard = hard_coordinates();
  std::vector<Vec2<float>> points;
  for (const float x : hard) {
    for (const float y : hard) points.push_back({x, y});
  }
  Pcg32 u(6);
  for (int i = 0; i < 100000; ++i) points.push_back(random_square<float>(u));
  for (const auto p : points) {
    const auto disk = square_to_disk(p);
    EXPECT_LE(std::hypot(disk.x, disk.y), 1 + 3e-7f) << p.x << ' ' << p.y;
    const auto square = disk_to_square(disk);
    EXPECT_NEAR(square.x, p.x, 4e-7f) << p.x << ' ' << p.y;
    EXPECT_NEAR(square.y, p.y, 4e-7f) << p.x << ' ' << p.y;
  }
}

TEST(SquareMaps, FloatAgreesWithDouble) {
  Pcg32 u(7);
  for (int i = 0; i < 100000; ++i) {
    const auto p = random_square<float>(u);
    const auto narrow = square_to_disk(p);
    const auto wide = square_to_disk(Vec2<double>{p.x, p.y});
    EXPECT_NEAR(narrow.x, wide.x, 2e-7) << p.x << ' ' << p.y;
    EXPECT_NEAR(narrow.y, wide.y, 2e-7) << p.x << ' ' << p.y;
  }
}

TEST(SquareMaps, HaveTheirStatedJacobians) {
  Pcg32 u(8);
  for (int i = 0; i < 2000; ++i) {
    const auto p = random_square<double>(u);
    // Not differentiable on the diagonals, strongly curved next to the centre.
    if (std::abs(std::abs(p.x) - std::abs(p.y)) < 1e-3 || std::hypot(p.x, p.y) < 0.05) continue;
    EXPECT_NEAR(jacobian([](Vec2<double> q) { return square_to_disk(q); }, p),
                square_to_disk_jacobian<double>, 1e-7);
    const auto disk = square_to_disk(p);
    const double r2 = disk.x * disk.x + disk.y * disk.y;
    if (r2 > 0.99) continue;
    const auto dome = [](Vec2<double> q) { return disk_to_hemisphere_equal_area(q); };
    EXPECT_NEAR(jacobian(dome, disk), disk_to_hemisphere_equal_area_jacobian<double>, 1e-7);
    const auto lift = [](Vec2<double> q) { return disk_to_hemisphere_projected(q); };
    EXPECT_NEAR(jacobian(lift, disk) * lift(disk).z, 1, 1e-5);
  }
}

// Uniform points of the square fall into disk sectors and rings in proportion to their area.
TEST(SquareMaps, PreserveArea) {
  constexpr int n = 1 << 20;
  int inner = 0, sector = 0, cap = 0;
  Pcg32 u(9);
  for (int i = 0; i < n; ++i) {
    const auto disk = square_to_disk(random_square<float>(u));
    inner += disk.x * disk.x + disk.y * disk.y < 0.3f;
    sector += std::atan2(disk.y, disk.x) > 0.9f;
    cap += disk_to_hemisphere_equal_area(disk).z > 0.6f;
  }
  const auto expect_share = [](int count, double p) {
    EXPECT_NEAR(count, n * p, 4.5 * std::sqrt(n * p * (1 - p)));
  };
  expect_share(inner, 0.3);
  expect_share(sector, (pi_v<double> - 0.9) / (2 * pi_v<double>));
  expect_share(cap, 0.4);
}

TEST(SquareMaps, KeepTheUpperHalfAndTheSymmetries) {
  Pcg32 u(10);
  for (int i = 0; i < 10000; ++i) {
    const auto p = random_square<float>(u);
    const auto d = square_to_disk(p);
    EXPECT_EQ(p.y >= 0, d.y >= 0);
    EXPECT_EQ(square_to_disk(Vec2<float>{p.x, -p.y}), (Vec2<float>{d.x, -d.y}));
    EXPECT_EQ(square_to_disk(Vec2<float>{-p.x, p.y}), (Vec2<float>{-d.x, d.y}));
  }
}

TEST(SquareMaps, GiveUnitVectorsAboveTheSurface) {
  const auto hard = hard_coordinates();
  for (const float x : hard) {
    for (const float y : hard) {
      const auto disk = square_to_disk(Vec2<float>{x, y});
      for (const auto w : {disk_to_hemisphere_equal_area(disk), disk_to_hemisphere_projected(disk)}) {
        EXPECT_NEAR(length(w), 1, 4e-7f) << x << ' ' << y;
        EXPECT_GE(w.z, 0);
      }
    }
  }
  EXPECT_EQ(disk_to_hemisphere_equal_area(square_to_disk(Vec2<float>{})), (Vec3<float>{0, 0, 1}));
}

}  // namespace
}  // namespace reflectree
