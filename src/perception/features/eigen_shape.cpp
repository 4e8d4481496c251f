// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors of four symmetric 3 x 3 matrices at once: first the best separated eigenvalue and its
// vector, then those of the 2 x 2 matrix orthogonal to it (after Eberly, "A Robust Eigensolver for 3 x 3 Symmetric
// Matrices", 2014).
#include "perception/features/eigen_shape.hpp"

#include "perception/simd_vector.hpp"

namespace cluxel::perception {

namespace {

struct Vector {
  Floats x, y, z;
};

Floats dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector scaled(const Vector& a, const Floats& by) {
  return {a.x * by, a.y * by, a.z * by};
}
Vector sum(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vector choose(const Numbers& which, const Vector& a, const Vector& b) {
  return {which ? a.x : b.x, which ? a.y : b.y, which ? a.z : b.z};
}

struct Matrix {
  Floats xx, xy, xz, yy, yz, zz;
  Vector operator*(const Vector& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// The largest root of 4 y^3 - 3 y = r for r in [0, 1], which is cos(acos(r) / 3): a parabola as start, then Newton
/// iterations.
Floats largestRoot(const Floats& r) {
  Floats y = 0.8660254F + r * (0.1653F - 0.0313F * r);
  for (int step = 0; step < 2; ++step) y -= ((4.0F * y * y - 3.0F) * y - r) / (12.0F * y * y - 3.0F);
  return y;
}

/// An eigenvalue and its unit vector, and whether it is the largest of the three (else the smallest).
struct Apart {
  Vector vector;
  Numbers is_largest;
};

/// The eigenvector of the eigenvalue that is farthest from the others. The trace is 1.
Apart eigenvectorApart(const Matrix& m) {
  const Floats third = {1.0F / 3.0F, 1.0F / 3.0F, 1.0F / 3.0F, 1.0F / 3.0F}, zero{}, tiny = zero + 1e-30F;
  const Floats a = m.xx - third, b = m.yy - third, c = m.zz - third;
  const Floats off = m.xy * m.xy + m.xz * m.xz + m.yz * m.yz;
  const Floats p = squareRoots((a * a + b * b + c * c + 2.0F * off) / 6.0F);
  const Floats determinant =
      a * (b * c - m.yz * m.yz) - m.xy * (m.xy * c - m.yz * m.xz) + m.xz * (m.xy * m.yz - b * m.xz);
  const Floats cube = 2.0F * p * p * p;
  const Floats r = determinant / (cube + tiny), size = r < zero ? -r : r;
  const Numbers is_largest = r >= zero;
  const Floats away = 2.0F * p * largestRoot(minimum(size, zero + 1.0F));
  const Floats value = is_largest ? away : -away;
  // The rows of (matrix - eigenvalue) span the plane orthogonal to the eigenvector: the longest of their cross products
  // is the most accurate.
  const Vector row_0{a - value, m.xy, m.xz}, row_1{m.xy, b - value, m.yz}, row_2{m.xz, m.yz, c - value};
  const Vector by_01 = cross(row_0, row_1), by_02 = cross(row_0, row_2), by_12 = cross(row_1, row_2);
  const Floats size_01 = dot(by_01, by_01), size_02 = dot(by_02, by_02), size_12 = dot(by_12, by_12);
  const Numbers first = size_01 >= size_02;
  const Vector better = choose(first, by_01, by_02);
  const Floats better_size = first ? size_01 : size_02;
  const Numbers is_last = size_12 > better_size;
  const Vector best = choose(is_last, by_12, better);
  const Floats best_size = is_last ? size_12 : better_size;
  const Floats length = squareRoots(best_size);
  const Numbers found = length > tiny;  // else all three eigenvalues are equal, and any vector is an eigenvector
  const Floats per_length = 1.0F / (found ? length : zero + 1.0F);
  return {{found ? best.x * per_length : zero + 1.0F, found ? best.y * per_length : zero,
           found ? best.z * per_length : zero},
          is_largest};
}

/// Two unit vectors orthogonal to v and to each other.
std::array<Vector, 2> across(const Vector& v) {
  const Floats zero{}, xx = v.x * v.x, yy = v.y * v.y, zz = v.z * v.z;
  const Numbers by_x = xx > yy;
  const Floats per_length = 1.0F / squareRoots((by_x ? xx : yy) + zz);
  const Vector u = scaled({by_x ? -v.z : zero, by_x ? zero : v.z, by_x ? v.x : -v.y}, per_length);
  return {u, cross(v, u)};
}

struct Eigen3 {
  Floats largest, middle, smallest;
  Vector axis, normal;
};

Eigen3 solve(const Matrix& m) {
  const Floats zero{}, half = zero + 0.5F, tiny = zero + 1e-30F;
  const Apart apart = eigenvectorApart(m);
  const Vector& v = apart.vector;
  const auto [u, w] = across(v);
  const Vector mu = m * u, mw = m * w;
  const Floats uu = dot(u, mu), uw = dot(u, mw), ww = dot(w, mw), alone = dot(v, m * v);
  const Floats mean = half * (uu + ww), difference = half * (uu - ww);
  const Floats spread = squareRoots(difference * difference + uw * uw);
  const Numbers has_spread = spread > tiny;
  const Floats cosine = has_spread ? difference / (has_spread ? spread : half) : zero + 1.0F;  // of twice the angle
  const Floats size = cosine < zero ? -cosine : cosine;
  const Floats longer = squareRoots(half * (1.0F + size));
  const Floats shorter = has_spread ? uw / (2.0F * longer * (has_spread ? spread : half)) : zero;
  const Numbers near_u = cosine >= zero;
  const Floats on_u = near_u ? longer : shorter, on_w = near_u ? shorter : longer;
  const Vector high = sum(scaled(u, on_u), scaled(w, on_w)), low = sum(scaled(w, on_u), scaled(u, -on_w));
  const Numbers& top = apart.is_largest;
  return {top ? alone : mean + spread, top ? mean + spread : mean - spread, top ? mean - spread : alone,
          choose(top, v, high), choose(top, low, v)};
}

Eigen::Vector3d laneOf(const Vector& v, std::size_t lane) {
  return {static_cast<double>(v.x[lane]), static_cast<double>(v.y[lane]), static_cast<double>(v.z[lane])};
}

}  // namespace

Covariance covarianceOf(const Moments& moments) {
  const auto& s = moments.scatter;
  const double n = std::max(1.0F, moments.count);
  return {s[0] / n, s[1] / n, s[2] / n, s[3] / n, s[4] / n, s[5] / n};
}

Covariance covarianceOf(const MomentSum& sum) {
  if (!(sum.n > 0)) return {};
  const double x = sum.x / sum.n, y = sum.y / sum.n, z = sum.z / sum.n;
  return {sum.xx / sum.n - x * x, sum.xy / sum.n - x * y, sum.xz / sum.n - x * z,
          sum.yy / sum.n - y * y, sum.yz / sum.n - y * z, sum.zz / sum.n - z * z};
}

std::array<EigenShape, 4> shapesOf(std::span<const Covariance> covariances) {
  std::array<std::array<float, kLanes>, 6> entries{};
  std::array<double, kLanes> trace{};
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const Covariance& from = covariances[i];
    trace[i] = from[0] + from[3] + from[5];
    const double scale = trace[i] > kNoExtent_m2 ? 1.0 / trace[i] : 0.0;
    for (std::size_t k = 0; k < from.size(); ++k) entries[k][i] = static_cast<float>(from[k] * scale);
  }
  const auto at = [&](std::size_t k) { return loadFloats(entries[k].data()); };
  const Eigen3 found = solve({at(0), at(1), at(2), at(3), at(4), at(5)});
  std::array<EigenShape, 4> shapes;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    if (!(trace[i] > kNoExtent_m2)) continue;
    const float l1 = found.largest[i], l2 = std::min(l1, std::max(found.middle[i], 0.0F));
    const float l3 = std::min(l2, std::max(found.smallest[i], 0.0F));
    for (std::size_t k = 0; k < 3; ++k) shapes[i].value[k] = trace[i] * static_cast<double>(std::array{l1, l2, l3}[k]);
    shapes[i].axis = laneOf(found.axis, i);
    if (shapes[i].value[1] > kOnALine * shapes[i].value[0]) shapes[i].normal = laneOf(found.normal, i);
  }
  return shapes;
}

}  // namespace cluxel::perception
