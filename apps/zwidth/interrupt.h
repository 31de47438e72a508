#pragma once

#include <atomic>

namespace zwidth {

/// From now on Ctrl-C, or the SIGTERM that launchers of parallel jobs make of it, sets the returned flag, once;
/// a second one ends the program as usual.
const std::atomic<bool>& stop_on_interrupt();

}  // namespace zwidth
