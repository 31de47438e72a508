#include "zwidth/mechanism/batch_serial.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

// The kernels are written once and compiled for every instruction set; Highway picks one at run time.
// Vectors without a fixed size (SVE, RVV) cannot be elements of an array, so those processors use their
// fixed-size set.
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "zwidth/mechanism/batch_serial.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "zwidth/math/vector_trigonometry-inl.h"

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using Parameters = SerialBatch::Parameters;
using Row = SerialChain::Row;

HWY_INLINE V set(double value) {
  return hn::Set(D(), value);
}

struct Vec {
  V x, y, z;
};
HWY_INLINE Vec combined(V a, const Vec& u, V b, const Vec& v) {
  return {hn::MulAdd(a, u.x, b * v.x), hn::MulAdd(a, u.y, b * v.y), hn::MulAdd(a, u.z, b * v.z)};
}
// a u - b v
HWY_INLINE Vec difference(V a, const Vec& u, V b, const Vec& v) {
  return {hn::MulSub(a, u.x, b * v.x), hn::MulSub(a, u.y, b * v.y), hn::MulSub(a, u.z, b * v.z)};
}
HWY_INLINE void advance(Vec& point, V length, const Vec& direction) {
  point.x = hn::MulAdd(length, direction.x, point.x);
  point.y = hn::MulAdd(length, direction.y, point.y);
  point.z = hn::MulAdd(length, direction.z, point.z);
}
HWY_INLINE Vec negative(const Vec& v) {
  return {hn::Neg(v.x), hn::Neg(v.y), hn::Neg(v.z)};
}

// Tool point of one vector of postures; with `axes` also axis and point of every joint.
template <bool axes>
HWY_INLINE Vec place(const Parameters& p, int rows, const V* joints, Vec* axis, Vec* point) {
  const V zero = hn::Zero(D()), one = set(1.0);
  Vec x{one, zero, zero}, y{zero, one, zero}, z{zero, zero, one}, o{zero, zero, zero};
  for (int r = 0; r < rows; ++r) {
    const Row& row = p.row[r];
    V s, c;
    if (row.joint >= 0 && !row.slides) {
      sine_cosine(D(), joints[row.joint] + set(row.theta), s, c);
    } else {
      s = set(row.sin_theta);
      c = set(row.cos_theta);
    }
    if constexpr (axes) {
      if (row.joint >= 0) {
        axis[row.joint] = z;
        point[row.joint] = o;
      }
    }
    if (row.slides) {
      advance(o, joints[row.joint] + set(row.d), z);
    } else if (row.d != 0.0) {
      advance(o, set(row.d), z);
    }
    const Vec y_untwisted = difference(c, y, s, x);
    x = combined(c, x, s, y);
    if (row.a != 0.0) advance(o, set(row.a), x);
    switch (row.twist) {
      case Row::Twist::none:
        y = y_untwisted;
        break;
      case Row::Twist::quarter:
        y = z;
        z = negative(y_untwisted);
        break;
      case Row::Twist::minus_quarter:
        y = negative(z);
        z = y_untwisted;
        break;
      case Row::Twist::other: {
        const V sa = set(row.sin_alpha), ca = set(row.cos_alpha);
        y = combined(ca, y_untwisted, sa, z);
        z = difference(ca, z, sa, y_untwisted);
        break;
      }
    }
  }
  return o;
}

// sqrt(det G) and if asked m/sqrt(tr G tr G^-1) of a Gram matrix, by G = L D L^T: G^-1 = L^-T D^-1 L^-1.
template <int m, bool with_conditioning>
HWY_INLINE void reduce(V (&G)[m][m], V& manipulability, V& conditioning) {
  const V one = set(1.0), tiny = set(1e-280);
  V trace = G[0][0];
  HWY_UNROLL(6)
  for (int i = 1; i < m; ++i) trace = trace + G[i][i];
  V det = one, inverse_d[m];
  HWY_UNROLL(6)
  for (int j = 0; j < m; ++j) {
    // A pivot that rounding made negative is 0 within rounding.
    G[j][j] = hn::Max(G[j][j], tiny);
    det = det * G[j][j];
    inverse_d[j] = one / G[j][j];
    HWY_UNROLL(6)
    for (int r = m - 1; r > j; --r) {  // from below, so that column j is still whole above
      const V l = G[r][j] * inverse_d[j];
      HWY_UNROLL(6)
      for (int c = j + 1; c <= r; ++c) G[r][c] = hn::NegMulAdd(l, G[c][j], G[r][c]);
      G[r][j] = l;
    }
  }
  manipulability = hn::Sqrt(det);
  if constexpr (!with_conditioning) return;
  // Columns of L^-1, one after the other.
  V inverse_trace = hn::Zero(D());
  HWY_UNROLL(6)
  for (int c = 0; c < m; ++c) {
    V column[m];
    column[c] = one;
    inverse_trace = inverse_trace + inverse_d[c];
    HWY_UNROLL(6)
    for (int r = c + 1; r < m; ++r) {
      V sum = G[r][c];
      HWY_UNROLL(6)
      for (int k = c + 1; k < r; ++k) sum = hn::MulAdd(G[r][k], column[k], sum);
      column[r] = hn::Neg(sum);
      inverse_trace = hn::MulAdd(sum * sum, inverse_d[r], inverse_trace);
    }
  }
  conditioning = set(static_cast<double>(m)) / hn::Sqrt(trace * inverse_trace);
}

template <int m, bool with_conditioning>
HWY_INLINE Vec dexterity_of(const Parameters& p, const V* joints, V scale, V& manipulability, V& conditioning) {
  Vec axis[kMaxActive], point[kMaxActive];
  const Vec tool = place<true>(p, m == 3 ? p.position_rows : p.rows, joints, axis, point);
  V G[m][m];
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k <= i; ++k) G[i][k] = hn::Zero(D());
  }
  const int rows = m == 3 ? p.position_rows : p.rows;
  for (int r = 0; r < rows; ++r) {
    const int j = p.row[r].joint;
    if (j < 0) continue;
    const Vec& w = axis[j];
    V column[6] = {w.x, w.y, w.z, w.x, w.y, w.z};
    if (p.row[r].slides) {
      for (int i = 3; i < 6; ++i) column[i] = hn::Zero(D());
    } else {
      const V rx = tool.x - point[j].x, ry = tool.y - point[j].y, rz = tool.z - point[j].z;
      column[0] = hn::MulSub(w.y, rz, w.z * ry);
      column[1] = hn::MulSub(w.z, rx, w.x * rz);
      column[2] = hn::MulSub(w.x, ry, w.y * rx);
    }
    if constexpr (m == 6) {
      for (int i = 3; i < 6; ++i) column[i] = column[i] * scale;
    }
    HWY_UNROLL(6)
    for (int i = 0; i < m; ++i) {
      HWY_UNROLL(6)
      for (int k = 0; k <= i; ++k) G[i][k] = hn::MulAdd(column[i], column[k], G[i][k]);
    }
  }
  reduce<m, with_conditioning>(G, manipulability, conditioning);
  return tool;
}

// Calls `run` for each vector of postures with its joints; `store` then takes what comes out, lane by lane at
// the end.
template <int results, class Run>
HWY_INLINE void for_each(const Parameters& p, std::size_t n, const double* joints,
                         const std::array<double*, results>& out, const Run& run) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  V q[kMaxActive], result[results];
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    for (int j = 0; j < p.joints; ++j) q[j] = hn::LoadU(d, joints + j * n + i);
    run(q, result);
    for (int k = 0; k < results; ++k) hn::StoreU(result[k], d, out[k] + i);
  }
  if (i == n) return;
  HWY_ALIGN double buffer[HWY_MAX_BYTES / sizeof(double)];
  for (int j = 0; j < p.joints; ++j) {
    for (std::size_t l = 0; l < lanes; ++l) buffer[l] = joints[j * n + std::min(i + l, n - 1)];
    q[j] = hn::Load(d, buffer);
  }
  run(q, result);
  for (int k = 0; k < results; ++k) {
    hn::Store(result[k], d, buffer);
    for (std::size_t l = 0; i + l < n; ++l) out[k][i + l] = buffer[l];
  }
}

void positions(const Parameters& p, std::size_t n, const double* joints, double* x, double* y, double* z) {
  for_each<3>(p, n, joints, {x, y, z}, [&](const V* q, V* result) HWY_ATTR {
    const Vec tool = place<false>(p, p.position_rows, q, nullptr, nullptr);
    result[0] = tool.x;
    result[1] = tool.y;
    result[2] = tool.z;
  });
}

template <int m, bool with_conditioning>
HWY_INLINE void dexterity_rows(const Parameters& p, std::size_t n, const double* joints, double length,
                               const std::array<double*, 5>& out) {
  const V scale = set(length);
  constexpr int kResults = with_conditioning ? 5 : 4;
  std::array<double*, kResults> to;
  std::copy_n(out.begin(), kResults, to.begin());
  for_each<kResults>(p, n, joints, to, [&](const V* q, V* result) HWY_ATTR {
    V conditioning;
    const Vec tool = dexterity_of<m, with_conditioning>(p, q, scale, result[3], conditioning);
    result[0] = tool.x;
    result[1] = tool.y;
    result[2] = tool.z;
    if constexpr (with_conditioning) result[4] = conditioning;
  });
}

void dexterity(const Parameters& p, std::size_t n, const double* joints, bool pose, double length, double* x,
               double* y, double* z, double* manipulability, double* conditioning) {
  const std::array<double*, 5> out = {x, y, z, manipulability, conditioning};
  if (pose) {
    conditioning != nullptr ? dexterity_rows<6, true>(p, n, joints, length, out)
                            : dexterity_rows<6, false>(p, n, joints, length, out);
  } else {
    conditioning != nullptr ? dexterity_rows<3, true>(p, n, joints, length, out)
                            : dexterity_rows<3, false>(p, n, joints, length, out);
  }
}

}  // namespace
}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace zwidth {

HWY_EXPORT(positions);
HWY_EXPORT(dexterity);

SerialBatch::SerialBatch(const SerialChain& chain) : rows_(chain.rows()), joint_count_(chain.joint_count()) {
  // Behind the last row that moves the point, or carries it on, turns do not matter to it.
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (rows_[r].slides || rows_[r].d != 0.0 || rows_[r].a != 0.0) position_rows_ = static_cast<int>(r) + 1;
  }
}

SerialBatch::Parameters SerialBatch::parameters() const {
  return {.rows = static_cast<int>(rows_.size()),
          .position_rows = position_rows_,
          .row = rows_.data(),
          .joints = joint_count_};
}

void SerialBatch::positions(std::span<const double> joints, std::span<double> x, std::span<double> y,
                            std::span<double> z) const {
  assert(y.size() == x.size() && z.size() == x.size() && joints.size() == joint_count_ * x.size());
  HWY_DYNAMIC_DISPATCH(positions)(parameters(), x.size(), joints.data(), x.data(), y.data(), z.data());
}

void SerialBatch::dexterity(std::span<const double> joints, Rows rows, double length, std::span<double> x,
                            std::span<double> y, std::span<double> z, std::span<double> manipulability,
                            std::span<double> conditioning) const {
  assert(y.size() == x.size() && z.size() == x.size() && joints.size() == joint_count_ * x.size());
  assert(manipulability.size() == x.size() && (conditioning.empty() || conditioning.size() == x.size()) &&
         length > 0.0);
  HWY_DYNAMIC_DISPATCH(dexterity)
  (parameters(), x.size(), joints.data(), rows == Rows::pose, length, x.data(), y.data(), z.data(),
   manipulability.data(), conditioning.empty() ? nullptr : conditioning.data());
  if (joint_count_ < (rows == Rows::pose ? 6 : 3)) {
    std::fill(manipulability.begin(), manipulability.end(), 0.0);
    std::fill(conditioning.begin(), conditioning.end(), 0.0);
  }
}

}  // namespace zwidth
#endif  // HWY_ONCE
