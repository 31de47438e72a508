#include "zwidth/mechanism/families.h"

#include "zwidth/description/overload.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/r_cube.h"

namespace zwidth {

bool ClosedForm::covers(const SolveOptions& options) const noexcept {
  return options.match == Match::pose;
}

std::shared_ptr<const ClosedForm> closed_form_of(const MechanismDescription& mechanism) {
  return std::visit(Overload{[](const DeltaDescription& delta) { return closed_form_of(delta); },
                             [](const FiveBarDescription& five_bar) { return closed_form_of(five_bar); },
                             [](const RCubeDescription& r_cube) { return closed_form_of(r_cube); },
                             [](const SerialDescription& arm) { return closed_form_of(arm); },
                             [](const LegsDescription& legs) { return closed_form_of(legs); }},
                    mechanism);
}

Description spelled_out(const Description& description) {
  if (std::holds_alternative<LegsDescription>(description.mechanism)) return description;
  Description result = description;
  result.mechanism = std::visit(Overload{[](const LegsDescription& legs) { return legs; },
                                         [](const auto& family) { return legs_of(family); }},
                                description.mechanism);
  if (const auto* delta = std::get_if<DeltaDescription>(&description.mechanism)) {
    result.bodies = delta_leg_bodies(*delta, description.bodies);
  } else if (const auto* r_cube = std::get_if<RCubeDescription>(&description.mechanism)) {
    result.bodies = r_cube_leg_bodies(*r_cube, description.bodies);
  }
  return result;
}

}  // namespace zwidth
