#pragma once

#include <memory>
#include <optional>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/closed_form.h"

/// The families of mechanisms that a description may name, each as legs and, where it has one, as a closed
/// form. A new family starts with a struct in description.h and two functions here.

namespace zwidth {

/// The same mechanism spelled out as legs.
LegsDescription legs_of(const DeltaDescription& delta);
LegsDescription legs_of(const FiveBarDescription& five_bar);
LegsDescription legs_of(const RCubeDescription& r_cube);
LegsDescription legs_of(const SerialDescription& arm);

/// The Denavit-Hartenberg rows of an arm that is given by axes and points, with rows of type fixed in front and
/// behind where base or tool need them: joint values mean the same. Nothing if the leg is no such arm: a joint
/// is passive or a parallelogram, or the platform hangs on a point.
std::optional<SerialDescription> rows_of(const LegDescription& leg);

/// `description` with its mechanism and bodies in the general form.
Description spelled_out(const Description& description);

/// A serial arm with its free joints held at home: what its drives alone do with the tool. Bodies stay where
/// they are. Other mechanisms come back as they are.
Description without_free_joints(const Description& description);

/// Null where the family has none.
std::shared_ptr<const ClosedForm> closed_form_of(const MechanismDescription& mechanism);
std::shared_ptr<const ClosedForm> closed_form_of(const DeltaDescription& delta);
std::shared_ptr<const ClosedForm> closed_form_of(const FiveBarDescription& five_bar);
std::shared_ptr<const ClosedForm> closed_form_of(const RCubeDescription& r_cube);
std::shared_ptr<const ClosedForm> closed_form_of(const SerialDescription& arm);
std::shared_ptr<const ClosedForm> closed_form_of(const LegsDescription& legs);  ///< of a serial arm

}  // namespace zwidth
