#include "zwidth/description/parts.h"

#include <algorithm>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/internal/part_reader.h"
#include "zwidth/description/internal/schema.h"

namespace zwidth {
namespace {

double value_of(const auto& owner, const auto& field) {
  return std::visit(
      [&owner](auto member) -> double {
        using Value = std::remove_cvref_t<decltype(owner.*member)>;
        if constexpr (std::is_arithmetic_v<Value>) return static_cast<double>(owner.*member);
        return kNotGiven;  // parts hold plain numbers only
      },
      field.member);
}

template <class Part>
bool equal(const Part& a, const Part& b) {
  return a.info == b.info && same_fields(a, b);
}

template <class Part>
std::vector<std::string> part_names(const Catalogue& catalogue) {
  std::vector<std::string> names;
  for (const Part& part : catalogue.all<Part>()) names.push_back(part.info.name);
  return names;
}

}  // namespace

bool Motor::operator==(const Motor& other) const {
  return equal(*this, other);
}
bool Gearhead::operator==(const Gearhead& other) const {
  return equal(*this, other);
}
bool Encoder::operator==(const Encoder& other) const {
  return equal(*this, other);
}
bool Amplifier::operator==(const Amplifier& other) const {
  return equal(*this, other);
}
bool Cable::operator==(const Cable& other) const {
  return equal(*this, other);
}
bool Bearing::operator==(const Bearing& other) const {
  return equal(*this, other);
}
bool Material::operator==(const Material& other) const {
  return equal(*this, other);
}
bool Lamina::operator==(const Lamina& other) const {
  return equal(*this, other);
}
bool Cylinder::operator==(const Cylinder& other) const {
  return equal(*this, other);
}
bool Regulator::operator==(const Regulator& other) const {
  return equal(*this, other);
}
bool Potentiometer::operator==(const Potentiometer& other) const {
  return equal(*this, other);
}

template <>
std::string_view part_kind<Motor>() {
  return "motor";
}
template <>
std::string_view part_kind<Gearhead>() {
  return "gearhead";
}
template <>
std::string_view part_kind<Encoder>() {
  return "encoder";
}
template <>
std::string_view part_kind<Amplifier>() {
  return "amplifier";
}
template <>
std::string_view part_kind<Cable>() {
  return "cable";
}
template <>
std::string_view part_kind<Bearing>() {
  return "bearing";
}
template <>
std::string_view part_kind<Material>() {
  return "material";
}
template <>
std::string_view part_kind<Lamina>() {
  return "lamina";
}
template <>
std::string_view part_kind<Cylinder>() {
  return "cylinder";
}
template <>
std::string_view part_kind<Regulator>() {
  return "regulator";
}
template <>
std::string_view part_kind<Potentiometer>() {
  return "potentiometer";
}

template <class Part>
std::vector<PartValue> part_values(const Part& part) {
  std::vector<PartValue> values;
  for (const Field<Part>& field : fields<Part>()) {
    const std::string key(field.key);
    const auto own = part.info.sources.find(key);
    values.push_back({.key = key,
                      .value = value_of(part, field),
                      .dimension = field.dimension,
                      .meaning = std::string(field.meaning),
                      .source = own == part.info.sources.end() ? part.info.source : own->second});
  }
  return values;
}

template <class Part>
void read_part_values(TableReader& table, Part& part, bool partial, Need source) {
  table.read(part, partial);
  if (const auto title = table.text("title", Need::optional)) part.info.title = *title;
  if (part.info.title.empty()) part.info.title = part.info.name;
  table.read_sources(part.info.source, part.info.sources, source);
  table.finish();
}

template <class Part>
Part read_part(TableReader& table, std::string_view key, const Catalogue& catalogue) {
  const std::string kind(part_kind<Part>());
  const std::string advice = "name a part of the catalogue; `zwidth parts` lists them";
  const auto look_up = [&](TableReader& where, std::string_view name_key) -> Part {
    const std::optional<std::string> name = where.text(name_key, Need::required, advice);
    if (!name) return {};
    if (const Part* part = catalogue.find<Part>(*name)) return *part;
    where.report(name_key, "is not a known " + kind, suggest(*name, part_names<Part>(catalogue)));
    return {};
  };

  if (!table.has_table(key)) return look_up(table, key);
  TableReader inner = *table.table(key, Need::required);
  Part part;
  const bool replaces = inner.has("base");
  if (replaces) {
    part = look_up(inner, "base");
  } else {
    part.info.name =
        inner.text("name", Need::required, "or replace values of a known part: base = \"NAME\"").value_or("");
  }
  read_part_values(inner, part, replaces, Need::optional);
  return part;
}

#define ZWIDTH_INSTANTIATE(Part)                                         \
  template std::vector<PartValue> part_values<Part>(const Part&);        \
  template void read_part_values<Part>(TableReader&, Part&, bool, Need); \
  template Part read_part<Part>(TableReader&, std::string_view, const Catalogue&);
ZWIDTH_INSTANTIATE(Motor)
ZWIDTH_INSTANTIATE(Gearhead)
ZWIDTH_INSTANTIATE(Encoder)
ZWIDTH_INSTANTIATE(Amplifier)
ZWIDTH_INSTANTIATE(Cable)
ZWIDTH_INSTANTIATE(Bearing)
ZWIDTH_INSTANTIATE(Material)
ZWIDTH_INSTANTIATE(Lamina)
ZWIDTH_INSTANTIATE(Cylinder)
ZWIDTH_INSTANTIATE(Regulator)
ZWIDTH_INSTANTIATE(Potentiometer)
#undef ZWIDTH_INSTANTIATE

}  // namespace zwidth
