// The engine's members for the contacts of spheres in frames (engine/contact_fields.hpp).
#pragma once

#include <algorithm>
#include <numeric>
#include <utility>

#include "dem_server/engine/contact_fields.hpp"
#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

// Before the first window there are no lists. They are built for this, and all is as before afterwards, so
// that the run has the bits of one without such frames.
template <BackEnd Exec, class Law, class Real>
template <class Work>
void EngineOf<Exec, Law, Real>::with_lists(double dt, Work work) {
  const bool first = memory_.now.host_window.rebuilds == 0;
  if (first) {
    save();
    build_first_lists(dt);
  }
  work();
  if (first) restore();
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::download(const ContactsRequest& request, ContactsFrame& frame) {
  with_lists(request.dt, [&] {
    auto& fields = memory_.contact_fields;
    exec_.upload(fields.pose, request.poses);
    exec_.for_each(memory_.n, FindNormalForces<Law, Real>{view_, fields.of_pair.data(), request.dt});
    exec_.for_each(memory_.n,
                   SumContacts<Law, Real, Exec::pairs_once>{view_, fields.of_pair.data(), fields.pose.data(),
                                                            request.dt, fields.of_sphere.data()});
    std::vector<SphereContacts> of_index(memory_.n);
    exec_.download(fields.of_sphere, std::span<SphereContacts>(of_index));
    if (ranks_ != nullptr) gather_at_first(of_index);
    const std::uint32_t side = memory_.now.host_window.progress[0].state_side;
    fetch_arrays(side, side);
    fetched_.sort_present(fetched_.position, radius_.size());
    frame.count.clear(), frame.mean_stress.clear();
    for (const std::uint32_t i : fetched_.index) {
      frame.count.push_back(of_index[i].count);
      frame.mean_stress.push_back(of_index[i].mean_stress);
    }
  });
}

template <BackEnd Exec, class Law, class Real>
std::vector<BodyContact> EngineOf<Exec, Law, Real>::body_contacts(const ContactsRequest& request,
                                                                  std::span<const std::uint8_t> wanted) {
  std::vector<BodyContact> all;
  with_lists(request.dt, [&] {
    auto& buffers = body_contacts_;
    const std::uint32_t near = memory_.now.host_window.near;
    exec_.upload(buffers.pose, request.poses);
    exec_.upload(buffers.wanted, wanted);
    exec_.grow(buffers.start, near + 1);
    std::vector<std::uint32_t> start(near + 1);
    const FindBodyContacts<Law, Real> find{view_,      buffers.pose.data(),  buffers.wanted.data(),
                                           request.dt, buffers.start.data(), nullptr};
    exec_.for_each(near, find);
    if (near > 0) exec_.download(buffers.start, std::span<std::uint32_t>(start.data(), near));
    std::exclusive_scan(start.begin(), start.end(), start.begin(), 0u);
    all.resize(start.back());
    if (start.back() == 0) return;
    exec_.upload(buffers.start, std::span<const std::uint32_t>(start));
    exec_.grow(buffers.found, all.size());
    FindBodyContacts<Law, Real> store = find;
    store.start = buffers.start.data(), store.found = buffers.found.data();
    exec_.for_each(near, store);
    exec_.download(buffers.found, std::span<BodyContact>(all));
  });
  if (ranks_ != nullptr) all = gathered(std::span<const BodyContact>(all), false);
  // The order of the lists depends on when they were built.
  std::ranges::stable_sort(all, {}, [](const BodyContact& c) { return std::pair(c.body, c.sphere); });
  return all;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::build_first_lists(double dt) {
  WindowProgress& c = memory_.now.host_window;
  c.dt = dt;
  for (;;) {
    c.error = 0;
    exec_.upload(memory_.now.window, std::span<const WindowProgress>(&c, 1));
    rebuild();
    exec_.download(memory_.now.window, std::span<WindowProgress>(&c, 1));
    if ((c.error & list_overflow) == 0) break;
    memory_.enlarge_lists(exec_, c);
    refresh_view();
  }
}

}  // namespace tandem::dem
