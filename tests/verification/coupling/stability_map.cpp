// stability_map > FILE.csv: growth per window of every scheme over omega H and the mass of the bed, measured
// through the coordinator. A body of 1 kg on a contact (k = 1, zeta = 0.05); the bed, of r kg, stands on a
// spring and damper of the same k and d (r = 0: a wall). stability_map.py draws it.
#include <cmath>
#include <cstdio>

#include "tests/doubles/coupled_oscillator.hpp"

namespace {

using namespace tandem;
using scene::LoadShape;
using scene::PathShape;
using scene::Scheme;

struct Line {
  const char* name;
  Scheme scheme;
  LoadShape load;
  PathShape path;
};

constexpr Line lines[] = {
    {"parallel", Scheme::parallel, LoadShape::mean, PathShape::linear},
    {"mbd_first", Scheme::mbd_first, LoadShape::mean, PathShape::linear},
    {"mbd_first, end force", Scheme::mbd_first, LoadShape::end, PathShape::linear},
    {"dem_first", Scheme::dem_first, LoadShape::mean, PathShape::linear},
    {"dem_first, second order", Scheme::dem_first, LoadShape::linear, PathShape::quadratic},
    {"linear_implicit", Scheme::linear_implicit, LoadShape::mean, PathShape::linear},
    {"implicit", Scheme::implicit, LoadShape::mean, PathShape::linear},
    {"implicit, linear load", Scheme::implicit, LoadShape::linear, PathShape::linear},
};

constexpr double zeta = 0.05;
constexpr int columns = 31, rows = 18;

// -1: the iteration does not converge.
double growth(const Line& line, double ratio, double omega_H) {
  scene::Coupling how;
  how.scheme = line.scheme;
  how.load = line.load;
  how.path = line.path;
  how.window = 1e6;
  if (line.scheme == Scheme::implicit)
    how.iteration = scene::Iteration{{.length = 1e-12, .max_iterations = 100, .tolerance = 1e-9}};
  test::OscillatorBedParameters bed{ratio, 1, 2 * zeta, 1, 2 * zeta};
  if (ratio == 0) bed.stiffness = bed.damping = 0;
  test::CoupledOscillator pair({}, bed, how);
  try {
    return pair.growth(omega_H);
  } catch (const Error&) {
    return -1;
  }
}

}  // namespace

int main() {
  std::printf("scheme,mass_ratio,omega_H,growth\n");
  for (const Line& line : lines)
    for (int row = 0; row < rows; ++row) {
      const double ratio = row == 0 ? 0 : std::pow(10, -3 + 6.0 * (row - 1) / (rows - 2));
      for (int column = 0; column < columns; ++column) {
        const double omega_H = std::pow(10, -1.5 + 3.0 * column / (columns - 1));
        std::printf("\"%s\",%.6g,%.6g,%.9g\n", line.name, ratio, omega_H, growth(line, ratio, omega_H));
      }
      std::fflush(stdout);
    }
}
