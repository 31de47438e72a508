#include "zwidth/mechanism/point_reach.h"

#include <algorithm>

#include "zwidth/mechanism/internal/serial_closed_form.h"

namespace zwidth {

std::optional<PointReach> PointReach::of(const Mechanism& mechanism) {
  const auto* form = dynamic_cast<const internal::SerialClosedForm*>(mechanism.closed_form());
  SolveOptions options;
  options.match = Match::position;
  if (form == nullptr || !form->covers(options)) return std::nullopt;
  const internal::SrsPattern& srs = *form->srs();
  std::array<Interval, 4> ranges;
  for (int i = 0; i < 4; ++i) {
    if (srs.joint[i] < 0) {
      ranges[i] = {srs.offset[i], srs.offset[i]};
      continue;
    }
    const Interval range = mechanism.active_range(srs.joint[i]);
    const double a = srs.sign[i] * range.min + srs.offset[i], b = srs.sign[i] * range.max + srs.offset[i];
    ranges[i] = {std::min(a, b), std::max(a, b)};
  }
  return PointReach(srs.base, SrsReach(srs.lengths, ranges));
}

}  // namespace zwidth
