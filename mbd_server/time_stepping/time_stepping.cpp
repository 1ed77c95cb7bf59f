#include "mbd_server/time_stepping/time_stepping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/time_stepping/as_index.hpp"
#include "mbd_server/time_stepping/free_spin.hpp"

namespace tandem::mbd {
namespace {

// A contact that begins at rest has the damping of one that begins at this rate, where there is no gravity
// [m/s].
constexpr double least_entry_rate = 1e-9;
// Of that from the surface to the middle of the thinner shape.
constexpr double share_of_pass = 0.5;
// Turn of a shape within a step [rad].
constexpr double largest_turn = 0.5;
// A step up to this share of the duration of an impact leaves the rebound of materials with a restitution
// above 0.5, whose damping number is below this one.
constexpr double share_of_rebound = 1. / 30, number_of_rebound = 1.4;

Vector3d across_normal(const Vector3d& n, const Vector3d& x) {
  return x - n.dot(x) * n;
}

// Stretch of the spring of friction of a point.
Vector3d friction_stretch(const Model& model, const ContactPoint& point, const Vector3d& n,
                          const std::vector<LinkMotion>& links) {
  const LinkMotion &a = link_of(model, point.feature.a, links), &b = link_of(model, point.feature.b, links);
  return across_normal(n, b.point(point.friction.on_b) - a.point(point.friction.on_a));
}

double stored_in(const ContactLaw& law, const ContactPoint& point, double depth, const Vector3d& stretch) {
  return normal_energy(law, depth) + 0.5 * point.friction.stiffness * stretch.squaredNorm();
}

// Kinetic energy and that of gravity [J].
double energy_of_link(const Model& model, const Link& link, const LinkMotion& m) {
  if (link.mass == 0) return 0;
  const Vector3d w = m.V.head<3>(), c = m.point(link.com), v = m.velocity(c), local = m.R_WL.transpose() * w;
  return 0.5 * (link.mass * v.squaredNorm() + local.dot(link.inertia * local)) -
         link.mass * model.gravity.dot(c);
}

}  // namespace

TimeStepping::TimeStepping(const Model& model) : model_(model), near_(model) {
  if (!apply()) return;
  if (!model.closures.empty())
    throw Error(ErrorCode::scene,
                "time stepping of contacts closes no loops, as " + model.closures[0].name + " does",
                "mbd.joints", "leave out a joint of the loop, or mbd.contact.impacts");
  const Linearisation blocks(model);
  bodies_ = FreeBodies(model, blocks).bodies();
  if (6 * static_cast<int>(bodies_.size()) != model.freedoms)
    throw Error(ErrorCode::internal, "a body of time stepping is not free", "mbd_server");
  body_of_link_.assign(model.links.size(), none);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    body_of_link_[as_index(bodies_[b].rotation)] = static_cast<int>(b);
  radius_.assign(bodies_.size(), 0);
  for (const ContactShape& shape : model.contact.shapes)
    if (const int body = body_of_link_[as_index(shape.link)]; body != none)
      radius_[as_index(body)] =
          std::max(radius_[as_index(body)],
                   (shape.centre - model.links[as_index(shape.link)].com).norm() + shape.bound);
  account_.motion_work.assign(model.links.size(), 0);
}

void TimeStepping::prepare(State& state) const {
  if (!apply()) return;
  state.island_steps.setZero(3, std::ssize(bodies_));
  // Where no body is free, a contact has no effect.
  std::erase_if(state.contacts, [&](const ContactPoint& point) {
    return body_of(point.feature.a) == none && body_of(point.feature.b) == none;
  });
  StepPoints::sort(state.contacts);
}

void TimeStepping::step(State& state, const std::vector<LinkMotion>& links, double h) {
  account_.lost = account_.by_step = account_.surface_work = 0;
  account_.extremes = {};
  account_.contacts = {};
  near_.begin(links, h);
  wake(state);
  move_given(state, links, h);
  gather_bodies(state, links, h);
  gather_points(state, links, h);
  account_.effort = problem_.solve(h);
  account_.contacts.unsettled = account_.effort.settled ? 0 : 1;
  move_bodies(state, links, h);
  keep_points(state, links, h);
  record_work(links);
  rest(state, h);
  state.side = state.time;
  state.time += h;
  state.step = h;
  ++state.steps;
}

// ---- bodies

int TimeStepping::body_of(int shape) const {
  return body_of_link_[as_index(model_.contact.shape(shape).link)];
}

// Where the motions take their links; the others stay.
void TimeStepping::move_given(const State& state, const std::vector<LinkMotion>& links, double h) {
  if (model_.motions.empty()) {
    ahead_ = links;
    return;
  }
  end_ = state;
  end_.side = state.time;
  end_.time = state.time + h;
  compute_kinematics(model_, end_, ahead_);
}

void TimeStepping::gather_bodies(const State& state, const std::vector<LinkMotion>& links, double h) {
  awake_.clear();
  problem_.bodies.clear();
  place_of_.assign(bodies_.size(), none);
  for (int i = 0; i < std::ssize(bodies_); ++i) {
    if (sleeps(state, i)) continue;
    const FreeBodies::Body& body = bodies_[as_index(i)];
    const Link& link = model_.links[as_index(body.rotation)];
    const LinkMotion& m = links[as_index(body.rotation)];
    place_of_[as_index(i)] = static_cast<int>(awake_.size());
    Awake& one = awake_.emplace_back();
    one.body = i;
    one.centre = m.point(link.com);
    one.spin = state.u.segment<3>(body.u + 3);
    one.free_spin = free_spin(link.inertia, one.spin, h);
    const Vector6d v = spatial(m.R_WL * one.spin, m.velocity(one.centre));
    problem_.bodies.push_back({link.mass, m.R_WL * link.inertia * m.R_WL.transpose(),
                               spatial(m.R_WL * one.free_spin, v.tail<3>() + h * model_.gravity), v});
  }
}

// Bodies that contacts push move with the velocity at the end, others with the mean one; what turns an axis
// of inertia is never a contact.
void TimeStepping::move_bodies(State& state, const std::vector<LinkMotion>& links, double h) {
  for (std::size_t k = 0; k < problem_.points.size(); ++k) {
    const ContactProblem::Point& p = problem_.points[k];
    if (p.impulse().isZero(0)) continue;
    for (const int body : {p.a, p.b})
      if (body != none) awake_[as_index(body)].pushed = true;
  }
  for (std::size_t k = 0; k < awake_.size(); ++k) {
    const Awake& one = awake_[k];
    const FreeBodies::Body& body = bodies_[as_index(one.body)];
    const Link &link = model_.links[as_index(body.rotation)],
               &shifts = model_.links[as_index(body.translation)];
    const LinkMotion& m = links[as_index(body.rotation)];
    const ContactProblem::Body& end = problem_.bodies[k];
    const Vector3d before = m.velocity(one.centre), v = end.v.tail<3>(),
                   w = m.R_WL.transpose() * end.v.head<3>();
    const Vector3d moved = h * (one.pushed ? v : Vector3d(0.5 * (before + v))),
                   turned = h * (w - 0.5 * (one.free_spin - one.spin)), spun = w - one.free_spin;
    if (one.pushed)
      account_.by_step += 0.5 * (end.mass * (v - before).squaredNorm() + spun.dot(link.inertia * spun));
    double q[4];
    mbd::move(Elementary::spherical, &state.q[link.q], turned.data(), q);
    LinkMotion& next = ahead_[as_index(body.rotation)];
    std::copy_n(q, 4, &state.q[link.q]);
    next.q_WL = Quaterniond(q[0], q[1], q[2], q[3]);
    next.R_WL = next.q_WL.toRotationMatrix();
    next.p_WL = one.centre + moved - next.R_WL * link.com;
    const Vector3d spin = next.R_WL * w, rate = v - spin.cross(next.R_WL * link.com);
    next.V = spatial(spin, rate - spin.cross(next.p_WL));
    state.q.segment<3>(shifts.q) += next.p_WL - m.p_WL;
    const auto set = [&](int u, const Vector3d& to) {
      state.udot.segment<3>(u) = (to - state.u.segment<3>(u)) / h;
      state.u.segment<3>(u) = to;
    };
    set(shifts.u, rate);
    set(link.u, w);
  }
  state.a = state.udot;
}

// ---- points

bool TimeStepping::moves_as_given(int shape) const {
  const ContactShape& s = model_.contact.shape(shape);
  return body_of(shape) == none && (s.link != 0 || !s.surface_velocity.isZero(0));
}

// Mean velocity in the step of the place of a shape that is not free.
Vector3d TimeStepping::given_velocity(int shape, const Vector3d& p, const std::vector<LinkMotion>& links,
                                      double h) const {
  const ContactShape& s = model_.contact.shape(shape);
  if (!moves_as_given(shape)) return Vector3d::Zero();
  if (s.link == 0) return s.surface_velocity;
  return (ahead_[as_index(s.link)].point(in_link(links[as_index(s.link)], p)) - p) / h;
}

// Mass that a point at r from the centre of mass feels along n; 0: the shape is not free.
double TimeStepping::mass_at(int shape, const Vector3d& r, const Vector3d& n) const {
  const int body = body_of(shape);
  if (body == none) return 0;
  const ContactProblem::Body& of = problem_.bodies[as_index(place_of_[as_index(body)])];
  const Vector3d arm = r.cross(n);
  return 1 / (1 / of.mass + arm.dot(of.inertia.ldlt().solve(arm)));
}

void TimeStepping::gather_points(const State& state, const std::vector<LinkMotion>& links, double h) {
  touching_.clear();
  problem_.points.clear();
  near_.for_each_near([&](StepPoints::Pair& pair) {
    const auto awake = [&](int shape) {
      return body_of(shape) != none && place_of_[as_index(body_of(shape))] != none;
    };
    if (!awake(pair.a) && !awake(pair.b)) return;
    found_.clear();
    near_.find(pair, state.contacts, found_);
    for (const StepPoints::Found& one : found_) {
      ContactPoint& point = one.point < 0
                                ? touching_.emplace_back()
                                : touching_.emplace_back(state.contacts[static_cast<std::size_t>(one.point)]);
      point.feature = one.feature;
      add_point(point, one.point < 0, links, h);
    }
  });
  // Energy at the begin of the step: that which is left at its end, and in what is left, is not lost.
  for (const ContactPoint& point : state.contacts) {
    const int a = body_of(point.feature.a), b = body_of(point.feature.b);
    if ((a == none || place_of_[as_index(a)] == none) && (b == none || place_of_[as_index(b)] == none))
      continue;
    const Touch t = touch(model_, point.feature, links, Derivatives::without);
    account_.lost += stored_in(model_.contact.law(point.feature.a, point.feature.b), point, -t.gap,
                               friction_stretch(model_, point, t.n, links));
  }
}

void TimeStepping::add_point(ContactPoint& point, bool is_new, const std::vector<LinkMotion>& links,
                             double h) {
  const int shape_a = point.feature.a, shape_b = point.feature.b;
  const ContactLaw law = model_.contact.law(shape_a, shape_b);
  const Touch t = touch(model_, point.feature, links, Derivatives::without);
  ContactProblem::Point& p = problem_.points.emplace_back();
  const auto place = [&](int shape, int& body, Vector3d& r) {
    body = body_of(shape) == none ? none : place_of_[as_index(body_of(shape))];
    r = body == none ? Vector3d::Zero() : Vector3d(t.p - awake_[as_index(body)].centre);
  };
  place(shape_a, p.a, p.r_a);
  place(shape_b, p.b, p.r_b);
  p.n = t.n;
  p.given = given_velocity(shape_b, t.p, links, h) - given_velocity(shape_a, t.p, links, h);
  p.depth = -t.gap;
  p.stiffness = law.stiffness;
  p.friction = law.friction;
  const double gap_rate =
      t.n.dot(at_point(link_of(model_, shape_b, links).V - link_of(model_, shape_a, links).V, t.p));
  if (is_new) {
    point.mass_a = mass_at(shape_a, p.r_a, p.n);
    point.mass_b = mass_at(shape_b, p.r_b, p.n);
    point.pressing_mass = std::max(point.mass_a, point.mass_b);
    point.mass = point.mass_a > 0 && point.mass_b > 0 ? 1 / (1 / point.mass_a + 1 / point.mass_b)
                                                      : point.pressing_mass;
    point.entry_rate = std::max(0.0, -gap_rate);
    point.friction.stiffness = law.friction > 0 ? law.tangential_ratio * law.stiffness : 0;
    p.stretch.setZero();
  } else {
    p.stretch = friction_stretch(model_, point, t.n, links);
  }
  p.along = point.friction.stiffness;
  const double pressed = 0.5 * std::max(0.0, p.depth) * std::sqrt(law.stiffness / point.pressing_mass);
  p.damping =
      law.damping_number / std::max({point.entry_rate, pressed, h * model_.gravity.norm(), least_entry_rate});
  p.bound = is_new ? 0
                   : law.friction * h * law.stiffness * std::max(0.0, p.depth) *
                         std::max(0.0, 1 - p.damping * gap_rate);
}

void TimeStepping::expect_outside(const ContactPoint& point, double depth, double time) const {
  const double share = depth / thickness_at(model_, point.feature);
  if (share <= 1) return;
  throw Error(ErrorCode::numerics,
              fmt::format("{} and {} pass through each other at t = {:.6g} s: {:.3g} m deep",
                          model_.contact.shape(point.feature.a).name,
                          model_.contact.shape(point.feature.b).name, time, depth),
              "mbd.contact", "give more stiffness, or a shorter mbd.integrator.step");
}

// Whether the shapes begin to push each other although they move past each other: the normal is that of the
// begin of the step, which another place of a shape has.
bool TimeStepping::passes(const ContactPoint& point, const ContactProblem::Point& p, double h) const {
  if (!(p.normal > 0) || p.depth >= 0) return false;
  for (const int shape : {point.feature.a, point.feature.b})
    if (model_.contact.shape(shape).kind == ContactShape::Kind::plane) return false;
  // Without the contact, whose friction may stop the surfaces.
  const auto rate = [&](int body, const Vector3d& r) {
    if (body == none) return Vector3d(Vector3d::Zero());
    const Vector6d& v = problem_.bodies[as_index(body)].free;
    return Vector3d(v.tail<3>() + v.head<3>().cross(r));
  };
  const Vector3d velocity = rate(p.b, p.r_b) - rate(p.a, p.r_a) + p.given;
  return h * across_normal(p.n, velocity).norm() > share_of_pass * thickness_at(model_, point.feature);
}

// Whether one of the shapes turns by so much that it touches elsewhere at the end of the step.
bool TimeStepping::turns(const ContactPoint& point, const std::vector<LinkMotion>& links, double h) const {
  return std::ranges::any_of(std::array{point.feature.a, point.feature.b}, [&](int shape) {
    const LinkMotion &before = link_of(model_, shape, links), &after = link_of(model_, shape, ahead_);
    const double spin = std::max(before.V.head<3>().norm(), after.V.head<3>().norm());
    return model_.contact.shape(shape).kind != ContactShape::Kind::sphere && h * spin > largest_turn;
  });
}

// Points that bear or overlap stay, with the springs that have the friction of the end of the step.
void TimeStepping::keep_points(State& state, const std::vector<LinkMotion>& links, double h) {
  kept_.clear();
  for (const ContactPoint& point : state.contacts) {
    const int a = body_of(point.feature.a), b = body_of(point.feature.b);
    if ((a == none || place_of_[as_index(a)] == none) && (b == none || place_of_[as_index(b)] == none))
      kept_.push_back(point);
  }
  account_.contacts.steps = problem_.points.empty() ? 0 : 1;
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    const ContactProblem::Point& p = problem_.points[k];
    ContactPoint& point = touching_[k];
    const ContactLaw law = model_.contact.law(point.feature.a, point.feature.b);
    const Touch t = touch(model_, point.feature, ahead_, Derivatives::without);
    account_.lost -= p.impulse().dot(p.velocity);
    if (passes(point, p, h)) ++account_.contacts.passing;
    if (p.normal > 0 && turns(point, links, h)) ++account_.contacts.turning;
    if (!(p.normal > 0) && !(t.gap < 0)) continue;
    account_.extremes.force = std::max(account_.extremes.force, p.normal / h);
    // Along the normal of the begin of the step: shapes that have gone through each other may be apart again.
    const double along = p.normal > 0 ? p.depth - h * p.n.dot(p.velocity) : -t.gap;
    expect_outside(point, std::max(-t.gap, along), state.time + h);
    if (const double share = -t.gap / thickness_at(model_, point.feature);
        share > account_.extremes.depth_share)
      account_.extremes.depth_share = share, account_.extremes.shape_a = point.feature.a,
      account_.extremes.shape_b = point.feature.b;
    const LinkMotion &a = link_of(model_, point.feature.a, ahead_),
                     &b = link_of(model_, point.feature.b, ahead_);
    const Vector3d stretch =
        p.along > 0 ? across_normal(t.n, -p.tangential / (h * p.along)) : Vector3d::Zero();
    point.friction.on_a = in_link(a, t.p);
    point.friction.on_b = in_link(b, t.p + stretch);
    account_.lost -= stored_in(law, point, -t.gap, stretch);
    if (point.entry_time == 0) {
      point.entry_time = state.time + h, ++account_.contacts.contacts;
      if (law.damping_number < number_of_rebound && h > share_of_rebound * half_period(law, point.mass, 0))
        ++account_.contacts.dull;
    }
    kept_.push_back(point);
  }
  account_.lost += account_.by_step;
  StepPoints::sort(kept_);
  std::swap(state.contacts, kept_);
}

// A motion does what the energy of its link gains, and what the link does at contacts.
void TimeStepping::record_work(const std::vector<LinkMotion>& links) {
  for (std::size_t i = 1; i < links.size(); ++i)
    if (model_.links[i].motion != none)
      account_.motion_work[i] = energy_of_link(model_, model_.links[i], ahead_[i]) -
                                energy_of_link(model_, model_.links[i], links[i]);
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    const ContactProblem::Point& p = problem_.points[k];
    const auto record = [&](int shape, const Vector3d& impulse) {
      const LinkIndex link = model_.contact.shape(shape).link;
      if (!moves_as_given(shape)) return;
      (link == 0 ? account_.surface_work : account_.motion_work[as_index(link)]) -= impulse.dot(p.given);
    };
    // Of a point between two links that are given both there is none.
    record(touching_[k].feature.b, p.impulse());
    record(touching_[k].feature.a, p.impulse());
  }
}

}  // namespace tandem::mbd
