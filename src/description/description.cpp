#include "zwidth/description/description.h"

#include "zwidth/description/internal/schema.h"

namespace zwidth {

bool RatioDescription::operator==(const RatioDescription& other) const {
  return same_fields(*this, other) && source == other.source && sources == other.sources;
}

bool GearheadDescription::operator==(const GearheadDescription& other) const {
  return same_fields(*this, other) && gearhead == other.gearhead && source == other.source &&
         sources == other.sources;
}

}  // namespace zwidth
