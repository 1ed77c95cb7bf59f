// The lists hold all pairs of spheres within reach and skin, each pair once, however few cells the domain
// has.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dem_server/contact/view.hpp"
#include "tests/support/particle_run.hpp"

namespace tandem::test {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

constexpr double radius = 0.004, skin = 0.016, reach = 2 * radius + skin;  // [m]; cells are as wide as reach

struct Domain {
  std::array<int, 3> cells;
  std::vector<std::string> periodic;
  const char* variant = nullptr;   // dem.variant; null: chosen by the engine
  std::vector<double> sizes = {};  // of some spheres [radii]; these are in coarser levels

  std::array<double, 3> size() const {
    std::array<double, 3> s{};
    // Cells of a period are slightly wider, because a period is a whole number of them.
    for (std::size_t a = 0; a < 3; ++a) s[a] = (cells[a] + 0.05) * reach;
    return s;
  }
  std::string scene() const {
    const auto [x, y, z] = size();
    nlohmann::json dem = {
        {"materials", {{{"name", "m"}, {"density", 2500}, {"young", 1e7}, {"poisson", 0.25}}}},
        {"pairs", {{{"a", "m"}, {"b", "m"}, {"restitution", 0.6}, {"friction", 0.4}}}},
        {"contact", "hertz_mindlin"},
        {"skin", skin},
        {"particles",
         {{{"name", "p"},
           {"material", "m"},
           {"radius", radius},
           {"fill",
            {{"type", "lattice"}, {"min", {0, 0, 0}}, {"max", {x, y, z}}, {"spacing", 2.2 * radius}}}}}},
        {"domain", {{"min", {0, 0, 0}}, {"max", {x, y, z}}, {"periodic", periodic}}}};
    if (variant != nullptr) dem["variant"] = variant;
    return nlohmann::json{{"tandem", "1.0"},
                          {"name", "lists"},
                          {"end_time", 1},
                          {"gravity", {0, 0, 0}},
                          {"coupling", {{"window", 0.001}}},
                          {"dem", dem}}
        .dump();
  }
};
void PrintTo(const Domain& d, std::ostream* out) {
  *out << d.cells[0] << " x " << d.cells[1] << " x " << d.cells[2] << " cells, " << d.periodic.size()
       << " periodic axes, " << d.sizes.size() << " larger spheres";
}

class Lists : public testing::TestWithParam<Domain> {
 protected:
  // Anywhere in the domain without overlap.
  void scatter(particles::Spheres& s) const {
    const std::array<double, 3> size = GetParam().size();
    const std::vector<double>& sizes = GetParam().sizes;
    std::mt19937 random(7);
    std::vector<Vec3d> placed;
    std::vector<double> radii;
    for (int tries = 0; tries < 20'000 && placed.size() < std::min<std::size_t>(s.size(), 400); ++tries) {
      Vec3d x;
      for (int a = 0; a < 3; ++a)
        x[a] = std::uniform_real_distribution<double>(0, size[std::size_t(a)])(random);
      const double r = radius * (placed.size() < sizes.size() ? sizes[placed.size()] : 1);
      bool apart = true;
      for (std::size_t k = 0; k < placed.size(); ++k)
        apart = apart && distance(x, placed[k]) > 1.005 * (r + radii[k]);
      if (!apart) continue;
      placed.push_back(x);
      radii.push_back(r);
    }
    s.position = placed;
    s.radius = radii;
    for (auto* column : {&s.velocity, &s.spin}) column->assign(placed.size(), {});
    s.material.resize(placed.size());
    s.id.resize(placed.size());
  }
  double distance(Vec3d a, Vec3d b) const {
    const std::array<double, 3> size = GetParam().size();
    Vec3d d = a - b;
    for (const std::string& axis : GetParam().periodic) {
      const int k = axis[0] - 'x';
      d[k] -= size[std::size_t(k)] * std::round(d[k] / size[std::size_t(k)]);
    }
    return norm(d);
  }
  Pairs expected(const particles::Spheres& s) const {
    Pairs pairs;
    for (std::uint32_t i = 0; i < s.size(); ++i)
      for (std::uint32_t j = i + 1; j < s.size(); ++j)
        if (distance(s.position[i], s.position[j]) < s.radius[i] + s.radius[j] + skin) pairs.insert({i, j});
    return pairs;
  }
};

TEST_P(Lists, HoldAllPairsWithinReachOnce) {
  ParticleRun run(GetParam().scene(), particles::Backend::cpu, 1, [&](particles::Spheres& s) { scatter(s); });
  run.advance(1, 1e-9);
  const Arrays arrays = written(run);
  const auto start = array_of<std::uint32_t>(arrays, "pairs.start"), id = ids_of(arrays);
  const auto entry = array_of<dem::Neighbour>(arrays, "pairs.entry");
  Pairs listed;
  for (std::uint32_t i = 0; i < id.size(); ++i)
    for (std::uint32_t k = start[i]; k < start[i + 1]; ++k) {
      const std::uint32_t j = entry[k].index();
      EXPECT_GT(j, i);
      EXPECT_TRUE(listed.insert(std::minmax(id[i], id[j])).second) << "twice";
    }
  const Pairs all = expected(run.spheres);
  EXPECT_GT(all.size(), id.size() / 4);
  EXPECT_EQ(listed, all);
}

std::vector<Domain> domains() {
  std::vector<Domain> all;
  for (int x = 1; x <= 9; ++x) all.push_back({{x, 1 + x * 5 % 9, 1 + x * 7 % 9}, {}});
  for (int x = 3; x <= 9; ++x) all.push_back({{x, 3 + x * 3 % 7, 3 + x * 5 % 7}, {"x", "y", "z"}});
  all.push_back({{5, 4, 6}, {"x"}});
  all.push_back({{4, 8, 3}, {"z"}});
  all.push_back({{7, 5, 2}, {}, "generic"});
  for (const char* variant : {static_cast<const char*>(nullptr), "generic"}) {
    all.push_back({{9, 8, 7}, {}, variant, {12, 5, 5, 5, 5, 5, 5, 5}});
    all.push_back({{4, 9, 9}, {}, variant, {15}});
  }
  all.push_back({{13, 12, 14}, {"x", "y", "z"}, nullptr, {10, 4.1, 4, 4, 4, 4, 4, 4}});
  all.push_back({{9, 12, 10}, {"y"}, nullptr, {4, 10, 4, 4, 4, 4, 4, 4}});
  // The shortest admissible period.
  for (const double largest : {2.5, 4., 8.}) {
    const int cells = static_cast<int>(3 * (2 * largest * radius + skin) / reach) + 1;
    all.push_back({{cells, cells, cells}, {"x", "y", "z"}, nullptr, {largest, 2.2, 1.9}});
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(Domains, Lists, testing::ValuesIn(domains()));

}  // namespace
}  // namespace tandem::test
