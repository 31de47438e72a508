#pragma once

/// Four doubles at once, for the small loops of one posture: the compiler keeps them in one AVX register or in
/// two of SSE. The batch kernels, whose loops are long, use Highway instead.

namespace zwidth {

/// Four doubles side by side; + - * work on all of them, [i] is one of them. Passed by reference, because as
/// values they travel differently with and without AVX.
typedef double Lanes __attribute__((vector_size(32)));
inline constexpr int kLanes = 4;

/// Lanes anywhere among doubles.
typedef double LanesInMemory __attribute__((vector_size(32), aligned(8), may_alias));
[[gnu::always_inline]] inline LanesInMemory& lanes_at(double* where) {
  return *reinterpret_cast<LanesInMemory*>(where);
}
[[gnu::always_inline]] inline const LanesInMemory& lanes_at(const double* where) {
  return *reinterpret_cast<const LanesInMemory*>(where);
}

}  // namespace zwidth

/// Compiles a function twice, for every x86-64 processor and for those with AVX2 and FMA, with all that it
/// calls inlined; the loader takes the fitting one. (Under a sanitizer it would do so before the sanitizer is
/// ready.)
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ZWIDTH_WIDE __attribute__((flatten, target_clones("arch=x86-64-v3", "default")))
#else
#define ZWIDTH_WIDE
#endif
