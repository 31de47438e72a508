#include "efforts.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include "terminal.h"

namespace zwidth {

bool joint_slides(const Mechanism& mechanism, int i) {
  return mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(i))].type == JointType::prismatic;
}

const char* effort_unit(bool slides) {
  return slides ? "N" : "N m";
}

bool all_slide(const std::vector<bool>& slides) {
  return !slides.empty() && std::find(slides.begin(), slides.end(), false) == slides.end();
}

const char* effort_word(const std::vector<bool>& slides) {
  if (all_slide(slides)) return "force";
  return std::find(slides.begin(), slides.end(), true) == slides.end() ? "torque" : "torque and force";
}

std::string efforts_text(const ActiveVector& efforts, const std::vector<bool>& slides) {
  std::string text;
  for (const bool kind : {false, true}) {
    double least = std::numeric_limits<double>::infinity(), largest = -least;
    for (std::size_t j = 0; j < slides.size(); ++j) {
      if (slides[j] != kind) continue;
      least = std::min(least, efforts[static_cast<Eigen::Index>(j)]);
      largest = std::max(largest, efforts[static_cast<Eigen::Index>(j)]);
    }
    if (least > largest) continue;
    if (!text.empty()) text += " and ";
    text += least == largest ? readable(least, effort_unit(kind))
                             : fmt::format("{} … {}", readable(least, effort_unit(kind)),
                                           readable(largest, effort_unit(kind)));
  }
  return text;
}

}  // namespace zwidth
