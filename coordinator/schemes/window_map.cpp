#include "coordinator/schemes/window_map.hpp"

#include <Eigen/LU>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

#include "common/math/spectral_radius.hpp"

namespace tandem::launch {
namespace {

using scene::LoadShape;

// Growth below this counts as zero: eigenvalues of modulus one have round-off.
constexpr double growth_tolerance = 1e-7;

// The end of a path, and a load over a window.
struct End {
  double x = 0, v = 0;
};
struct Load {
  double mean = 0, moment = 0, end = 0;  // moment: (1/H) integral of (t - t_mid) F dt
};

// F = -x - 2 zeta v along the cubic Hermite path between the ends.
Load contact(End begin, End end, double H, double zeta) {
  const double d = 2 * zeta;
  const double mean_x = (begin.x + end.x) / 2 + H * (begin.v - end.v) / 12;
  const double moment_x = H * ((end.x - begin.x) / 10 - H * (begin.v + end.v) / 120);
  const double moment_v = (begin.x + end.x) / 2 - mean_x;
  return {-mean_x - d * (end.x - begin.x) / H, -moment_x - d * moment_v, -end.x - d * end.v};
}

// Motion with a constant acceleration.
End coast(End begin, double acceleration, double H) {
  return {begin.x + H * begin.v + H * H / 2 * acceleration, begin.v + H * acceleration};
}

// Change of a load per time.
double slope(const Load& load, double H) {
  return 12 * load.moment / (H * H);
}

// Motion of the body on its support under a load that is constant or linear in time.
class Body {
 public:
  Body(const Support& support, double H) : H_(H), support_(support) {
    if (support.empty()) return;
    Eigen::Matrix4d rate = Eigen::Matrix4d::Zero();  // of x, v, load, slope
    rate(0, 1) = rate(1, 2) = rate(2, 3) = 1;
    rate(1, 0) = -support.stiffness;
    rate(1, 1) = -support.damping;
    map_ = (H * rate).exp();
  }
  End move(End begin, const Load& load) const {
    if (support_.empty())
      return {begin.x + H_ * begin.v + H_ * H_ / 2 * load.mean - H_ * load.moment, begin.v + H_ * load.mean};
    const double s = slope(load, H_);
    const Eigen::Vector4d end = map_ * Eigen::Vector4d(begin.x, begin.v, load.mean - s * H_ / 2, s);
    return {end[0], end[1]};
  }
  double acceleration(End at, double load) const {
    return load - support_.stiffness * at.x - support_.damping * at.v;
  }

 private:
  double H_;
  Support support_;
  Eigen::Matrix4d map_;
};

Load shaped(Load load, LoadShape shape) {
  if (shape == LoadShape::end) return {load.end, 0, load.end};
  if (shape == LoadShape::mean) load.moment = 0;
  return load;
}

}  // namespace

WindowState advance_model(const scene::Coupling& how, double H, double zeta, const Support& support,
                          const WindowState& state) {
  const Body body(support, H);
  const End begin{state[0], state[1]};
  const double acceleration = how.path == scene::PathShape::quadratic ? state[2] : 0;
  const Load held{state[3], 0, 0};
  const End predicted = coast(begin, acceleration, H);

  Load load, applied;  // of the contact, on the body
  switch (how.scheme) {
    case scene::Scheme::parallel:
      load = contact(begin, predicted, H, zeta);
      applied = held;
      break;
    case scene::Scheme::mbd_first:
      applied = held;
      load = contact(begin, body.move(begin, applied), H, zeta);
      break;
    case scene::Scheme::dem_first:
      load = contact(begin, predicted, H, zeta);
      applied = shaped(load, how.load);
      break;
    case scene::Scheme::linear_implicit: {
      load = contact(begin, predicted, H, zeta);
      applied = shaped(load, how.load);
      // The load falls by H K + D times the change of velocity, which is linear in the load.
      const double relief = H + 2 * zeta, without = body.move(begin, {0, applied.moment, 0}).v,
                   per_load = body.move({}, {1, 0, 0}).v;
      applied.mean = (applied.mean - relief * (without - predicted.v)) / (1 + relief * per_load);
      break;
    }
    case scene::Scheme::implicit: {
      // The load L = g(L) along the path that it causes. g is affine: two differences give its matrix.
      // A mean load is combined with a path of constant velocity.
      const auto along = [&](const Load& cause) {
        const End end = body.move(begin, cause);
        if (how.load != LoadShape::mean) return contact(begin, end, H, zeta);
        const double v = (end.x - begin.x) / H;
        return contact({begin.x, v}, {end.x, v}, H, zeta);
      };
      const auto image = [&](Eigen::Vector2d l) {
        const Load r = shaped(along({l[0], l[1], 0}), how.load);
        return Eigen::Vector2d(r.mean, r.moment);
      };
      const Eigen::Vector2d g0 = image(Eigen::Vector2d::Zero());
      Eigen::Matrix2d matrix;
      for (int i = 0; i < 2; ++i) matrix.col(i) = image(Eigen::Vector2d::Unit(i)) - g0;
      const Eigen::Vector2d l = (Eigen::Matrix2d::Identity() - matrix).partialPivLu().solve(g0);
      applied = {l[0], l[1], 0};
      load = along(applied);
      break;
    }
  }
  const End end = body.move(begin, applied);
  return {end.x, end.v, body.acceleration(end, applied.mean + slope(applied, H) * H / 2),
          shaped(load, how.load).mean};
}

double growth(const scene::Coupling& how, double omega_H, double zeta, const Support& support) {
  std::vector<double> map;  // column by column
  for (std::size_t i = 0; i < WindowState{}.size(); ++i) {
    WindowState unit{};
    unit[i] = 1;
    const WindowState image = advance_model(how, omega_H, zeta, support, unit);
    map.insert(map.end(), image.begin(), image.end());
  }
  return spectral_radius(map);
}

double critical_omega_H(const scene::Coupling& how, double zeta, const Support& support) {
  const auto stable = [&](double s) { return growth(how, s, zeta, support) <= 1 + growth_tolerance; };
  // The first value at which stability is lost, to 3 %, then refined by bisection.
  double low = 1e-2;
  if (!stable(low)) return 0;
  double high = low;
  while (stable(high *= 1.03)) {
    low = high;
    if (high > 100) return std::numeric_limits<double>::infinity();
  }
  while (high - low > 1e-4 * low) {
    const double middle = (low + high) / 2;
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace tandem::launch
