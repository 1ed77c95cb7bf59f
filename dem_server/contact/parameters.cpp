#include "dem_server/contact/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "dem_server/laws/generic.hpp"

namespace tandem::dem {

namespace {

// The largest R* of the spheres [m]: that of the largest sphere on a plane or inside a ball.
double largest_effective_radius(const scene::Dem& dem, double largest_radius) {
  double largest = largest_radius;
  for (const scene::Wall& wall : dem.walls)
    if (const auto* ball = std::get_if<scene::SphereShape>(&wall.shape))
      largest = std::max(largest, radius_inside(std::min(largest_radius, ball->radius), ball->radius));
  return largest;
}

// Distance beyond touching up to which a contact of law `jkr` lasts [m]; it grows with R*.
double adhesion_range(const scene::Dem& dem, const scene::Pair& pair, double e_star, double largest_r_eff) {
  if (dem.contact != scene::ContactLaw::jkr || pair.work_of_adhesion == 0 || largest_r_eff == 0) return 0;
  return Jkr::tear_off *
         std::cbrt(std::pow(2 * std::numbers::pi * pair.work_of_adhesion / e_star, 2) * largest_r_eff);
}

// Smallest radius of the spheres of each material; infinite for materials of walls alone [m].
std::vector<double> smallest_radii(const scene::Dem& dem, const Spheres& spheres) {
  std::vector<double> smallest(dem.materials.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    double& least = smallest[spheres.material[i]];
    least = std::min(least, spheres.radius[i]);
  }
  return smallest;
}

// The law assumes contacts that are small compared with the spheres. The radii are the smallest ones of the
// two materials; walls count as flat.
void expect_small_adhesion(const scene::Dem& dem, const scene::Pair& pair, double e_star, double radius_a,
                           double radius_b) {
  const double smallest_r_eff = 1 / (1 / radius_a + 1 / radius_b);
  if (!std::isfinite(smallest_r_eff)) return;  // two walls
  const double length = adhesion_range(dem, pair, e_star, smallest_r_eff) / Jkr::tear_off;
  if (!(length > smallest_r_eff / 2)) return;
  const std::string& a = dem.materials[pair.a.value].name;
  const std::string& b = dem.materials[pair.b.value].name;
  throw Error(ErrorCode::scene,
              "the adhesion of '" + a + "' and '" + b + "' presses the smallest of them " +
                  scene::rounded(length) +
                  " m into each other, more than half of R* = " + scene::rounded(smallest_r_eff) + " m",
              "dem.pairs",
              "give a work_of_adhesion of at most " +
                  scene::rounded(0.999 * pair.work_of_adhesion * std::pow(smallest_r_eff / 2 / length, 1.5)) +
                  " J/m2, stiffer materials or larger spheres");
}

// Leaves room for spheres that leave the domain within a step, and for a domain that follows a body.
template <class Real>
CentreUnit<Real> centre_unit(LengthUnit<Real> unit, const scene::Dem& dem) {
  double farthest = 0;
  for (int a = 0; a < 3; ++a)
    farthest = std::max({farthest, std::abs(dem.domain.min[a]), std::abs(dem.domain.max[a])});
  const int spare_bits = dem.follows ? 10 : 4;
  const auto centres = CentreUnit<Real>::for_range(unit, farthest, spare_bits);
  if (const double most = std::ldexp(centres.range(), -spare_bits); !(farthest <= most))
    throw Error(ErrorCode::scene,
                "the domain reaches " + scene::rounded(farthest) +
                    " m from the origin, but for spheres of this size mixed precision counts to " +
                    scene::rounded(most) + " m",
                "dem.domain", "give a smaller domain, or \"precision\": \"double\"");
  return centres;
}

// The distinct (material, radius) pairs of the spheres in order of their first sphere; empty when there are
// too many.
template <class Real>
std::vector<std::pair<std::uint32_t, Real>> find_kinds(const Parameters<Real>& p, const Spheres& s) {
  std::vector<std::pair<std::uint32_t, Real>> kinds;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::pair kind{s.material[i], p.radius(p.placed({}, p.unit.count(s.radius[i])))};
    if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) continue;
    if (kinds.size() == max_kinds) return {};
    kinds.push_back(kind);
  }
  return kinds;
}

}  // namespace

template <class Real>
void tabulate_kinds(Parameters<Real>& p, const Spheres& spheres) {
  const auto kinds = find_kinds(p, spheres);
  p.kinds = static_cast<std::uint32_t>(kinds.size());
  for (std::uint32_t a = 0; a < p.kinds; ++a) {
    const auto [m, r] = kinds[a];
    p.kind_material[a] = m;
    p.kind_radius[a] = r;
    p.kind_inertia[a] = p.computed_inertia(m, r);
    for (std::uint32_t b = 0; b < p.kinds; ++b)
      p.kind_pair[a * max_kinds + b] = p.computed_pair(m, r, kinds[b].first, kinds[b].second);
    for (std::uint32_t wall = 0; wall < p.materials; ++wall)
      p.kind_wall[a * max_materials + wall] = p.computed_wall(m, r, wall);
  }
}

template <class Real>
std::vector<std::uint32_t> kinds_of(const Parameters<Real>& p, const Spheres& s) {
  if (p.kinds == 0) return s.material;
  const auto kinds = find_kinds(p, s);
  std::vector<std::uint32_t> of;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::pair kind{s.material[i], p.radius(p.placed({}, p.unit.count(s.radius[i])))};
    of.push_back(static_cast<std::uint32_t>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin()));
  }
  return of;
}

Periods periods_for_spheres(const scene::Dem& dem, double largest_radius, double largest_skin) {
  Periods p = periods_of(dem);
  const auto unit = LengthUnit<float>::for_lengths(counted_length(largest_radius, largest_skin));
  for (int a = 0; a < 3; ++a)
    p.length[a] = std::nearbyint(p.length[a] * unit.inverse) * static_cast<double>(unit.size);
  return p;
}

template <class Real>
Parameters<Real> make_parameters(const scene::Scene& scene, const Spheres& spheres, double largest_skin) {
  const double largest_radius =
      spheres.size() == 0 ? 0 : *std::max_element(spheres.radius.begin(), spheres.radius.end());
  const scene::Dem& dem = *scene.dem;
  if (dem.materials.size() > max_materials)
    throw Error(
        ErrorCode::scene, std::to_string(dem.materials.size()) + " materials", "dem.materials",
        "this build holds " + std::to_string(max_materials) + "; raise max_materials in parameters.hpp");
  Parameters<Real> p;
  p.materials = static_cast<std::uint32_t>(dem.materials.size());
  p.law = static_cast<std::uint32_t>(dem.contact);
  p.rolling = dem.rolling;
  p.twisting = dem.twisting;
  p.gravity = scene.gravity;
  p.unit = LengthUnit<Real>::for_lengths(counted_length(largest_radius, largest_skin));
  p.centres = centre_unit(p.unit, dem);
  p.domain_min = p.centres.of(dem.domain.min);
  p.domain_max = p.centres.of(dem.domain.max);
  p.periods = periods_for_spheres(dem, largest_radius, largest_skin);
  for (int a = 0; a < 3; ++a) {
    p.period[a] = p.unit.count(p.periods.length[a]);
    if (!(p.periods.length[a] > 0)) continue;
    using Coordinate = std::remove_cvref_t<decltype(p.domain_min.x)>;
    p.domain_min[a] = std::numeric_limits<Coordinate>::lowest();
    p.domain_max[a] = std::numeric_limits<Coordinate>::max();
  }
  const double largest_r_eff = largest_effective_radius(dem, largest_radius);
  const std::vector<double> smallest = smallest_radii(dem, spheres);
  double stiffest = 0, stiffest_spring = 0, heaviest = 0, range = 0;
  for (std::size_t m = 0; m < dem.materials.size(); ++m) {
    const double per_volume = 4.0 / 3.0 * std::numbers::pi * dem.materials[m].density;
    p.mass_per_volume[m] = static_cast<Real>(per_volume);
    heaviest = std::max(heaviest, per_volume * largest_radius * largest_radius * largest_radius);
  }
  for (const scene::Pair& pair : dem.pairs) {
    const scene::Material &a = dem.materials[pair.a.value], &b = dem.materials[pair.b.value];
    const double e_star = effective_young(a, b);
    const PairConstants<double> of_law = pair_constants(dem.contact, pair, a, b);
    const auto real = [](double x) { return static_cast<Real>(x); };
    const PairConstants<Real> c{{real(of_law.c.k_n), real(of_law.c.c_n), real(of_law.c.k_t),
                                 real(of_law.c.c_t), real(of_law.c.friction), 0},
                                of_law.sized};
    p.pair[pair.a.value * max_materials + pair.b.value] = c;
    p.pair[pair.b.value * max_materials + pair.a.value] = c;
    range = std::max(range, adhesion_range(dem, pair, e_star, largest_r_eff));
    expect_small_adhesion(dem, pair, e_star, smallest[pair.a.value], smallest[pair.b.value]);
    stiffest_spring = std::max(stiffest_spring, pair.spring_stiffness);
    stiffest = std::max({stiffest, 4.0 / 3.0 * e_star * std::sqrt(largest_radius), pair.normal_stiffness});
  }
  if (2 * range > largest_skin)
    throw Error(
        ErrorCode::scene,
        "adhesion reaches " + scene::rounded(range) + " m beyond touching, more than half the skin of " +
            scene::rounded(largest_skin) + " m of the neighbour list",
        "dem.skin",
        "give a skin of at least " + scene::rounded(2.01 * range) + " m, or a smaller work_of_adhesion");
  p.range = p.unit.count(range * (1 + 1e-6));
  // Range of the exact sums, the largest of: every sphere pressed a tenth of its radius into one wall; a
  // thousand times its weight on it; every sphere leaving the domain at 1e4 m/s. Within that range the
  // quantum is below 1e-15 of the sum.
  const double n = static_cast<double>(std::max<std::size_t>(spheres.size(), 1));
  const double depth = 0.1 * largest_radius;
  const double single = std::max({stiffest * depth * std::sqrt(depth), stiffest_spring * depth,
                                  1e3 * heaviest * norm(scene.gravity), 1e4 * heaviest});
  p.force = Quantum::for_range(n * single);
  // Torques on the ground are about the origin of the world, which may be far from the domain.
  Vec3d farthest;
  for (int axis = 0; axis < 3; ++axis)
    farthest[axis] = std::max(std::abs(dem.domain.min[axis]), std::abs(dem.domain.max[axis]));
  p.torque = Quantum::for_range(n * single * std::max(norm(dem.domain.max - dem.domain.min), norm(farthest)));
  p.force_limit = n * single;
  p.speed_limit = static_cast<float>(largest_speed);
  tabulate_kinds(p, spheres);
  return p;
}

template <class Real>
std::vector<PairExtras<Real>> make_pair_extras(const scene::Scene& scene) {
  std::vector<PairExtras<Real>> extras(max_materials * max_materials);
  for (const scene::Pair& pair : scene.dem->pairs) {
    const double adhesion = scene.dem->contact == scene::ContactLaw::jkr    ? pair.work_of_adhesion
                            : scene.dem->contact == scene::ContactLaw::sjkr ? pair.cohesion_energy_density
                                                                            : 0;
    const PairExtras<Real> e{
        static_cast<Real>(adhesion),
        {static_cast<Real>(pair.rolling_friction), static_cast<Real>(pair.rolling_damping)},
        static_cast<Real>(pair.wear_coefficient)};
    extras[pair.a.value * max_materials + pair.b.value] = e;
    extras[pair.b.value * max_materials + pair.a.value] = e;
  }
  return extras;
}

template std::vector<PairExtras<float>> make_pair_extras(const scene::Scene&);
template std::vector<PairExtras<double>> make_pair_extras(const scene::Scene&);
template Parameters<float> make_parameters(const scene::Scene&, const Spheres&, double);
template Parameters<double> make_parameters(const scene::Scene&, const Spheres&, double);
template void tabulate_kinds(Parameters<float>&, const Spheres&);
template void tabulate_kinds(Parameters<double>&, const Spheres&);
template std::vector<std::uint32_t> kinds_of(const Parameters<float>&, const Spheres&);
template std::vector<std::uint32_t> kinds_of(const Parameters<double>&, const Spheres&);

}  // namespace tandem::dem
