#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/description/catalogue.h"

/// Published figures beside computed ones.

namespace zwidth {

/// The unit in which a source prints a figure.
struct PrintedUnit {
  std::string name;     ///< "mm"
  std::string si_name;  ///< "m"
  double factor = 1.0;  ///< SI value of one of it
};

/// What another reading of the source gives for the same figure.
struct OtherReading {
  std::string label;   ///< "as it is", "with the printed k1"
  double value = 0.0;  ///< [SI]
  std::string how;     ///< in words
};

/// A published figure and what comes out of the device file.
struct ReproducedFigure {
  std::string id;      ///< stable: "delta.T4.8.d5"
  std::string source;  ///< heading it stands under: "Table 4.8 - capstan drive"
  std::string what;    ///< in words, with the source's symbol
  PrintedUnit unit;
  int decimals = 0;       ///< printed
  double printed = 0.0;   ///< [SI]
  double computed = 0.0;  ///< as the source computed it [SI]
  double tolerance =
      0.0;  ///< half a unit of the last printed digit, or wider where the source says "approximately" [SI]
  std::string reading;  ///< how the source must have computed it, where that is not what it says; else empty
  std::optional<OtherReading> other;

  double difference() const { return computed - printed; }
  bool ok() const;  ///< within the tolerance; a figure that is not a number is not
};

/// Something that a source states and that does not come out, or is printed wrongly.
struct Erratum {
  std::string where;    ///< "Table 4.10"
  std::string printed;  ///< what it says
  std::string right;    ///< what is right, with our number where there is one
  std::string reason;   ///< how that is known
};

/// What comes out when we search where a source has searched.
struct SearchFinding {
  std::string id;      ///< stable: "r-cube.search.dominated"
  std::string source;  ///< heading it stands under
  std::string what;    ///< in words
  std::string unit;    ///< SI; empty for numbers
  int decimals = 0;    ///< shown
  double value = 0.0;  ///< [SI]
  std::optional<double> at_least,
      at_most;  ///< what a search that has converged reaches; neither: for information

  bool ok() const;
};

struct Reproduction {
  std::string device;
  std::string source;
  std::vector<ReproducedFigure> figures;   ///< in the source's order
  std::vector<SearchFinding> search = {};  ///< beside the source's own search
  std::vector<Erratum> not_reproduced;     ///< numbers that the source's own data do not give
  std::vector<Erratum> errata;             ///< misprints and slips, already corrected in the figures above
  std::vector<std::string> measured_only;  ///< what only a bench can tell
};

/// Collects the figures of one source; `under` sets the heading that the next ones stand under.
class Figures {
 public:
  explicit Figures(std::string device) : device_(std::move(device)) {}

  void under(std::string heading) { heading_ = std::move(heading); }
  /// A figure printed with `decimals` digits after the point in `unit`, and the computed one [SI]. The
  /// tolerance is half a unit of the last digit; widen it in what comes back where the source is less exact.
  ReproducedFigure& add(const std::string& id, const std::string& what, const PrintedUnit& unit, int decimals,
                        double printed, double computed_si);

  std::vector<ReproducedFigure> take() { return std::move(figures_); }

 private:
  std::string device_;
  std::string heading_;
  std::vector<ReproducedFigure> figures_;
};

/// Marks a figure that only one reading of the source gives, and says what another reading has [SI].
void read_otherwise(ReproducedFigure& figure, std::string reading, std::string label, double value,
                    std::string how);

/// Neal 2015.
Reproduction reproduce_delta(const Catalogue& catalogue);
/// Singh, Saha and Manivannan.
Reproduction reproduce_five_bar(const Catalogue& catalogue);
/// Görgülü 2018.
Reproduction reproduce_r_cube(const Catalogue& catalogue);
/// Baser 2006.
Reproduction reproduce_seven_dof(const Catalogue& catalogue);
/// Akhoondi Asadi 2017: the three prototypes share one source.
Reproduction reproduce_pneumatic(const Catalogue& catalogue);

}  // namespace zwidth
