#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <unistd.h>

#include "zwidth/math/beam.h"

/// One tube as a solid of finite elements, in CalculiX, against the beam that links are made of.

namespace zwidth {
namespace {

// Millimetres, newtons, megapascals, as CalculiX's users have it.
constexpr double kLength = 50.0, kOuter = 6.0, kInner = 4.0, kModulus = 200e3, kPoisson = 0.3;
constexpr int kRadial = 2, kAround = 12, kAlong = 12;  // bricks
constexpr int kReference = 900001, kRotation = 900002;

// Bricks of twenty nodes: those on a lattice of half steps of which at most one index is odd.
int node(int i, int j, int k) {
  return 1 + i + (2 * kRadial + 1) * (j % (2 * kAround) + 2 * kAround * k);
}

std::string deck() {
  std::ostringstream out;
  out.precision(12);
  out << "*NODE, NSET=ALL\n";
  std::string held, end;
  for (int k = 0; k <= 2 * kAlong; ++k) {
    for (int j = 0; j < 2 * kAround; ++j) {
      for (int i = 0; i <= 2 * kRadial; ++i) {
        if (i % 2 + j % 2 + k % 2 > 1) continue;
        const double r = 0.5 * (kInner + (kOuter - kInner) * i / (2.0 * kRadial)),
                     phi = std::numbers::pi * j / kAround;
        out << node(i, j, k) << ", " << r * std::cos(phi) << ", " << r * std::sin(phi) << ", "
            << kLength * k / (2.0 * kAlong) << "\n";
        if (k == 0) held += fmt::format("{},\n", node(i, j, k));
        if (k == 2 * kAlong) end += fmt::format("{},\n", node(i, j, k));
      }
    }
  }
  for (const int reference : {kReference, kRotation}) out << reference << ", 0, 0, " << kLength << "\n";
  out << "*ELEMENT, TYPE=C3D20R, ELSET=TUBE\n";
  int element = 0;
  for (int k = 0; k < 2 * kAlong; k += 2) {
    for (int j = 0; j < 2 * kAround; j += 2) {
      for (int i = 0; i < 2 * kRadial; i += 2) {
        // Corners below and above, then the edges between them, then those that join below and above.
        const int at[20][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
                               {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
                               {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
        out << ++element;
        for (int n = 0; n < 20; ++n)
          out << (n == 12 ? ",\n" : ", ") << node(i + at[n][0], j + at[n][1], k + at[n][2]);
        out << "\n";
      }
    }
  }
  out << "*NSET, NSET=HELD\n" << held << "*NSET, NSET=END\n" << end;
  out << "*NSET, NSET=ENDS\n" << kReference << ",\n" << kRotation << ",\n";
  out << "*MATERIAL, NAME=STEEL\n*ELASTIC\n" << kModulus << ", " << kPoisson << "\n";
  out << "*SOLID SECTION, ELSET=TUBE, MATERIAL=STEEL\n";
  out << "*RIGID BODY, NSET=END, REF NODE=" << kReference << ", ROT NODE=" << kRotation << "\n";
  out << "*BOUNDARY\nHELD, 1, 3\n";
  for (const auto& [where, axis] :
       {std::pair{kReference, 1}, {kReference, 3}, {kRotation, 1}, {kRotation, 3}}) {
    out << "*STEP\n*STATIC\n*CLOAD, OP=NEW\n"
        << where << ", " << axis << ", 1.0\n"
        << "*NODE PRINT, NSET=ENDS\nU\n*END STEP\n";
  }
  return out.str();
}

struct EndMotion {
  Vector3 shift, turn;
};

// Of the reference nodes, step after step.
std::vector<EndMotion> results(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<EndMotion> steps;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    int which = 0;
    Vector3 u;
    if (!(words >> which >> u[0] >> u[1] >> u[2])) continue;
    if (which == kReference) steps.push_back({u, Vector3::Zero()});
    if (which == kRotation && !steps.empty()) steps.back().turn = u;
  }
  return steps;
}

TEST(CalculiX, ASolidTubeIsTheBeamThatLinksAreMadeOf) {
  const std::filesystem::path directory =
      std::filesystem::temp_directory_path() / fmt::format("zwidth_tube_{}", getpid());
  std::filesystem::create_directories(directory);
  std::ofstream(directory / "tube.inp") << deck();
  const std::string command =
      fmt::format("cd '{}' && OMP_NUM_THREADS=1 ccx tube > ccx.log 2>&1", directory.string());
  ASSERT_EQ(std::system(command.c_str()), 0) << "see " << directory;
  const std::vector<EndMotion> solid = results(directory / "tube.dat");
  ASSERT_EQ(solid.size(), 4u);

  const Section section = *tube_section(kOuter, kInner);
  const BeamFlexibility beam =
      beam_flexibility(beam_rigidity(section, kModulus, kModulus / (2.0 * (1.0 + kPoisson))), kLength);
  // A force across, one along, a moment across, a twist. The beam leaves out shear, and that ends which are
  // held as a whole cannot narrow: 1.5 % covers both, and is far less than any wrong term would make.
  constexpr double kShear = 0.015, kHeldEnds = 0.006;
  EXPECT_NEAR(solid[0].shift[0] / beam.deflection_y, 1.0, kShear);
  EXPECT_NEAR(solid[0].turn[1] / beam.slope_z, 1.0, kHeldEnds);
  EXPECT_NEAR(solid[1].shift[2] / beam.stretch, 1.0, kHeldEnds);
  EXPECT_NEAR(solid[2].turn[0] / beam.turn_y, 1.0, kHeldEnds);
  EXPECT_NEAR(-solid[2].shift[1] / beam.slope_z, 1.0, kHeldEnds);
  EXPECT_NEAR(solid[3].turn[2] / beam.twist, 1.0, 1e-3);
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace zwidth
