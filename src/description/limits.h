#pragma once

/// The largest mechanism that a description may hold. `mechanism` reserves storage for these numbers.

namespace zwidth {

inline constexpr int kMaxLegs = 6;
inline constexpr int kMaxLegJoints = 8;  ///< of one leg
inline constexpr int kMaxActive = 8;     ///< active joints of all legs
inline constexpr int kMaxJoints = 36;    ///< joints of all legs

}  // namespace zwidth
