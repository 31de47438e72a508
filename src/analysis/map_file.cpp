#include <bit>
#include <charconv>
#include <cstdint>
#include <ostream>

#include "zwidth/analysis/workspace.h"

namespace zwidth {
namespace {

// The shortest decimal number that reads back as the same double.
void write_number(double value, std::ostream& out) {
  char text[32];
  out.write(text, std::to_chars(text, text + sizeof text, value).ptr - text);
}

void write_double(double value, std::ostream& out) {
  auto bits = std::bit_cast<std::uint64_t>(value);
  char bytes[8];
  for (char& byte : bytes) {
    byte = static_cast<char>(bits & 0xff);
    bits >>= 8;
  }
  out.write(bytes, sizeof bytes);
}

}  // namespace

std::vector<std::string> WorkspaceMap::columns() const {
  std::vector<std::string> names = {"x", "y", "z"};
  names.resize(static_cast<std::size_t>(dimension));
  for (const Figure which : defined) names.emplace_back(figure_info(static_cast<int>(which)).name);
  names.insert(names.end(), more_names.begin(), more_names.end());
  return names;
}

void write_csv(const WorkspaceMap& map, std::ostream& out) {
  const std::vector<std::string> names = map.columns();
  for (std::size_t c = 0; c < names.size(); ++c) out << (c == 0 ? "" : ",") << names[c];
  out << '\n';
  for (std::size_t p = 0; p < map.positions.size(); ++p) {
    for (int axis = 0; axis < map.dimension; ++axis) {
      if (axis > 0) out << ',';
      write_number(map.positions[p][axis], out);
    }
    for (const Figure which : map.defined) {
      out << ',';
      write_number(figure(map.figures[p], which), out);
    }
    for (std::size_t c = 0; c < map.more_names.size(); ++c) {
      out << ',';
      write_number(map.more[p * map.more_names.size() + c], out);
    }
    out << '\n';
  }
}

void write_npy(const WorkspaceMap& map, std::ostream& out) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" +
                       std::to_string(map.positions.size()) + ", " + std::to_string(map.columns().size()) +
                       "), }";
  // Magic (6), version (2) and length (2) with the header fill a multiple of 64 bytes, the last a newline.
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  out.write("\x93NUMPY\x01\x00", 8);
  out.put(static_cast<char>(header.size() & 0xff)).put(static_cast<char>(header.size() >> 8));
  out << header;
  for (std::size_t p = 0; p < map.positions.size(); ++p) {
    for (int axis = 0; axis < map.dimension; ++axis) write_double(map.positions[p][axis], out);
    for (const Figure which : map.defined) write_double(figure(map.figures[p], which), out);
    for (std::size_t c = 0; c < map.more_names.size(); ++c)
      write_double(map.more[p * map.more_names.size() + c], out);
  }
}

}  // namespace zwidth
