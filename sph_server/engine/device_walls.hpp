// The walls of bodies in the memory of a back end.
#pragma once

#include <span>
#include <vector>

#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

template <class Exec>
class DeviceWalls {
 public:
  DeviceWalls(Exec& exec, const Walls& walls) : bodies_(walls.bodies()), margin_(walls.margin()) {
    upload(exec, walls.facets(), facet_);
    upload(exec, walls.grids(), grid_);
    upload(exec, walls.cell_start(), cell_start_);
    upload(exec, walls.cell_facet(), cell_facet_);
    upload(exec, walls.slip(), slip_);
    upload(exec, walls.beyond(), beyond_);
    upload(exec, walls.surface(), surface_);
    place(exec, walls.poses());
  }
  void place(Exec& exec, const std::vector<particles::BodyPose>& poses) { upload(exec, poses, pose_); }
  // Where view_ahead() has them.
  void place_ahead(Exec& exec, const std::vector<particles::BodyPose>& poses) {
    upload(exec, poses, pose_ahead_);
  }

  WallsView view() const { return with(pose_); }
  WallsView view_ahead() const { return with(pose_ahead_); }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  WallsView with(const Buffer<particles::BodyPose>& pose) const {
    return {facet_.data(), grid_.data(), cell_start_.data(), cell_facet_.data(),
            pose.data(),   slip_.data(), beyond_.data(),     surface_.data(),
            bodies_,       margin_};
  }
  template <class T>
  static void upload(Exec& exec, const std::vector<T>& from, Buffer<T>& to) {
    if (!from.empty()) exec.upload(to, std::span(from));
  }

  Buffer<particles::Facet> facet_;
  Buffer<particles::FacetGrid> grid_;
  Buffer<std::uint32_t> cell_start_, cell_facet_, surface_;
  Buffer<std::uint8_t> slip_, beyond_;
  Buffer<particles::BodyPose> pose_, pose_ahead_;
  std::uint32_t bodies_ = 0;
  double margin_ = 0;
};

}  // namespace tandem::sph
