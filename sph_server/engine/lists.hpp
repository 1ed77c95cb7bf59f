// Lists of a liquid: when they are built anew, and how.
#pragma once

#include <string>
#include <utility>

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

// Writes the present positions to `located_`, and counts the particles that passed a wall since the lists
// were built.
template <class Exec, class Real, bool shifting>
Strays LiquidEngineOf<Exec, Real, shifting>::locate_particles() {
  Locate<Real> locate;
  locate.liquid = liquid_;
  locate.centres = centres_;
  locate.periods = setup_.periods;
  locate.domain = domain_now();
  locate.x = located_.data();
  if (built_) {
    exec_.upload(built_pose_, std::span<const particles::BodyPose>(built_poses_));
    locate.built_at = built_at_.data();
    locate.built_pose = built_pose_.data();
    locate.facets = facets_.view();
    locate.walls = device_walls_.view();
  }
  return exec_.template reduce<Strays>(count(), locate);
}

template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::rebuild() {
  const Strays strays = locate_particles();
  if (strays.first_outside < count_) {
    if (strays.first_not_finite < count_)
      throw Error(ErrorCode::numerics,
                  "the liquid flies apart: the position or velocity of particle " +
                      std::to_string(strays.first_not_finite) + " is not finite",
                  "liquid", "give a larger sound_speed, or a smaller spacing of the liquid");
    if (keeps_all_) refuse_outside(strays.first_outside);
    take_out_lost();
  }
  figures_.passed_walls += strays.passed;
  if (figures_.rebuilds % lists_in_order == 0) put_in_order_of_cells();
  std::swap(built_at_, located_);
  sort_into_cells(built_at_);
  choose_skins();
  build_lists();
  built_poses_ = walls_.poses();
  built_ = true;
  drift_ = {};
  ++figures_.rebuilds;
}

// Writes cell_start_ and in_cell_.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::sort_into_cells(const Buffer<Vec3d>& positions) {
  if (grid_.total == 0) {
    scene::Box domain = setup_.domain;
    // Where it is displaced, positions beside its end must not be rounded into a cell beyond the last.
    if (setup_.follows) domain.max += 1e-3 * reach_ * Vec3d{1, 1, 1};
    cells_of_reach_ = span_of(domain, reach_);
    grid_ = particles::make_cell_grid(domain, setup_.periods, reach_ / cells_of_reach_,
                                      particles::most_cells(count_));
    cell_start_.resize(std::size_t{grid_.total} + 2);
    grid_origin_ = grid_.origin;
  }
  grid_.origin = grid_origin_ + domain_shift();
  for (auto* array : {&key_, &scratch_, &in_cell_}) exec_.grow(*array, count_);
  exec_.sort_into_cells(count(), grid_.total, CellOfParticle{grid_, positions.data()}, key_.data(),
                        scratch_.data(), cell_start_, in_cell_);
}

// For the positions in built_at_, which are sorted into cells.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::choose_skins() {
  const Vec3d frame = frame_velocity();
  skin_of_walls_ = skins_.at_speed(walls_.largest_speed(frame));
  exec_.grow(near_skin_, count_);
  exec_.for_each(count(), MeasureSpeed<Real>{liquid_.velocity, liquid_.fine, built_at_.data(),
                                             device_walls_.view(), frame, near_skin_.data()});
  exec_.for_each(count(), ChooseSkin{largest_in_cells(near_skin_), skins_, skin_.data()});
}
template <class Exec, class Real, bool shifting>
LargestNear LiquidEngineOf<Exec, Real, shifting>::largest_in_cells(const Buffer<float>& value) {
  exec_.grow(largest_, grid_.total);
  exec_.for_each(grid_.total,
                 LargestInCell{cell_start_.data(), in_cell_.data(), value.data(), largest_.data()});
  return {grid_, built_at_.data(), largest_.data()};
}

// The lists of the positions in built_at_, which are sorted into cells, and of the skins in skin_.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::build_lists() {
  exec_.grow(near_count_, count_);
  exec_.grow(near_skin_, count_);
  exec_.for_each(count(), FindNearSkin{largest_in_cells(skin_), cells_of_reach_, near_skin_.data()});
  const Reaches reaches{setup_.liquid.support(), skin_.data(), near_skin_.data(), skin_of_walls_};
  const WallsView walls = device_walls_.view();
  exec_.build_list(count(), FindFacets{walls, built_at_.data(), reaches}, facets_);
  exec_.grow(particle_, facets_.total);
  exec_.grow(distance_, facets_.total);
  exec_.grow(clearance_, count_);
  exec_.for_each(count(), NameParticles{facets_.view(), particle_.data()});
  exec_.for_each(facets_.total, MeasureFacets{walls, facets_.view(), particle_.data(), built_at_.data(),
                                              reaches, distance_.data()});
  exec_.for_each(count(),
                 FindClearance{facets_.view(), distance_.data(), reaches, walls.margin, clearance_.data()});
  exec_.grow(position_in_cell_, count_);
  exec_.for_each(count(), PlaceInCells<Real>{centres_, unit_, skin_.data(), built_at_.data(), in_cell_.data(),
                                             position_in_cell_.data()});
  exec_.build_list(count(),
                   FindNeighbours<Real>{grid_, grid_.edge(1), cells_of_reach_, pairs_.apart, centres_,
                                        setup_.periods, cell_start_.data(), in_cell_.data(),
                                        position_in_cell_.data(), built_at_.data(), reaches},
                   neighbours_);
  list_beside_walls();
  exec_.keep_entries(beside_walls_, beside_wall_in_order_.data(),
                     SeesNeighbour{setup_.periods, built_at_.data(), walls, facets_.view(), distance_.data(),
                                   clearance_.data()},
                     neighbours_);
  exec_.grow(place_of_facet_, facets_.total);
  exec_.grow(near_, facets_.total);
  exec_.grow(hiders_of_, facets_.total);
  exec_.grow(sight_, facets_.total);
  exec_.grow(seen_, facets_.total);
  if (walls_.bodies() > 0)
    for (auto* array : {&viewpoint_, &by_pressure_}) exec_.grow(*array, count_);
  seen_ahead_ = false;
  if (walls_.any_closed()) {
    exec_.grow(side_, facets_.total);
    exec_.for_each(beside_walls_, FindSides{walls, facets_.view(), beside_wall_.data(), built_at_.data(),
                                            reach_, side_.data()});
  }
  use_arrays();
}

// Marks numbers below n, and lists them, ascending. before: how many marks precede each number (n + 1).
template <class Exec, class Real, bool shifting>
template <class Mark>
std::uint32_t LiquidEngineOf<Exec, Real, shifting>::list_marked(std::uint32_t n, Mark mark,
                                                                Buffer<std::uint32_t>& before,
                                                                Buffer<std::uint32_t>& list) {
  exec_.grow(before, std::size_t{n} + 1);
  exec_.zero(before, std::size_t{n} + 1);
  mark.mark = before.data();
  const std::uint32_t marked = exec_.template reduce<Marked>(n, mark).count;
  exec_.grow(list, marked);
  exec_.exclusive_sum(before, n + 1);
  exec_.for_each(n, ListMarked{before.data(), list.data()});
  return marked;
}
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::list_beside_walls() {
  beside_walls_ = list_marked(count(), MarkBesideWalls{facets_.view()}, before_, beside_wall_in_order_);
  between_bodies_ = 0;
  if (beside_walls_ == 0) return;
  exec_.grow(of_walls_, beside_walls_);
  exec_.grow(beside_wall_, beside_walls_);
  const FacetClasses by_facets{facets_.view(), beside_wall_in_order_.data(), beside_walls_};
  const std::uint32_t places = FacetClasses::classes * beside_walls_;
  exec_.grow(class_, places);
  exec_.zero(class_, places);
  exec_.for_each(beside_walls_, MarkClass{by_facets, class_.data()});
  exec_.exclusive_sum(class_, places);
  exec_.for_each(beside_walls_, ListByClass{by_facets, class_.data(), beside_wall_.data()});
  if (walls_.bodies() > 1)  // whose edges may meet
    between_bodies_ =
        list_marked(facets_.total, MarkBetweenBodies{facets_.view(), particle_.data(), device_walls_.view()},
                    between_before_, between_);
}

}  // namespace tandem::sph
