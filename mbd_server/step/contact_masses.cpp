#include "mbd_server/step/contact_masses.hpp"

#include <algorithm>
#include <numeric>

#include "mbd_server/model/machines.hpp"

namespace tandem::mbd {
namespace {

// A body is held along a contact where it gives way by less than this share of the other one.
constexpr double held = 1e-6;

}  // namespace

ContactMasses::ContactMasses(const Model& model, MachineSystem& system)
    : model_(model),
      system_(system),
      unit_(VectorXd::Zero(model.freedoms)),
      response_(unit_),
      dlambda_(VectorXd::Zero(system.constraints())),
      zero_(dlambda_) {
  if (model.contact.empty()) return;
  machine_of_link_ = machine_of_links(model);
  busy_.assign(model.links.size(), false);
}

// Points of machines that no closure connects share a solution, so that the cost is linear in the points.
void ContactMasses::find(const ContactCandidates& candidates, std::vector<ContactEntry>& entries) {
  response_.setZero();
  system_.factorise({.mass = 1, .damping = 0, .stiffness = 0}, response_);
  const auto& links = system_.links();
  const auto along = [&](LinkIndex link, const Vector6d& wrench, const auto& apply) {
    for (; link > 0; link = model_.links[static_cast<std::size_t>(link)].parent) {
      const Link& l = model_.links[static_cast<std::size_t>(link)];
      for (int j = 0; j < l.freedoms(); ++j)
        apply(l.u + j, links[static_cast<std::size_t>(link)].S.col(j).dot(wrench));
    }
  };
  for (std::size_t left = entries.size(); left > 0;) {
    unit_.setZero();
    std::fill(busy_.begin(), busy_.end(), false);
    now_.clear();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].mass > 0) continue;
      const ContactFeature& f = candidates[entries[i].candidate].feature;
      const int a = machine_of(f.a), b = machine_of(f.b);
      if ((a != none && busy_[static_cast<std::size_t>(a)]) ||
          (b != none && busy_[static_cast<std::size_t>(b)]))
        continue;
      if (a != none) busy_[static_cast<std::size_t>(a)] = true;
      if (b != none) busy_[static_cast<std::size_t>(b)] = true;
      now_.push_back(i);
      const Touch t = touch(model_, f, links, Derivatives::without);
      const Vector6d wrench = wrench_at(t.p, t.n);
      along(model_.contact.shape(f.b).link, wrench, [&](int u, double part) { unit_[u] += part; });
      along(model_.contact.shape(f.a).link, wrench, [&](int u, double part) { unit_[u] -= part; });
    }
    system_.solve(unit_, zero_, response_, dlambda_);
    for (const std::size_t i : now_) {
      const ContactFeature& f = candidates[entries[i].candidate].feature;
      const Touch t = touch(model_, f, links, Derivatives::without);
      const Vector6d wrench = wrench_at(t.p, t.n);
      double of_a = 0, of_b = 0;  // compliance
      along(model_.contact.shape(f.b).link, wrench, [&](int u, double part) { of_b += part * response_[u]; });
      along(model_.contact.shape(f.a).link, wrench, [&](int u, double part) { of_a -= part * response_[u]; });
      // Bodies that motions or loops hold have no inertia along the contact; any finite value serves.
      const double compliance = of_a + of_b;
      ContactEntry& e = entries[i];
      e.mass = compliance > 0 ? 1 / compliance : 1e6 * model_.contact.law(f.a, f.b).stiffness;
      if (machine_of(f.a) == machine_of(f.b)) of_a = of_b = compliance;
      e.mass_a = of_a > held * compliance ? 1 / of_a : 0, e.mass_b = of_b > held * compliance ? 1 / of_b : 0;
    }
    left -= now_.size();
  }
}

int ContactMasses::machine_of(int shape) const {
  return machine_of_link_[static_cast<std::size_t>(model_.contact.shape(shape).link)];
}

void ContactMasses::press(std::vector<ContactPoint>& points) {
  std::vector<int>& next = pressed_with_;
  next.resize(machine_of_link_.size());
  std::iota(next.begin(), next.end(), 0);
  pressing_.assign(next.size(), 0);
  const auto first = [&](int i) {
    while (next[static_cast<std::size_t>(i)] != i)
      i = next[static_cast<std::size_t>(i)] =
          next[static_cast<std::size_t>(next[static_cast<std::size_t>(i)])];
    return i;
  };
  const auto side = [&](int shape, double mass) { return mass > 0 ? machine_of(shape) : none; };
  for (const ContactPoint& p : points) {
    const int a = side(p.feature.a, p.mass_a), b = side(p.feature.b, p.mass_b);
    const auto add = [&](int machine, double mass) {
      if (machine == none) return;
      double& most = pressing_[static_cast<std::size_t>(machine)];
      most = std::max(most, mass);
    };
    add(a, p.mass_a), add(b, p.mass_b);
    if (a != none && b != none)
      next[static_cast<std::size_t>(std::max(first(a), first(b)))] = std::min(first(a), first(b));
  }
  for (std::size_t i = next.size(); i-- > 0;) {
    double& of_all = pressing_[static_cast<std::size_t>(first(static_cast<int>(i)))];
    of_all = std::max(of_all, pressing_[i]);
  }
  for (ContactPoint& p : points) {
    const int a = side(p.feature.a, p.mass_a), b = side(p.feature.b, p.mass_b), machine = a != none ? a : b;
    p.pressing_mass = machine != none ? pressing_[static_cast<std::size_t>(first(machine))] : p.mass;
  }
}

}  // namespace tandem::mbd
