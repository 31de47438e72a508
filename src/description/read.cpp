#include "zwidth/description/read.h"

#include <algorithm>

#include "zwidth/description/internal/checks.h"
#include "zwidth/description/internal/description_reader.h"
#include "zwidth/description/internal/table_reader.h"
#include "zwidth/description/validate.h"

namespace zwidth {

Description parse_description(std::string_view text, std::string_view file,
                              const std::vector<std::string>& overrides, const Catalogue& catalogue,
                              std::span<const DescriptionCheck> checks) {
  const bool blank = std::all_of(text.begin(), text.end(),
                                 [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
  if (blank) {
    throw DescriptionError(
        {{.file = std::string(file),
          .line = 1,
          .column = 1,
          .rule = "is empty",
          .advice = "start with [device], as in docs/device_file.md, or with `zwidth show delta`"}});
  }
  Input input(text, file);
  for (const std::string& override_text : overrides) input.set(override_text);
  Description description = read_device_tables(input, catalogue);
  // Links are named by the family, or by the legs and joints that are spelled out, whatever their lengths.
  const bool names_known = !input.faulty("mechanism.type") && !input.faulty("leg") && !input.faulty("joint");
  input.add_value_problems(value_problems(description));
  if (names_known) input.add_value_problems(name_problems(description));
  input.throw_problems();
  for (const DescriptionCheck check : checks) input.add_value_problems(check(description));
  input.throw_problems();
  return description;
}

Description read_description(std::string_view device, const std::vector<std::string>& overrides,
                             const Catalogue& catalogue, std::span<const DescriptionCheck> checks) {
  if (device == "-") return parse_description(read_text("-"), "<stdin>", overrides, catalogue, checks);
  const std::string path = resolve_device(device, catalogue).string();
  return parse_description(read_text(path), path, overrides, catalogue, checks);
}

}  // namespace zwidth
