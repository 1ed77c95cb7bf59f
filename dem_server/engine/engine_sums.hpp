// The engine's members for the sums of what spheres do to walls (contact/wall_sums.hpp), and of the energy
// that contacts dissipate (contact/dissipation.hpp).
#pragma once

#include <algorithm>

#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

// To be called before a window. The quanta follow from its number of micro steps, since each adds to the
// sums.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::begin_sums(std::uint32_t steps) {
  if (memory_.dissipation_window.size() > 0) {
    exec_.zero(memory_.dissipation_window, memory_.dissipation_window.size());
    if (view_.dissipation.energy.size == 1) {
      // Far more than all spheres store where each is pressed a tenth of its radius into a wall.
      const double radius = *std::ranges::max_element(radius_);
      view_.dissipation.energy = Quantum::for_range(64 * view_.parameters.force_limit * radius);
      exec_.forget_captured();
    }
  }
  if (memory_.wall_rows.size() == 0) return;
  exec_.zero(memory_.wall_window, memory_.wall_window.size());
  const double most = view_.parameters.force_limit * steps;
  const Quantum force = Quantum::for_range(most),
                work = Quantum::for_range(most * norm(domain_.max - domain_.min));
  WallSumsView& sums = view_.wall_sums;
  if (force.size == sums.force.size && work.size == sums.work.size) return;
  sums.force = force, sums.work = work;
  exec_.forget_captured();
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::close_sums(const WindowPlan& plan) {
  if (ranks_ != nullptr)
    for (auto* of_window : {&memory_.dissipation_window, &memory_.wall_window}) {
      std::vector<std::int64_t> sums(of_window->size());
      if (sums.empty()) continue;
      exec_.download(*of_window, std::span<std::int64_t>(sums));
      ranks_->sum(sums);
      exec_.upload(*of_window, std::span<const std::int64_t>(sums));
    }
  if (memory_.dissipation_window.size() > 0)
    exec_.for_each(dissipation_count,
                   CloseDissipation{memory_.dissipation_window.data(), memory_.now.dissipated.data(),
                                    view_.dissipation.energy});
  if (memory_.wall_rows.size() == 0) return;
  const WallSumsView& sums = view_.wall_sums;
  exec_.for_each(static_cast<std::uint32_t>(memory_.wall_window.size()),
                 CloseWallSums{memory_.wall_window.data(), memory_.now.wall_sums.data(), sums.force,
                               sums.work, plan.dt});
  std::vector<std::int64_t> of_walls(std::size_t{memory_.walls_with_sensors} * wall_sum_count);
  if (!of_walls.empty()) exec_.download(memory_.wall_window, std::span<std::int64_t>(of_walls));
  outcome_.wall_means.clear();
  for (std::size_t i = 0; i < of_walls.size(); ++i) {
    const bool is_work = i % wall_sum_count >= wall_friction_work;
    outcome_.wall_means.push_back(is_work ? from_fixed(of_walls[i], sums.work) / (plan.dt * plan.steps)
                                          : from_fixed(of_walls[i], sums.force) / plan.steps);
  }
}

template <BackEnd Exec, class Law, class Real>
const std::vector<double>& EngineOf<Exec, Law, Real>::wall_fields() {
  wall_fields_.resize(memory_.now.wall_sums.size());
  if (!wall_fields_.empty()) exec_.download(memory_.now.wall_sums, std::span<double>(wall_fields_));
  wall_fields_.erase(wall_fields_.begin(),
                     wall_fields_.begin() + std::ptrdiff_t{memory_.walls_with_sensors} * wall_sum_count);
  return wall_fields_;
}

template <BackEnd Exec, class Law, class Real>
std::vector<double> EngineOf<Exec, Law, Real>::dissipated() {
  std::vector<double> sums(memory_.now.dissipated.size());
  if (!sums.empty()) exec_.download(memory_.now.dissipated, std::span<double>(sums));
  return sums;
}

}  // namespace tandem::dem
