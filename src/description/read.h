#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"

/// Device files (TOML, format in docs/device_file.md) become descriptions.
///
/// Overrides have the form "KEY=VALUE", as after `--set`: KEY is a dotted path ("mechanism.forearm",
/// "drive[0].motor", "drive.0.motor"; without an index every element of an array of tables is meant), VALUE is
/// TOML, or a string if it is not. They pass the same checks as the file.
///
/// Whatever is wrong with the input, any bytes at all, ends in one DescriptionError that lists every problem.

namespace zwidth {

/// A rule about whole descriptions that another room knows. It is asked once the description's own rules hold;
/// its problems have keys, and get their places here.
using DescriptionCheck = std::vector<Problem> (*)(const Description&);

/// Reads the built-in device or the file that `device` names; "-" is the standard input.
Description read_description(std::string_view device, const std::vector<std::string>& overrides,
                             const Catalogue& catalogue, std::span<const DescriptionCheck> checks = {});

/// Reads the text of a device file. `file` is what problems call it.
Description parse_description(std::string_view text, std::string_view file,
                              const std::vector<std::string>& overrides, const Catalogue& catalogue,
                              std::span<const DescriptionCheck> checks = {});

}  // namespace zwidth
