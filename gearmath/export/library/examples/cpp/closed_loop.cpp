// Cut with wrong settings, measure, and find the settings that were wrong.
#include <cmath>
#include <cstdio>
#include <utility>

#include "bevel_machine.hpp"

using namespace gearmath;

// The concave flank of the pinion of NASA TP-3096, 12 x 36 teeth.
static const Settings nominal = {74.874171554126, -1.1159989619985908, 0.0, 0.0, 3.9262277584, 0.296487393552,
    1.021857658688, 0.2943788667042891, 3.2426985355495, 0.0, 75.326783002724, 0.31495635289994856};

int main()
try {
  Measurement measurement(nominal, Flank::concave);
  const double toe[3][2] = {{67.466, 21.779}, {66.827, 23.698}, {66.187, 25.617}};
  const double heel[3][2] = {{86.858, 27.861}, {85.974, 30.514}, {85.090, 33.168}};
  for (int row = 0; row < 3; ++row) {
    Vector start = {1.22 + 1.9 * row, 2.176, -0.018};
    for (int column = 0; column < 5; ++column) {
      const double t = column / 4.0;
      measurement.add_place(toe[row][0] + t * (heel[row][0] - toe[row][0]), toe[row][1] + t * (heel[row][1] - toe[row][1]),
          start);
      start = measurement.points().back().contact;
    }
  }

  const Motion motion(500.0);
  const Axes axes = motion.at(nominal, 0.0);
  std::printf("X %.5f Y %.5f Z %.5f A %.6f B %.6f\n", axes[0], axes[1], axes[2], axes[3], axes[4]);

  // what the machine cuts with errors of its settings, touched by a tip of 1 mm
  Settings wrong = nominal;
  wrong[0] += 0.03;    // radial distance
  wrong[1] -= 0.0004;  // cradle angle
  wrong[7] += 0.0003;  // root angle
  std::vector<double> measured;
  for (std::size_t k = 0; k < measurement.points().size(); ++k) {
    const FlankPoint &at = measurement.points()[k];
    Vector contact, tip;
    double left, residual;
    Settings sensitivity;
    require(gm_flank_on_line(at.contact.data(), wrong.data(), measurement.side(), at.point.data(), at.normal.data(),
                contact.data(), &left, sensitivity.data(), &residual),
        "flank of wrong settings");
    for (int j = 0; j < 3; ++j) tip[j] = at.point[j] + (left + 1.0) * at.normal[j];
    measured.push_back(measurement.deviation(k, tip, 1.0));
  }

  ErrorCompensation compensation(measurement, {{0, 1.0}, {1, 0.02}, {7, 0.02}});
  const Settings found = compensation.explain(measured);
  double worst = 0.0;
  for (std::size_t j = 0; j < found.size(); ++j) worst = std::max(worst, std::abs(found[j] - wrong[j]));
  std::printf("%zu touches: settings found to %.1e\n", measured.size(), worst);

  try {
    motion.at(nominal, std::nan(""));
  } catch (const Error &error) {
    std::printf("%s\n", error.what());
    return error.status == GM_E_DOMAIN && worst < 1e-6 ? 0 : 1;
  }
  return 1;
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
