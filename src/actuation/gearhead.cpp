#include "zwidth/actuation/gearhead.h"

#include "zwidth/actuation/require.h"

namespace zwidth {

double reduction(double numerator, double denominator) {
  return require_positive("numerator of the reduction", numerator) /
         require_positive("denominator of the reduction", denominator);
}

double reduction(const Gearhead& gearhead) {
  return reduction(gearhead.reduction_numerator, gearhead.reduction_denominator);
}

double required_motor_torque(double joint_torque, double ratio, double efficiency) {
  const double i = require_positive("ratio", ratio), eta = require_positive("efficiency", efficiency);
  return joint_torque / (i * eta);
}

double output_torque(double motor_torque, double ratio, double efficiency) {
  const double i = require_positive("ratio", ratio), eta = require_positive("efficiency", efficiency);
  return motor_torque * i * eta;
}

}  // namespace zwidth
