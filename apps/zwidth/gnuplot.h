#pragma once

#include <string>

namespace zwidth {

/// Runs gnuplot on a script; figures go where the script says. Throws MachineError when gnuplot is missing
/// (naming the package) or fails (with its message).
void run_gnuplot(const std::string& script);

}  // namespace zwidth
