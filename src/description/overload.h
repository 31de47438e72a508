#pragma once

namespace zwidth {

/// One function per alternative, for `std::visit`.
template <class... Functions>
struct Overload : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overload(Functions...) -> Overload<Functions...>;  // clang 14 does not find it by itself

}  // namespace zwidth
