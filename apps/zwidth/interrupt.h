#pragma once

#include <atomic>

namespace zwidth {

/// From now on Ctrl-C sets the returned flag, once; a second Ctrl-C ends the program as usual.
const std::atomic<bool>& stop_on_interrupt();

}  // namespace zwidth
