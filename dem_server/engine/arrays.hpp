// The arrays of an engine in groups: the members of a group, how it grows, and the pointers that functors
// get. Exec is a back end, or CountExec, which only counts bytes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "dem_server/contact/view.hpp"
#include "dem_server/engine/contact_tangent.hpp"
#include "dem_server/engine/sphere_contacts.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/path.hpp"

namespace tandem::dem {

// Which of the optional arrays a law and a scene need. What a law needs is known when it is compiled, and is
// repeated here so that the arrays of all laws have one type.
struct Needs {
  bool tangential = false;  // Law::tangential: springs of contacts, angular velocities
  bool rolling = false;     // springs against rolling and twisting
  bool images = false;      // pairs across periodic faces
  bool pairs_once = false;  // each pair is evaluated once, and mirrored
};

template <class Buffer>
auto* data_or_none(Buffer& buffer) {
  return buffer.size() > 0 ? buffer.data() : nullptr;
}

template <class Exec, class Real>
struct SphereBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Buffer<PositionRadius<Real>> position[2];
  Buffer<VelocityKind<Real>> velocity[2];
  Buffer<Spin<Real>> spin[2];
  Buffer<FinePart<Real>> fine;
  Buffer<std::uint32_t> id;  // absent where Spin holds the id

  void grow(Exec& exec, std::uint32_t n, const Needs& needs) {
    for (int side = 0; side < 2; ++side) {
      exec.grow(position[side], n);
      exec.grow(velocity[side], n);
      if (needs.tangential) exec.grow(spin[side], n);
    }
    if constexpr (has_fine_part<Real>) exec.grow(fine, n);
    if (!needs.tangential) exec.grow(id, n);
  }
  SphereArrays<Real> view(std::uint32_t n) {
    SphereArrays<Real> v;
    v.count = n;
    v.owned = {0, n};
    for (int side = 0; side < 2; ++side) {
      v.position[side] = position[side].data();
      v.velocity[side] = velocity[side].data();
      v.spin[side] = spin[side].data();
    }
    v.fine = fine.data();
    v.id = id.data();
    return v;
  }
};

// One side of the above, kept for a frame that is read while the spheres move on.
template <class Exec, class Real>
struct SnapshotBuffers {
  typename Exec::template Buffer<PositionRadius<Real>> position;
  typename Exec::template Buffer<VelocityKind<Real>> velocity;
  typename Exec::template Buffer<Spin<Real>> spin;
  typename Exec::template Buffer<FinePart<Real>> fine;
  typename Exec::template Buffer<std::uint32_t> id;

  // Calls f(array, copy of it) for each array.
  template <class F>
  void for_each(SphereBuffers<Exec, Real>& now, std::uint32_t side, const Needs& needs, F f) {
    f(now.position[side], position), f(now.velocity[side], velocity);
    if constexpr (has_fine_part<Real>) f(now.fine, fine);
    if (needs.tangential)
      f(now.spin[side], spin);
    else
      f(now.id, id);
  }
  template <class F>
  void for_each(F f) const {
    f(position), f(velocity), f(spin), f(fine), f(id);
  }
};

template <class Exec, class Real>
struct ListBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  struct Pairs {
    Buffer<std::uint32_t> start;
    Buffer<Neighbour> entry;
    Buffer<Vec3<Real>> spring;
    Buffer<RollingSpring<Real>> rolling;
    Buffer<Image> image;
  };
  struct Walls {
    Buffer<std::uint32_t> entry;
    Buffer<History<Real>> history;
    Buffer<RollingSpring<Real>> rolling;
  };

  Pairs pairs;
  Walls walls;
  Buffer<std::uint32_t> mirror_start, mirror;  // where pairs are evaluated once
  Buffer<float> wall_slack;
  Buffer<NearBody> near;

  void grow_spheres(Exec& exec, std::uint32_t n, const Needs& needs) {
    exec.grow(pairs.start, n + 1);
    if (needs.pairs_once) exec.grow(mirror_start, n + 1);
  }
  // `entries` includes those that kernels read beyond the end.
  void grow_pairs(Exec& exec, std::size_t entries, const Needs& needs) {
    exec.grow(pairs.entry, entries);
    if (needs.rolling) exec.grow(pairs.rolling, entries);
    if (needs.images) exec.grow(pairs.image, entries);
    if (needs.pairs_once) exec.grow(mirror, entries);
  }
  // Springs of the pair entries, and behind them the contacts that a rebuild carries over.
  void grow_springs(Exec& exec, std::size_t entries, const Needs& needs) {
    if (needs.tangential) exec.grow(pairs.spring, entries);
  }
  void grow_walls(Exec& exec, std::size_t entries, const Needs& needs) {
    exec.grow(walls.entry, entries);
    if (needs.tangential) exec.grow(walls.history, entries);
    if (needs.rolling) exec.grow(walls.rolling, entries);
    exec.grow(wall_slack, entries);
  }
  ContactLists<Real> view(const Needs& needs) {
    constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
    const auto capacity = [](std::size_t size) {
      return static_cast<std::uint32_t>(std::min(size, std::size_t{most}));
    };
    ContactLists<Real> v;
    v.pairs = {pairs.start.data(), pairs.entry.data(), pairs.spring.data(), data_or_none(pairs.rolling),
               data_or_none(pairs.image)};
    v.walls = {walls.entry.data(), walls.history.data(), data_or_none(walls.rolling)};
    v.mirror_start = mirror_start.data();
    v.mirror = mirror.data();
    v.wall_slack = wall_slack.data();
    v.near = near.data();
    v.spring_capacity = needs.tangential ? capacity(pairs.spring.size()) : most;
    v.pair_capacity = capacity(pairs.entry.size() - Exec::read_ahead);
    v.wall_capacity = capacity(walls.entry.size());
    v.near_capacity = std::min(capacity(near.size()), Label::most_near);
    return v;
  }
};

// Memory of a rebuild of the lists.
template <class Exec, class Real>
struct RebuildBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  particles::IndexOrder order;  // see RebuildArrays
  Buffer<std::uint32_t> source, cell_start, coarse_start, coarse_index;
  Buffer<ListCounts> count;
  Buffer<RollingSpring<Real>> carried_rolling;

  RebuildArrays<Real> view() {
    return {order,
            source.data(),
            cell_start.data(),
            coarse_start.data(),
            coarse_index.data(),
            count.data(),
            data_or_none(carried_rolling),
            static_cast<std::uint32_t>(carried_rolling.size())};
  }
  template <class F>
  void for_each(F f) const {
    f(source), f(cell_start), f(coarse_start), f(coarse_index), f(count), f(carried_rolling);
  }
};

// The close pairs and their forces in one micro step, where each pair is evaluated once.
template <class Exec, class Real>
struct ClosePairBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Buffer<ClosePair> pair;
  Buffer<std::uint32_t> number, mirror;
  Buffer<Range> owned, mirrored;
  Buffer<PairForce<Real>> force;
  Buffer<PairCouple<Real>> couple;
  Buffer<PairMoment<Real>> moment;

  void resize(std::size_t entries, std::size_t n, const Needs& needs) {
    pair.resize(entries);
    number.resize(entries);
    mirror.resize(entries);
    owned.resize(n);
    mirrored.resize(n);
    force.resize(entries);
    if (needs.tangential) couple.resize(entries);
    if (needs.rolling) moment.resize(entries);
  }
  ClosePairs<Real> view() {
    return {pair.data(),     number.data(), owned.data(),  mirror.data(),
            mirrored.data(), force.data(),  couple.data(), data_or_none(moment)};
  }
  template <class F>
  void for_each(F f) const {
    f(pair), f(number), f(mirror), f(owned), f(mirrored), f(force), f(couple), f(moment);
  }
};

template <class Exec>
struct SurfaceBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Buffer<Facet> facets;
  Buffer<Patch> patches;
  Buffer<FacetGrid> grids;
  Buffer<std::uint32_t> cell_start, cell_facet;

  void upload(Exec& exec, const Surface& surface) {
    exec.upload(facets, std::span<const Facet>(surface.facets));
    exec.upload(patches, std::span<const Patch>(surface.patches));
    exec.upload(grids, std::span<const FacetGrid>(surface.grids));
    exec.upload(cell_start, std::span<const std::uint32_t>(surface.cell_start));
    exec.upload(cell_facet, std::span<const std::uint32_t>(surface.cell_facet));
  }
  SurfaceView view(std::uint32_t bodies) {
    return {bodies, facets.data(), patches.data(), grids.data(), cell_start.data(), cell_facet.data()};
  }
  template <class F>
  void for_each(F f) const {
    f(facets), f(patches), f(grids), f(cell_start), f(cell_facet);
  }
};

// Poses of the bodies and loads on them in each micro step of a window.
template <class Exec>
struct WindowBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Buffer<PreparedPath> paths;
  Buffer<BodyPose> pose;
  Buffer<std::int64_t> load, totals;
  Buffer<Vec3d> belt_velocity;  // where there are belts; likewise
  Buffer<std::int64_t> belt_pull;

  // Makes room for a window of that many micro steps. Returns false where there was enough.
  bool grow(std::uint32_t steps, std::uint32_t bodies, bool belts) {
    const std::size_t sums = std::size_t{steps} * (bodies + 1) * 6;
    if (load.size() >= sums) return false;
    load.resize(sums);
    pose.resize(std::size_t{steps} * bodies);
    if (belts) {
      belt_velocity.resize(std::size_t{steps} * bodies);
      belt_pull.resize(std::size_t{steps} * bodies);
    }
    paths.resize(bodies);
    return true;
  }
  template <class F>
  void for_each(F f) const {
    f(paths), f(pose), f(load), f(totals), f(belt_velocity), f(belt_pull);
  }
};

// Contacts of the spheres, for frames that have them (engine/contact_fields.hpp).
template <class Exec, class Real>
struct ContactFieldBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Buffer<PairNormalForce<Real>> of_pair;
  Buffer<SphereContacts> of_sphere;
  Buffer<BodyPose> pose;
  template <class F>
  void for_each(F f) const {
    f(of_pair), f(of_sphere), f(pose);
  }
};

// Tangents of the contacts with walls (engine/interface_stiffness.hpp).
template <class Exec>
struct TangentBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Buffer<WallTangent> of_pair, of_run, sum;
  template <class F>
  void for_each(F f) const {
    f(of_pair), f(of_run), f(sum);
  }
};

}  // namespace tandem::dem
