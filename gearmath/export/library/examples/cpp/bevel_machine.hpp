// A bevel gear milling machine in three parts, as controls are divided: motion, measurement, error compensation.
//
// Lengths are mm, angles rad; what the library refuses is thrown as gearmath::Error.
#ifndef BEVEL_MACHINE_HPP
#define BEVEL_MACHINE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "gearmath.h"

namespace gearmath {

using Settings = std::array<double, 12>;
using Vector = std::array<double, 3>;
using Axes = std::array<double, 5>;

class Error : public std::runtime_error {
 public:
  Error(const std::string &what, int status) : std::runtime_error(what + ": " + gm_error_text(status)), status(status) {}
  const int status;
};

inline void require(int status, const char *what)
{
  if (status != GM_OK) throw Error(what, status);
}

// Which flank: the outer blade cuts the concave one, the inner blade the convex one.
enum class Flank { concave = 1, convex = -1 };

// A point of a flank, with where on the cutter and at which cradle rotation it is generated.
struct FlankPoint {
  Vector contact, point, normal;
};

// Where the axes of the vertical machine stand.
class Motion {
 public:
  explicit Motion(double pivot_height, Vector pivot_offset = {}) : height_(pivot_height), offset_(pivot_offset) {}

  Axes at(const Settings &settings, double theta) const
  {
    Axes axes;
    require(gm_axis_transform(settings.data(), theta, height_, offset_.data(), axes.data()), "axis positions");
    return axes;
  }

 private:
  double height_;
  Vector offset_;
};

// Nominal points of one flank, and what a probe finds at them.
class Measurement {
 public:
  Measurement(const Settings &nominal, Flank flank) : nominal_(nominal), side_(static_cast<double>(flank)) {}

  // Adds the nominal point at a place on the blank; the point before is the start of the search.
  void add_place(double axial, double radial, const Vector &start)
  {
    FlankPoint found;
    double residual;
    require(gm_flank_point(start.data(), nominal_.data(), side_, axial, radial, found.contact.data(),
                found.point.data(), found.normal.data(), &residual),
        "flank point");
    if (!(residual < 1e-8)) throw std::runtime_error("flank point: the search did not settle");
    points_.push_back(found);
  }

  // Deviation of a touched point from nominal, along the normal; positive is metal left on.
  double deviation(std::size_t k, const Vector &tip_center, double tip_radius) const
  {
    const FlankPoint &at = points_[k];
    double found;
    require(gm_point_deviation(tip_center.data(), tip_radius, at.point.data(), at.normal.data(), &found), "deviation");
    return found;
  }

  const std::vector<FlankPoint> &points() const { return points_; }
  const Settings &nominal() const { return nominal_; }
  double side() const { return side_; }

 private:
  Settings nominal_;
  double side_;
  std::vector<FlankPoint> points_;
};

// A setting that may be changed, and by how much at most.
struct Variable {
  std::size_t index;
  double bound;
};

// The settings that explain measured deviations: bounded Levenberg-Marquardt steps on the exact surface.
class ErrorCompensation {
 public:
  ErrorCompensation(const Measurement &measurement, std::vector<Variable> variables)
      : measurement_(measurement), variables_(std::move(variables)) {}

  // The settings with which the flank would deviate as measured.
  Settings explain(const std::vector<double> &measured)
  {
    std::array<double, 12> v{}, low{}, high{}, step;
    for (std::size_t j = 0; j < variables_.size(); ++j) low[j] = -1.0, high[j] = 1.0;
    double damping = 1e-6, promised;
    for (int k = 0; k < 60; ++k) {
      const double now = linearize(measured, v);
      require(gm_compensation_step(normal_.data(), gradient_.data(), v.data(), low.data(), high.data(), damping,
                  step.data(), &promised),
          "compensation step");
      std::array<double, 12> next = v;
      double length = 0.0;
      for (std::size_t j = 0; j < 12; ++j) next[j] += step[j], length = std::max(length, std::abs(step[j]));
      if (length < 1e-13) break;
      if (sum_of_squares(measured, next) < now)
        v = next, damping = std::max(damping / 10.0, 1e-12);
      else if ((damping *= 10.0) > 1e8)
        break;
    }
    return changed(v);
  }

 private:
  Settings changed(const std::array<double, 12> &v) const
  {
    Settings settings = measurement_.nominal();
    for (std::size_t j = 0; j < variables_.size(); ++j) settings[variables_[j].index] += v[j] * variables_[j].bound;
    return settings;
  }

  double model(const Settings &settings, std::size_t k, Settings &sensitivity) const
  {
    const FlankPoint &at = measurement_.points()[k];
    Vector contact;
    double deviation, residual;
    require(gm_flank_on_line(at.contact.data(), settings.data(), measurement_.side(), at.point.data(),
                at.normal.data(), contact.data(), &deviation, sensitivity.data(), &residual),
        "flank on its normal");
    return deviation;
  }

  double sum_of_squares(const std::vector<double> &measured, const std::array<double, 12> &v) const
  {
    const Settings settings = changed(v);
    Settings unused;
    double sum = 0.0;
    for (std::size_t k = 0; k < measured.size(); ++k) sum += std::pow(model(settings, k, unused) - measured[k], 2);
    return sum;
  }

  // Normal equations at v; returns the sum of squares there.
  double linearize(const std::vector<double> &measured, const std::array<double, 12> &v)
  {
    const Settings settings = changed(v);
    double sum = 0.0;
    normal_.fill(0.0);
    gradient_.fill(0.0);
    for (std::size_t k = 0; k < measured.size(); ++k) {
      Settings sensitivity;
      const double left = model(settings, k, sensitivity) - measured[k];
      sum += left * left;
      for (std::size_t i = 0; i < variables_.size(); ++i) {
        const double slope = sensitivity[variables_[i].index] * variables_[i].bound;
        gradient_[i] += slope * left;
        for (std::size_t j = 0; j < variables_.size(); ++j)
          normal_[12 * i + j] += slope * sensitivity[variables_[j].index] * variables_[j].bound;
      }
    }
    return sum;
  }

  const Measurement &measurement_;
  std::vector<Variable> variables_;
  std::array<double, 144> normal_{};
  std::array<double, 12> gradient_{};
};

}  // namespace gearmath

#endif
