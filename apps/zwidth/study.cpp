#include "study.h"

#include <algorithm>
#include <fstream>

#include "context.h"

namespace zwidth {

bool names_study(const std::string& study) {
  const auto& known = catalogue().studies();
  if (std::any_of(known.begin(), known.end(), [&](const BuiltinFile& one) { return one.name == study; })) {
    return true;
  }
  std::ifstream file(study);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("[study]")) return true;
  }
  return false;
}

std::unique_ptr<StudyModel> read_study_model(const std::string& study,
                                             const std::vector<std::string>& overrides) {
  const auto device_of = [](const Study& one) { return read_device(one.device, one.overrides); };
  const Study read = read_study(study, overrides, catalogue(), [&](const Study& one) {
    return study_problems(one, device_of(one), catalogue());
  });
  return std::make_unique<StudyModel>(read, device_of(read), catalogue());
}

}  // namespace zwidth
