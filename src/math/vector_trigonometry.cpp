#include "zwidth/math/vector_trigonometry.h"

#include <cassert>
#include <cmath>
#include <cstddef>

// Compiled for every instruction set; Highway picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "zwidth/math/vector_trigonometry.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "zwidth/math/vector_trigonometry-inl.h"

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

// The last few values of an array, filled up to a whole vector.
HWY_INLINE V load(const double* from, std::size_t count, double fill) {
  HWY_ALIGN double all[HWY_MAX_BYTES / sizeof(double)];
  for (std::size_t k = 0; k < hn::Lanes(D()); ++k) all[k] = k < count ? from[k] : fill;
  return hn::Load(D(), all);
}
HWY_INLINE void store(V value, double* to, std::size_t count) {
  HWY_ALIGN double all[HWY_MAX_BYTES / sizeof(double)];
  hn::Store(value, D(), all);
  for (std::size_t k = 0; k < count; ++k) to[k] = all[k];
}

// Whether every angle is small enough for the vector form.
bool sine_cosines(const double* angle, std::size_t count, double* sine, double* cosine) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  V largest = hn::Zero(d), s, c;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const V a = hn::LoadU(d, angle + i);
    sine_cosine(d, a, s, c);
    hn::StoreU(s, d, sine + i);
    hn::StoreU(c, d, cosine + i);
    largest = hn::Max(largest, hn::Abs(a));
  }
  if (i < count) {
    const V a = load(angle + i, count - i, 0.0);
    sine_cosine(d, a, s, c);
    store(s, sine + i, count - i);
    store(c, cosine + i, count - i);
    largest = hn::Max(largest, hn::Abs(a));
  }
  // NaN passes through the vector form by itself.
  return hn::AllFalse(d, largest >= hn::Set(d, 1e5));
}

void angles_of(const double* cosine, const double* sine, std::size_t count, double* angle) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::StoreU(angle_of(d, hn::LoadU(d, cosine + i), hn::LoadU(d, sine + i)), d, angle + i);
  }
  if (i < count) {
    store(angle_of(d, load(cosine + i, count - i, 1.0), load(sine + i, count - i, 0.0)), angle + i, count - i);
  }
}

}  // namespace
}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace zwidth {

HWY_EXPORT(sine_cosines);
HWY_EXPORT(angles_of);

void sine_cosines(std::span<const double> angle, std::span<double> sine, std::span<double> cosine) noexcept {
  assert(sine.size() == angle.size() && cosine.size() == angle.size());
  if (HWY_DYNAMIC_DISPATCH(sine_cosines)(angle.data(), angle.size(), sine.data(), cosine.data())) return;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    sine[i] = std::sin(angle[i]);
    cosine[i] = std::cos(angle[i]);
  }
}

void angles_of(std::span<const double> cosine, std::span<const double> sine, std::span<double> angle) noexcept {
  assert(sine.size() == cosine.size() && angle.size() == cosine.size());
  HWY_DYNAMIC_DISPATCH(angles_of)(cosine.data(), sine.data(), cosine.size(), angle.data());
}

}  // namespace zwidth
#endif  // HWY_ONCE
