// Reads a device, by name or from a file, says what it is made of, and asks for one posture of it.
//
//   01_read_a_device [DEVICE]

#include <cstdio>
#include <exception>

#include "zwidth/description/read.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

int main(int argc, char** argv) {
  using namespace zwidth;
  try {
    // Whatever is wrong with the file is thrown here, all of it at once, with file, line, key, value and rule.
    const Catalogue catalogue = Catalogue::load();
    const Description device = read_description(argc > 1 ? argv[1] : "delta", {}, catalogue);

    std::printf("%s: %s\n", device.name.c_str(), device.title.c_str());
    std::printf("  from %s\n", device.source.c_str());
    for (const DriveDescription& drive : device.drives) {
      std::printf("  driven by %s, %g mN m\n", drive.motor.info.title.c_str(),
                  1e3 * drive.motor.nominal_torque);
    }

    // A posture exists only when the loops are closed, so nothing can be asked too early.
    const Mechanism mechanism(device);
    ActiveVector middle(mechanism.active_count());
    for (int i = 0; i < mechanism.active_count(); ++i) middle[i] = mechanism.active_range(i).middle();
    const Solution solution = solve_forward(mechanism, middle);
    if (!solution) {
      std::printf("  the middle of the joint ranges is %s\n", to_string(solution.status));
      return 1;
    }
    const Vector3 tool = 1e3 * solution.posture->tool().position;
    std::printf("  with the joints in the middle the tool is at %.1f, %.1f, %.1f mm\n", tool.x(), tool.y(),
                tool.z());
    std::printf("  and the condition number is %.3f\n",
                dexterity(jacobian(*solution.posture)).condition_number);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
