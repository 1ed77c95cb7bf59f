#include "dem_server/coupling/traffic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "dem_server/laws/particle_names.hpp"
#include "particles/io/random.hpp"
#include "particles/serving/sensors.hpp"

namespace tandem::dem {
namespace {

constexpr std::size_t at_once = 64;  // spheres that the engine checks together
constexpr std::size_t tries = 8;     // positions that are tried for a sphere before one window

// The positions that are tried for sphere i of an inlet before the window that begins at `now`.
void append_positions(const Inlet& inlet, std::size_t i, Nanoseconds now, Vec3d shift,
                      std::vector<Ball>& positions) {
  // Different spheres and times need independent random numbers: the mixing places their streams far apart.
  const auto mixed = [](std::uint64_t a, std::uint64_t b) {
    return Random(a ^ (b * 0x9e3779b97f4a7c15u)).bits();
  };
  Random random(mixed(mixed(inlet.fill.seed, i + 1), static_cast<std::uint64_t>(now.count) + 1));
  const double radius = inlet.radius[i];
  for (std::size_t k = 0; k < tries; ++k) {
    Ball ball{{}, radius};
    for (int a = 0; a < 3; ++a)
      ball.x[a] = random.uniform(inlet.fill.min[a] + radius, inlet.fill.max[a] - radius) + shift[a];
    positions.push_back(ball);
  }
}

// The number of spheres that are due at that time.
std::size_t due_at(const Inlet& inlet, double time) {
  return static_cast<std::size_t>(std::upper_bound(inlet.due.begin(), inlet.due.end(), time) -
                                  inlet.due.begin());
}

bool overlap(const Ball& a, const Ball& b, const Periods& periods) {
  const double reach = a.radius + b.radius;
  return norm2(periods.shortest(a.x - b.x)) < reach * reach;
}

}  // namespace

Traffic::Traffic(const scene::Scene& scene, std::vector<Inlet> inlets, std::uint32_t first_waiting)
    : periods_(periods_of(scene.dem.value())), inlets_(std::move(inlets)), end_time_(scene.end_time) {
  for (const Inlet& inlet : inlets_) {
    first_.push_back(first_waiting);
    first_waiting += static_cast<std::uint32_t>(inlet.due.size());
  }
  for (const scene::Outlet& outlet : scene.dem.value().outlets) outlets_.push_back(outlet);
  warned_.resize(inlets_.size());
}

std::vector<std::string> Traffic::pass(Engine& engine, Nanoseconds now, std::span<const BodyPose> poses,
                                       Vec3d shift, std::vector<Counts>& counts) {
  std::vector<std::string> warnings;
  last_begin_ = to_seconds(now);
  for (std::size_t k = 0; k < outlets_.size(); ++k)
    counts[inlets_.size() + k].passed += engine.remove(region_of(outlets_[k], shift));
  for (std::size_t k = 0; k < inlets_.size(); ++k) {
    if (insert(engine, inlets_[k], first_[k], now, poses, shift, counts[k])) continue;
    ++counts[k].crowded;
    if (warned_[k]) continue;
    warned_[k] = true;  // a rollback does not reset it, so that a repeated window does not warn again
    warnings.push_back(
        fmt::format("inlet '{}' has no room at t = {:.6g} s: spheres wait; enlarge its box, or lower its "
                    "rate",
                    inlets_[k].name, to_seconds(now)));
  }
  return warnings;
}

bool Traffic::insert(Engine& engine, const Inlet& inlet, std::uint32_t first, Nanoseconds now,
                     std::span<const BodyPose> poses, Vec3d shift, Counts& so_far) {
  const std::size_t due = due_at(inlet, to_seconds(now));
  while (so_far.passed < due) {
    const std::size_t begin = so_far.passed, end = std::min(due, begin + at_once);
    std::vector<Ball> positions;
    for (std::size_t i = begin; i < end; ++i) append_positions(inlet, i, now, shift, positions);
    const std::vector<std::uint8_t> taken = engine.find_overlapping(positions, poses);
    std::vector<Arrival> arrivals;
    for (std::size_t i = begin; i < end; ++i) {
      const auto free = [&](std::size_t k) {
        return !taken[k] && std::ranges::none_of(arrivals, [&](const Arrival& other) {
          return overlap(other.ball, positions[k], periods_);
        });
      };
      std::size_t k = tries * (i - begin);
      const std::size_t none = k + tries;
      while (k < none && !free(k)) ++k;
      if (k == none) break;
      arrivals.push_back({first + static_cast<std::uint32_t>(i), positions[k], inlet.velocity});
    }
    if (!arrivals.empty()) engine.insert(arrivals);
    so_far.passed += arrivals.size();
    if (so_far.passed < end) return false;
  }
  return true;
}

std::string Traffic::complaint(std::size_t k, const Counts& s) const {
  const Inlet& inlet = inlets_[k];
  if (s.crowded == 0) {
    // configure() has already warned of an inlet whose first sphere is due at the end or later.
    if (s.passed > 0 || last_begin_ < 0 || inlet.due.empty() || inlet.due.front() <= last_begin_ ||
        inlet.due.front() >= end_time_)
      return {};
    return fmt::format(
        "inlet '{}' brought in no sphere: the first one is due at {:.6g} s, and the last window began at "
        "{:.6g} s: give an earlier start, or shorter windows",
        inlet.name, inlet.due.front(), last_begin_);
  }
  const std::string crowded = fmt::format("inlet '{}' had no room at {} {} of windows: ", inlet.name,
                                          s.crowded, s.crowded == 1 ? "border" : "borders");
  if (s.passed == 0)
    return crowded +
           "no sphere came in, since spheres or walls took every place that was tried; move its box";
  const std::size_t due = due_at(inlet, last_begin_);
  if (s.passed >= due) return crowded + "spheres came in late; enlarge the box, or lower the rate";
  return crowded +
         fmt::format(
             "{} of {} spheres that were due have not come in; the next one has a radius of {:.3g} m: "
             "enlarge the box, or lower the rate",
             due - s.passed, due, inlet.radius[s.passed]);
}

bool Traffic::is_possible(const std::vector<Counts>& counts) const {
  for (std::size_t k = 0; k < inlets_.size(); ++k)
    if (counts[k].passed > inlets_[k].due.size()) return false;
  return true;
}

void Traffic::report(const std::vector<Counts>& counts, protocol::DemFacts& facts,
                     nlohmann::ordered_json& others) const {
  if (!any()) return;
  std::uint64_t in = 0, out = 0;
  others["inlets"] = others["outlets"] = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < inlets_.size(); ++k) {
    const Counts& s = counts[k];
    in += s.passed;
    others["inlets"][inlets_[k].name] = {{"came_in", s.passed},
                                         {"to_come", inlets_[k].due.size() - s.passed},
                                         {"borders_without_room", s.crowded}};
    if (const std::string sentence = complaint(k, s); !sentence.empty()) facts.warnings->push_back(sentence);
  }
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    const std::uint64_t passed = counts[inlets_.size() + k].passed;
    out += passed;
    others["outlets"][outlets_[k].name] = passed;
  }
  facts.came_in = in;
  facts.went_out = out;
}

}  // namespace tandem::dem
