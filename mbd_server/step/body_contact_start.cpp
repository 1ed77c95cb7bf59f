// Contacts at the start: bodies that touch there, what must not be, and what flies apart.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/overlap.hpp"
#include "mbd_server/step/body_contacts.hpp"

namespace tandem::mbd {
namespace {

// Largest overlap at the start, as a share of the thinner shape: loads at rest press shapes by less.
constexpr double start_overlap = 0.1;

}  // namespace

void BodyContacts::prepare(State& state) {
  if (model_.contact.empty()) return;
  state.contacts.clear();
  state.touch_step.setZero(1);
  state.contact_wrench.setZero(6, std::ssize(model_.boundary));
  system_.residual(state);
  candidates_.find(system_.links(), 0, state.contacts);
  expect_outside();
  enter_all(state, 0, 0, true);
  ledger_.start_wrenches(state, system_.links());
  expect_apart(state, start_overlap, ErrorCode::scene, "overlap at the start",
               "move one of them: they would be thrown apart");
}

// Throws where a body starts inside a mesh, or a mesh inside a body.
void BodyContacts::expect_outside() const {
  for (const NearPair& pair : candidates_.pairs())
    for (const auto& [m, other] : {std::pair{pair.a, pair.b}, std::pair{pair.b, pair.a}}) {
      const ContactShape &mesh = model_.contact.shape(m), &body = model_.contact.shape(other);
      if (!mesh.mesh || body.points.empty() || body.kind == ContactShape::Kind::mesh) continue;
      const Overlap found = find_overlap(model_, other, m, system_.links(), start_overlap);
      if (found.depth > 0)
        throw Error(ErrorCode::scene,
                    fmt::format("{} is inside {} at the start, by {:.3g} m; the thinner one reaches {:.3g} m "
                                "from its middle",
                                body.name, mesh.name, found.depth, found.thinner),
                    "mbd.contact", "move one of them: shapes touch from outside" + files_of(body, mesh));
    }
}

// A contact whose loads hold it has no acceleration that opens it.
void BodyContacts::note_start(State& state, double h) {
  released_ = {};
  if (state.contacts.empty()) return;
  const auto rates = [&](const State& at, std::vector<double>& rate) {
    system_.residual(at);
    rate.clear();
    for (Eigen::Index k = 0; k < std::ssize(at.contacts); ++k)
      gap(model_, at.contacts[k].feature, system_.links(), &rate.emplace_back());
  };
  std::vector<double> before, after;
  rates(state, before);
  const double dt = 1e-3 * h;
  State ahead = state;
  ahead.time += dt;
  ahead.u += dt * state.udot;
  moved_ = dt * state.u + 0.5 * dt * dt * state.udot;
  system_.move(state.q, moved_, ahead.q);
  rates(ahead, after);
  system_.residual(state);
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    const ContactPoint& point = state.contacts[k];
    const ContactForce f = evaluate(model_, point, system_.links(), Derivatives::without);
    if (!(f.normal > 0)) continue;
    const double opening = (after[static_cast<std::size_t>(k)] - before[static_cast<std::size_t>(k)]) / dt,
                 share = std::clamp(point.mass * opening / f.normal, 0.0, 1.0), energy = share * f.energy;
    released_.energy += energy;
    if (!(energy > released_.largest)) continue;
    released_.largest = energy;
    released_.depth = -f.gap;
    released_.depth_share = -f.gap / thickness_at(model_, point.feature);
    released_.shape_a = point.feature.a;
    released_.shape_b = point.feature.b;
  }
}

}  // namespace tandem::mbd
