#include "mbd_server/step/contact_islands.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mbd_server/step/island_model.hpp"

namespace tandem::mbd {
namespace {

// Free bodies from which on islands are looked for: few bodies take their steps together.
constexpr std::size_t fewest = 8;
// The end of a step, as a share of its length.
constexpr double round_off_of_step = 1e-12;
// Bodies are at rest whose accelerations are below this share of that of gravity, and their rates below that
// share of that of a fall through their size; an island sleeps after so much time at rest [s]. The tolerance
// of Newton's method leaves some 1e-6 of gravity on stiff contacts.
constexpr double least_acceleration = 1e-5, least_rate = 1e-7, asleep_after = 0.1;

bool is_of_free_bodies(const Model& model, std::size_t free) {
  return !model.contact.empty() && model.contact.outputs.empty() && !model.contact.impacts_within_steps &&
         !model.contact.time_stepping && model.freedoms == 6 * static_cast<int>(free) &&
         model.links.size() == 2 * free + 1 && model.motions.empty() && model.boundary.empty() &&
         model.forces.empty() && model.closures.empty() && model.joint_forces.empty() &&
         model.breaks.empty() && model.inputs == 0;
}

// Link `b` of `to` gets the place and the rates of link `a` of `from`.
void copy_link(const State& from, const Link& a, State& to, const Link& b) {
  const int n = coordinates(a.kind);
  to.q.segment(b.q, n) = from.q.segment(a.q, n);
  for (VectorXd State::*rates : {&State::u, &State::udot, &State::a, &State::udot_rate})
    (to.*rates).segment<3>(b.u) = (from.*rates).segment<3>(a.u);
}

// Largest rate of a point of the shape [m/s].
double rate_of(const ContactShape& shape, const std::vector<LinkMotion>& links) {
  if (shape.link == 0) return 0;
  const LinkMotion& link = links[static_cast<std::size_t>(shape.link)];
  return at_point(link.V, link.point(shape.centre)).norm() + link.V.head<3>().norm() * shape.bound;
}

}  // namespace

struct ContactIslands::Island {
  Island(IslandModel of, Bodies of_bodies, double rho_inf, const NewtonSettings& newton)
      : bodies(std::move(of_bodies)),
        shapes(std::move(of.shapes)),
        model(std::move(of.model)),
        system(model),
        state(empty_state(model)),
        method(rho_inf, newton, system, state),
        stops(model, method, system, state),
        stiction(model, method, system, state),
        touching(model, method, system, state, stops, stiction),
        rates(model.contact.shapes.size(), 0) {}

  static State empty_state(const Model& model) {
    State state;
    state.q.setZero(model.coordinates);
    state.u.setZero(model.freedoms);
    state.udot = state.a = state.udot_rate = state.u;
    state.lambda.resize(0);
    state.loads.setZero(6, 0), state.load_rates.setZero(6, 0), state.contact_wrench.setZero(6, 0);
    state.touch_step.setZero(1);
    return state;
  }

  Bodies bodies;
  std::vector<int> shapes;  // of the whole model, ascending
  Model model;
  MachineSystem system;
  State state;
  GeneralizedAlpha method;
  StopContacts stops;
  Stiction stiction;
  BodyContacts touching;
  // Of the last step.
  StepCounters counted_before;
  BodyContactCounters contacts_before;
  ContactExtremes extremes;
  double lost = 0;            // [J]
  VectorXd errors;            // (freedoms)
  std::vector<double> rates;  // largest of each shape [m/s]
  bool done = false, used = false;
};

ContactIslands::ContactIslands(const Model& model, double rho_inf, const NewtonSettings& newton)
    : model_(model),
      rho_inf_(rho_inf),
      newton_(newton),
      error_constant_(std::abs(GeneralizedAlphaConstants(rho_inf).error_constant())) {
  if (model.contact.empty()) return;
  const Linearisation blocks(model);
  const FreeBodies free(model, blocks);
  if (free.bodies().size() < fewest || !is_of_free_bodies(model, free.bodies().size())) return;
  bodies_ = free.bodies();
  body_of_link_.assign(model.links.size(), none);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    body_of_link_[static_cast<std::size_t>(bodies_[b].rotation)] = static_cast<int>(b);
  local_errors_ = VectorXd::Zero(model.freedoms);
}

ContactIslands::~ContactIslands() = default;

void ContactIslands::prepare(State& state) const {
  if (!apply()) return;
  state.island_steps.setZero(3, std::ssize(bodies_));
  state.island_steps.row(0).setConstant(state.step);
  state.island_steps.row(1).setConstant(state.touch_step[0]);
}

void ContactIslands::step(State& state, const MachineSystem& system, double h, double energy_scale,
                          GeneralizedAlpha& method, BodyContacts& touching) {
  const State& begin = state;
  const std::vector<LinkMotion>& links = system.links();
  crowded_ = is_crowd(begin.contacts);
  for (auto& [bodies, island] : islands_) island->done = false, island->used = false;
  assume_rates(links, h);
  group_.resize(bodies_.size());
  std::iota(group_.begin(), group_.end(), 0);
  contacts_ = begin.contacts;
  connect_contacts(begin);
  std::vector<Bodies> all;
  for (bool faster = true; faster;) {
    connect_near(links, h);
    all = groups();
    faster = false;
    for (const Bodies& bodies : all) {
      if (sleeps(begin, bodies)) continue;
      Island& one = island(bodies);
      if (one.done) continue;
      gather(begin, one);
      faster |= integrate(begin, h, energy_scale, one);
    }
  }
  state.contacts.clear();
  state.touch_step[0] = 0;
  std::uint64_t most_steps = 0;
  ContactExtremes extremes;
  double lost = 0;
  for (const Bodies& bodies : all) {
    if (sleeps(state, bodies)) {
      keep_asleep(bodies, state);
      continue;
    }
    Island& one = island(bodies);
    one.used = true;
    scatter(one, state);
    most_steps = std::max(most_steps, one.state.steps);
    method.count(one.counted_before, one.method.counters(), one.method.shortened());
    touching.count(one.contacts_before, one.touching.counters());
    lost += one.lost;
    extremes.force = std::max(extremes.force, one.extremes.force);
    if (one.extremes.depth_share > extremes.depth_share)
      extremes.depth_share = one.extremes.depth_share, extremes.shape_a = one.extremes.shape_a,
      extremes.shape_b = one.extremes.shape_b;
  }
  touching.set_of_islands(lost, extremes);
  state.side = state.time;
  state.time += h;
  state.step = h;
  state.steps = most_steps;
  std::erase_if(islands_, [](const auto& entry) { return !entry.second->used; });
}

// ---- which bodies are an island

// The way of each shape in the step at the rates of its begin; gravity may add to them.
void ContactIslands::assume_rates(const std::vector<LinkMotion>& links, double h) {
  travel_.clear();
  for (const ContactShape& shape : model_.contact.shapes)
    travel_.push_back(shape.link == 0 ? 0 : h * (rate_of(shape, links) + 2 * h * model_.gravity.norm()));
}

int ContactIslands::first(int body) {
  const auto at = [&](int i) -> int& { return group_[static_cast<std::size_t>(i)]; };
  while (at(body) != body) body = at(body) = at(at(body));
  return body;
}

int ContactIslands::body_of(int shape) const {
  return body_of_link_[static_cast<std::size_t>(model_.contact.shape(shape).link)];
}

void ContactIslands::join(int shape_a, int shape_b) {
  const int a = body_of(shape_a), b = body_of(shape_b);
  if (a == none || b == none) return;
  const int x = first(a), y = first(b);
  group_[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
}

void ContactIslands::connect_contacts(const State& state) {
  contacts_of_.assign(bodies_.size(), {});
  for (std::size_t k = 0; k < state.contacts.size(); ++k) {
    const int a = state.contacts[k].feature.a, b = state.contacts[k].feature.b;
    join(a, b);
    const auto [low, high] = std::minmax({body_of(a), body_of(b)});
    contacts_of_[static_cast<std::size_t>(low == none ? high : low)].push_back(k);
  }
}

void ContactIslands::connect_near(const std::vector<LinkMotion>& links, double h) {
  find_pairs(model_, links, h, pairs_, &travel_);
  for (const NearPair& pair : pairs_) {
    const int a = body_of(pair.a), b = body_of(pair.b);
    if (a == none || b == none || first(a) == first(b)) continue;
    features_.clear();
    find_features(model_, pair.a, pair.b, links, pair.reach, -1, features_);
    const bool near = std::ranges::any_of(features_, [&](const ContactFeature& feature) {
      return feature.kind == ContactFeature::Kind::watch || gap(model_, feature, links) <= pair.reach;
    });
    if (near) join(pair.a, pair.b);
  }
}

// In the order of their first bodies.
std::vector<ContactIslands::Bodies> ContactIslands::groups() {
  std::vector<Bodies> all;
  std::vector<int> place(bodies_.size(), none);
  for (int b = 0; b < std::ssize(bodies_); ++b) {
    int& of = place[static_cast<std::size_t>(first(b))];
    if (of == none) of = static_cast<int>(std::ssize(all)), all.emplace_back();
    all[static_cast<std::size_t>(of)].push_back(b);
  }
  return all;
}

ContactIslands::Island& ContactIslands::island(const Bodies& bodies) {
  std::unique_ptr<Island>& island = islands_[bodies];
  if (!island)
    island = std::make_unique<Island>(island_model(model_, bodies_, bodies), bodies, rho_inf_, newton_);
  return *island;
}

// ---- the step of one island

// The shortest of the steps of bodies that were in different islands before; accelerations of the method
// stand for the time of their own step, and are taken to that of the shortest one, as where a step changes.
void ContactIslands::gather(const State& state, Island& island) const {
  State& own = island.state;
  own.time = state.time, own.side = state.side, own.steps = state.steps;
  own.step = HUGE_VAL, own.touch_step[0] = HUGE_VAL;
  for (const int body : island.bodies) {
    own.step = std::min(own.step, state.island_steps(0, body));
    if (const double longest = state.island_steps(1, body); longest > 0)
      own.touch_step[0] = std::min(own.touch_step[0], longest);
  }
  if (own.touch_step[0] == HUGE_VAL) own.touch_step[0] = 0;
  const GeneralizedAlphaConstants& c = island.method.constants();
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    const FreeBodies::Body& b = bodies_[static_cast<std::size_t>(body)];
    for (int i = 0; i < 2; ++i) {
      const Link &from = model_.links[i == 0 ? b.translation : b.rotation],
                 &to = island.model.links[2 * k + i + 1];
      copy_link(state, from, own, to);
      if (const double step = state.island_steps(0, body); step > own.step && own.step > 0)
        own.a.segment<3>(to.u) +=
            (c.alpha_m - c.alpha_f) * (own.step - step) * own.udot_rate.segment<3>(to.u);
    }
  }
  own.contacts.clear();
  const auto of = [&](int shape) {
    const auto found = std::ranges::lower_bound(island.shapes, shape);
    return found != island.shapes.end() && *found == shape ? static_cast<int>(found - island.shapes.begin())
                                                           : none;
  };
  std::vector<std::size_t> places;
  for (const int body : island.bodies) {
    const auto& own_places = contacts_of_[static_cast<std::size_t>(body)];
    places.insert(places.end(), own_places.begin(), own_places.end());
  }
  std::ranges::sort(places);
  for (const std::size_t k : places) {
    ContactFeature& feature = own.contacts.emplace_back(contacts_[k]).feature;
    feature.a = of(feature.a), feature.b = of(feature.b);
  }
}

// Returns whether a shape moved faster than was assumed.
bool ContactIslands::integrate(const State& begin, double h, double energy_scale, Island& island) {
  GeneralizedAlpha& method = island.method;
  State& state = island.state;
  island.counted_before = method.counters(), island.contacts_before = island.touching.counters();
  method.back({});
  island.touching.take_lost();
  island.extremes = {};
  island.errors = VectorXd::Zero(island.model.freedoms);
  std::ranges::fill(island.rates, 0);
  island.touching.begin(h, energy_scale, crowded_);
  // The error of the step as it was taken: a contact that begins at its end has another rate.
  VectorXd error;
  const auto stride = [&](double part) {
    method.step(island.system, state, part);
    if (method.error_of_parts())
      error = method.errors_of_parts();
    else
      error = (error_constant_ * part * part * part) * state.udot_rate.cwiseAbs();
    return part;
  };
  const BodyContacts::Stride one_step = std::ref(stride);
  for (double left = h; left > round_off_of_step * h;) {
    const double taken = island.touching.step(state, left, one_step);
    left -= taken;
    island.system.residual(state);
    island.errors += error;
    const ContactExtremes& now = island.touching.extremes();
    island.extremes.force = std::max(island.extremes.force, now.force);
    if (now.depth_share > island.extremes.depth_share)
      island.extremes.depth_share = now.depth_share,
      island.extremes.shape_a = island.shapes[static_cast<std::size_t>(now.shape_a)],
      island.extremes.shape_b = island.shapes[static_cast<std::size_t>(now.shape_b)];
    for (std::size_t s = 0; s < island.rates.size(); ++s)
      island.rates[s] =
          std::max(island.rates[s], rate_of(island.model.contact.shapes[s], island.system.links()));
  }
  state.time = begin.time + h;
  island.lost = island.touching.take_lost();
  island.done = true;
  return note_rates(island, h);
}

bool ContactIslands::note_rates(const Island& island, double h) {
  bool faster = false;
  for (std::size_t s = 0; s < island.rates.size(); ++s) {
    double& travel = travel_[static_cast<std::size_t>(island.shapes[s])];
    if (h * island.rates[s] <= travel) continue;
    travel = h * island.rates[s];
    faster = true;
  }
  return faster;
}

// ---- rest

bool ContactIslands::sleeps(const State& state, const Bodies& bodies) const {
  return std::ranges::all_of(bodies, [&](int body) { return state.island_steps(2, body) >= asleep_after; });
}

void ContactIslands::keep_asleep(const Bodies& bodies, State& state) {
  std::vector<std::size_t> places;
  for (const int body : bodies) {
    const int u = bodies_[static_cast<std::size_t>(body)].u;
    for (VectorXd* rates : {&state.u, &state.udot, &state.a, &state.udot_rate, &local_errors_})
      rates->segment<6>(u).setZero();
    const auto& own = contacts_of_[static_cast<std::size_t>(body)];
    places.insert(places.end(), own.begin(), own.end());
  }
  std::ranges::sort(places);
  for (const std::size_t k : places) state.contacts.push_back(contacts_[k]);
}

// After the step. Bodies that touch nothing do not rest, whatever their rates are.
double ContactIslands::time_at_rest(const Island& island, const State& before) const {
  const double g = model_.gravity.norm();
  if (!(g > 0) || island.state.contacts.empty()) return 0;
  for (const ContactShape& shape : island.model.contact.shapes) {
    if (shape.link == 0) continue;
    const LinkMotion& link = island.system.links()[static_cast<std::size_t>(shape.link)];
    const Vector3d centre = link.point(shape.centre);
    const double rate = at_point(link.V, centre).norm() + link.V.head<3>().norm() * shape.bound;
    // Accelerations of links are less that of gravity.
    const double acceleration =
        (at_point(link.A, centre) + model_.gravity).norm() + link.A.head<3>().norm() * shape.bound;
    if (rate > least_rate * std::sqrt(2 * g * shape.bound) || acceleration > least_acceleration * g) return 0;
  }
  double least = HUGE_VAL;
  for (const int body : island.bodies) least = std::min(least, before.island_steps(2, body));
  return least + island.state.time - before.time;
}

void ContactIslands::scatter(const Island& island, State& state) {
  const State& own = island.state;
  const double rested = time_at_rest(island, state);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    const FreeBodies::Body& b = bodies_[static_cast<std::size_t>(body)];
    for (int i = 0; i < 2; ++i) {
      const Link &to = model_.links[i == 0 ? b.translation : b.rotation],
                 &from = island.model.links[2 * k + i + 1];
      copy_link(own, from, state, to);
      local_errors_.segment<3>(to.u) = island.errors.segment<3>(from.u);
    }
    state.island_steps(0, body) = own.step;
    state.island_steps(1, body) = own.touch_step[0];
    state.island_steps(2, body) = rested;
  }
  if (const double longest = own.touch_step[0]; longest > 0)
    state.touch_step[0] = state.touch_step[0] > 0 ? std::min(state.touch_step[0], longest) : longest;
  for (const ContactPoint& point : own.contacts) {
    state.contacts.push_back(point);
    ContactFeature& feature = state.contacts.back().feature;
    feature.a = island.shapes[static_cast<std::size_t>(feature.a)];
    feature.b = island.shapes[static_cast<std::size_t>(feature.b)];
  }
}

}  // namespace tandem::mbd
