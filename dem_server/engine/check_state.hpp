// Checks a state that comes from a file, so that no index of it leads a step out of its arrays. A value that
// no step and no rebuild can produce means that the file is damaged.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "common/error.hpp"
#include "dem_server/engine/engine_memory.hpp"

namespace tandem::dem {

// Error{resource} that names the array, and the index of a sphere where there is one.
inline void expect_sound(bool sound, const char* array, const char* problem, std::int64_t index = -1) {
  if (sound) return;
  throw Error(ErrorCode::resource,
              "its array '" + std::string(array) + "' is damaged: " +
                  (index < 0 ? "" : "the sphere at index " + std::to_string(index) + " ") + problem,
              {}, "continue from another checkpoint");
}

template <class Exec, class Law, class Real>
struct StateCheck {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Exec& exec;
  const EngineMemory<Exec, Law, Real>& memory;
  const Parameters<Real>& parameters;
  const scene::Box& domain;           // where it is at the start of the run
  bool follows = false;               // the domain is displaced with a body
  const std::vector<double>& radius;  // by id [m]
  SkinRange skins;                    // of this scene
  const EngineState<Exec, Real>& now = memory.now;

  void operator()() {
    const WindowProgress &host = now.host_window, device = values_of(now.window, 1).front();
    check_progress(host, "host_window_progress");
    check_progress(device, "window_progress");
    const auto tied = [](const WindowProgress& c) {
      const StepProgress& p = c.progress[0];
      return std::tuple(p.state_side, p.stamp, p.age, c.indices, c.used, c.near, c.listed, c.skin, c.lost);
    };
    expect_sound(tied(host) == tied(device), "window_progress", "it differs from 'host_window_progress'");
    check_spheres();
    check_pairs();
    check_walls();
    for (const double sum : values_of(now.wall_sums, now.wall_sums.size()))
      expect_sound(std::isfinite(sum), "wall_sums", "a sum is not finite");
    for (const double sum : values_of(now.dissipated, now.dissipated.size()))
      expect_sound(std::isfinite(sum), "dissipated", "a sum is not finite");
    const Totals& b = now.totals;
    expect_sound(is_finite(b.momentum) && std::isfinite(b.mass) && std::isfinite(b.kinetic_energy), "totals",
                 "a sum is not finite");
  }

 private:
  // The first `count` values of a buffer of the state.
  template <class T>
  std::vector<T> values_of(const Buffer<T>& buffer, std::size_t count) {
    std::vector<T> values(count);
    if (count > 0) exec.download(buffer, std::span<T>(values));
    return values;
  }

  void check_progress(const WindowProgress& c, const char* array) const {
    const StepProgress& p = c.progress[0];
    const auto expect = [array](bool sound, const char* what) { expect_sound(sound, array, what); };
    const auto length = [](double x) { return std::isfinite(x) && x >= 0; };
    expect(c.indices <= now.spheres.position[0].size() && c.used <= c.indices,
           "it has more indices than there are");
    expect(p.state_side <= 1 && p.rebuild_due <= 1 && p.open == 0, "a step has no such course");
    expect(length(p.travel) && length(p.wall_travel) && length(static_cast<double>(p.max_speed2)),
           "a way or a speed is not finite");
    expect(c.skins.usual == skins.usual && c.skins.smallest == skins.smallest &&
               c.skins.largest == skins.largest,
           "its skins are not those of this scene");
    expect(length(c.skin) && c.skin <= skins.largest, "the skin of the list is beyond the largest one");
    expect(c.near <= now.lists.near.size() && c.near <= Label::most_near,
           "it has more pairs near walls than there are");
    expect(c.listed <= now.lists.pairs.entry.size() - Exec::read_ahead, "it has more pairs than there are");
    expect(length(static_cast<double>(c.max_overlap_ratio)), "the largest overlap is not finite");
    const double range = parameters.centres.range();
    for (int a = 0; a < 3; ++a)
      expect(std::isfinite(c.domain_shift[a]) && std::abs(domain.min[a] + c.domain_shift[a]) <= range &&
                 std::abs(domain.max[a] + c.domain_shift[a]) <= range,
             "the domain is displaced beyond what can be counted");
  }

  void check_spheres() {
    const WindowProgress& c = now.host_window;
    const std::uint32_t n = c.indices, side = c.progress[0].state_side;
    const auto position = values_of(now.spheres.position[side], n);
    const auto velocity = values_of(now.spheres.velocity[side], n);
    const auto spin = values_of(now.spheres.spin[side], Law::tangential ? n : 0);
    const auto fine = values_of(now.spheres.fine, has_fine_part<Real> ? n : 0);
    const auto id = values_of(now.spheres.id, Law::tangential ? 0 : n);
    const Parameters<Real>& p = parameters;
    std::vector<bool> seen(radius.size());
    std::uint64_t present = 0;
    const Vec3d shift = follows ? c.domain_shift : Vec3d{};
    for (std::uint32_t i = 0; i < n; ++i) {
      const Label label = velocity[i].label;
      expect_sound(label.near_count() == 0 || label.near_first() + label.near_count() <= c.near,
                   "velocity_kind", "has walls near it that are not listed", i);
      expect_sound(p.kinds == 0 || label.kind() < p.kinds, "velocity_kind", "is of no kind", i);
      if (is_parked(position[i])) continue;
      std::uint32_t number = 0;
      if constexpr (Law::tangential)
        number = spin[i].id;
      else
        number = id[i];
      expect_sound(number < radius.size() && !seen[number], Law::tangential ? "spin" : "id",
                   "is none of the scene, or a second one", i);
      seen[number] = true;
      ++present;
      expect_sound(position[i].radius == p.unit.count(radius[number]), "position_radius",
                   "has another radius in the scene", i);
      FinePart<Real> rest{};
      if constexpr (has_fine_part<Real>) rest = fine[i];
      auto centre = p.centres.joined(position[i], rest);
      centre -= p.centres.of(shift);
      expect_sound(p.inside_domain(centre), "position_radius", "is outside of the domain", i);
      expect_sound(norm(velocity_of(velocity[i], rest)) <= largest_speed, "velocity_kind",
                   "has a speed that no step leaves", i);
      if constexpr (Law::tangential)
        expect_sound(is_finite(spin[i].w.template as<double>()), "spin", "has no finite one", i);
    }
    expect_sound(c.lost <= radius.size() - present, "host_window_progress",
                 "it has lost more spheres than are missing");
  }

  void check_pairs() {
    const WindowProgress& c = now.host_window;
    const std::uint32_t n = c.indices;
    const auto start = values_of(now.lists.pairs.start, n + 1);
    const auto entry = values_of(now.lists.pairs.entry, c.listed);
    expect_sound(std::is_sorted(start.begin(), start.end()) && start.back() <= c.listed, "pairs.start",
                 "lists do not follow each other");
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t k = start[i]; k < start[i + 1]; ++k)
        expect_sound(
            entry[k].index() < n && entry[k].index() != i && (!Exec::pairs_once || entry[k].index() > i),
            "pairs.entry", "has no such neighbour", i);
    if constexpr (Law::tangential) {
      const auto spring = values_of(now.lists.pairs.spring, c.listed);
      for (std::uint32_t k = start.front(); k < start.back(); ++k)
        expect_sound(!entry[k].in_contact() || is_finite(spring[k].template as<double>()), "pairs.spring",
                     "a spring is not finite");
    }
    for (const Image image :
         values_of(now.lists.pairs.image, now.lists.pairs.image.size() > 0 ? start.back() : 0))
      expect_sound(image < 1u << 6 && (image & image >> 1 & 0x15) == 0, "pairs.image",
                   "there is no such image");
    if constexpr (!Exec::pairs_once) return;
    const auto mirror_start = values_of(now.lists.mirror_start, n + 1);
    const auto mirror = values_of(now.lists.mirror, c.listed);
    expect_sound(
        std::is_sorted(mirror_start.begin(), mirror_start.end()) && mirror_start.back() == start.back(),
        "mirror_start", "lists do not follow each other");
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t k = mirror_start[i]; k < mirror_start[i + 1]; ++k)
        expect_sound(mirror[k] < c.listed && entry[mirror[k]].index() == i, "mirror", "is not in that pair",
                     i);
  }

  void check_walls() {
    const WindowProgress& c = now.host_window;
    const auto near = values_of(now.lists.near, c.near);
    const auto entry = values_of(now.lists.walls.entry, now.lists.walls.entry.size());
    const auto history = values_of(now.lists.walls.history, now.lists.walls.history.size());
    for (const NearBody& body : near) {
      expect_sound(body.sphere < c.indices && body.body < memory.bodies && body.first <= entry.size() &&
                       body.count <= entry.size() - body.first,
                   "near", "there is no such sphere, body or list");
      for (std::uint32_t k = body.first; k < body.first + body.count; ++k) {
        expect_sound(entry[k] < memory.surface.facets.size(), "walls.entry", "there is no such facet");
        if constexpr (Law::tangential)
          expect_sound(history[k].stamp != c.progress[0].stamp - 1 ||
                           is_finite(history[k].spring.template as<double>()),
                       "walls.history", "a spring is not finite");
      }
    }
  }
};

}  // namespace tandem::dem
