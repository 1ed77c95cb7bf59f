// The engine for one back end, law and precision: owns the memory, and says in which order the functors run.
//
//   advance: poses of all micro steps -> { rebuild lists when due; micro step } x steps -> books
//   rebuild: choose a skin -> take in what has left through periodic faces -> sort into cells -> move spheres
//            -> sort those of coarser levels into theirs -> count -> offsets -> put histories aside -> fill
//            -> make current -> sort what has one side
//
// It is written once; Exec (core/exec_cpu.hpp, core/exec_cuda.cuh) says how a loop over spheres is run. The
// members that check a state from a file are in step/engine_check.hpp, those that make room for lists in step/engine_memory.hpp, those that deal with single spheres in
// step/engine_spheres.hpp, those that deal with the tangents of bodies' contacts in step/engine_tangents.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "dem_server/model/parameters.hpp"
#include "dem_server/neighbours/build.hpp"
#include "dem_server/neighbours/sort_one_sided.hpp"
#include "dem_server/step/account.hpp"
#include "dem_server/step/engine.hpp"
#include "dem_server/step/engine_state.hpp"
#include "dem_server/step/gates.hpp"
#include "dem_server/step/interface_stiffness.hpp"
#include "dem_server/step/micro_step.hpp"

namespace tandem::dem {

template <class Exec, class Law, class Real>
class EngineOf final : public Engine {
 public:
  EngineOf(const EngineSetup& setup, Exec exec);

  const WindowOutcome& advance(const WindowPlan& plan) override;
  void save() override;
  void restore() override;
  void write(const ArraySink& sink) override;
  void read(const ArraySource& source) override;
  const std::vector<WallTangent>& wall_tangents(std::span<const BodyPose> poses) override;
  std::uint64_t take_out(const Region& region) override;
  void bring_in(std::span<const Arrival> arrivals) override;
  std::vector<std::uint8_t> find_taken(std::span<const Ball> balls, std::span<const BodyPose> poses) override;
  double speed_limit(double dt) const override;
  void download(Spheres& spheres) override;
  std::size_t memory_bytes() const override;
  std::uint32_t regions() const override { return exec_.regions(); }

 private:
  static constexpr bool once = Exec::pairs_once;

  using State = EngineState<Exec, Real>;
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  void upload_surface(const Surface& surface);
  void upload_spheres(const Spheres& spheres);
  void make_room_for(std::uint32_t steps);
  void limit_speed(double dt);
  void enlarge_lists(const Control& wanted);
  // Slots for so many spheres and some more, but no more than there will ever be spheres.
  std::uint32_t room_for(std::uint32_t spheres) const {
    return std::min(static_cast<std::uint32_t>(radius_.size()), spheres + std::max(spheres / 4, 64u));
  }
  bool has_bodies() const { return slots_ > 1; }  // beside the ground
  bool has_turns() const { return Law::extended && (view_.parameters.rolling || view_.parameters.twisting); }
  void make_slots(std::uint32_t n);
  void make_room_to_come_in(std::uint32_t count);
  void leave_empty_slots();
  void grow_pairs(std::size_t entries);
  void grow_springs(std::size_t entries);
  void grow_walls(std::size_t entries);
  void grow_near(std::size_t pairs);
  void grow_turns(std::size_t contacts);
  // With those of spheres that are in none of the grid.
  std::uint32_t cells() const { return size_levels_.finest_cells() + n_ / put_together + 1; }
  std::uint32_t coarse_cells() const {
    return size_levels_.coarse.empty() ? 0 : size_levels_.coarse_cells() + n_ / put_together + 1;
  }
  void refresh_view();
  // Most scenes have one level, and need no code for more.
  template <class Work>
  void with_levels(Work work) {
    view_.levels > 1 ? work.template operator()<Levels::many>() : work.template operator()<Levels::one>();
  }
  void rebuild();
  void account();
  static double with_rest(std::int64_t whole, std::int64_t rest, Quantum quantum) {
    return from_fixed(whole, quantum) + from_fixed(rest, quantum.of_rests());
  }
  Vec3d momentum_in(const std::int64_t* sum) const;
  Books books() const;
  template <class Gate>
  std::pair<Vec3d, std::uint64_t> pass(std::uint32_t n, const Gate& gate);
  void move_domain(Vec3d shift, Control& control);
  void collect(const WindowPlan& plan);
  void find_tangents(std::span<const BodyPose> poses);
  void take_up_state();
  template <class T>
  std::vector<T> values_of(const Buffer<T>& buffer, std::size_t count);
  void check_state(const SkinRange& skins);
  void check_control(const Control& c, const char* array, const SkinRange& skins) const;
  void check_spheres();
  void check_pairs();
  void check_walls();
  void fetch_spheres(std::uint32_t side, double back, Spheres& out);
  [[noreturn]] void fail(const Control& control);

  Exec exec_;
  std::uint32_t n_ = 0;  // slots for spheres: Control::slots
  std::uint32_t slots_;  // bodies with walls
  scene::Box domain_;    // at its first place
  BookQuanta quanta_;
  SizeLevels size_levels_;
  View<Real> view_;
  State now_, saved_;
  Buffer<PairExtras<Real>> extras_;
  Buffer<Facet> facets_;
  Buffer<Patch> patches_;
  Buffer<FacetGrid> facet_grids_;
  Buffer<std::uint32_t> facet_cell_start_, facet_cell_entry_;
  Buffer<PreparedPath> paths_;
  Buffer<BodyPose> pose_;
  Buffer<std::int64_t> load_, books_;
  Buffer<std::uint32_t> source_, cell_start_;
  Buffer<CoarseLevel> coarse_;
  Buffer<std::uint32_t> coarse_start_, coarse_slot_;
  Buffer<ListCounts> count_;
  Buffer<Turn<Real>> carried_turn_;
  Buffer<ClosePair> close_pair_;
  Buffer<std::uint32_t> close_number_, close_mirror_;
  Buffer<Range> close_owned_, close_mirrored_;
  Buffer<PairForce<Real>> pair_force_;
  Buffer<PairCouple<Real>> pair_couple_;
  Buffer<PairMoment<Real>> pair_moment_;
  Buffer<WallForce<Real>> wall_force_;
  Buffer<BodyPose> body_pose_;
  Buffer<WallTangent> tangents_, tangent_runs_, tangent_sums_;
  std::vector<WallTangent> wall_tangents_;
  std::vector<BodyPose>
      tangent_poses_;            // for which wall_tangents_ are; empty where they are of another state
  bool tangents_asked_ = false;  // after the last window, which was done once
  bool rolled_back_ = false;     // since they were asked for
  std::vector<std::int64_t> load_fixed_;
  std::array<std::int64_t, book_count> book_sums_{};
  std::vector<double> radius_;      // by id [m]
  std::vector<std::uint8_t> kind_;  // by id, where spheres wait
  // Kept from frame to frame: memory that is new costs as much as all the rest.
  struct {
    std::vector<Place<Real>> place;
    std::vector<Drift<Real>> drift;
    std::vector<Spin<Real>> spin;
    std::vector<Remainder<Real>> remainder;
    std::vector<std::uint32_t> id;
    std::vector<std::uint32_t> slot;  // by id
  } fetched_;
  Buffer<Entrant> entrants_;
  Buffer<Ball> balls_;
  Buffer<std::uint8_t> taken_;
  Vec3d passed_momentum_;  // out less in, since the last window [kg m/s]
  WindowOutcome outcome_;
};

template <class Exec, class Law, class Real>
EngineOf<Exec, Law, Real>::EngineOf(const EngineSetup& setup, Exec exec)
    : exec_(std::move(exec)),
      slots_(static_cast<std::uint32_t>(setup.surface.grids.size())),
      domain_(setup.scene.dem->domain),
      radius_(setup.spheres.radius) {
  view_.parameters = make_parameters<Real>(setup.scene, setup.spheres, setup.skins.largest);
  view_.follows = setup.scene.dem->follows.has_value();
  upload_surface(setup.surface);
  // The range of adhesion comes out of the largest skin: the rest is for travel.
  const double range = view_.parameters.unit.exact_metres(view_.parameters.range);
  size_levels_ = make_size_levels(setup.scene.dem->domain, view_.parameters.periods, setup.spheres.radius,
                                  setup.skins, range);
  exec_.upload(coarse_, std::span<const CoarseLevel>(size_levels_.coarse));

  Control& control = now_.host_control;
  control.skins = setup.skins;
  control.skins.largest -= range;
  control.skins.smallest = std::min(control.skins.smallest, control.skins.largest);
  // Of the first list's skin.
  for (const Vec3d& v : setup.spheres.velocity)
    control.progress[0].max_speed2 = std::max(control.progress[0].max_speed2, static_cast<float>(norm2(v)));
  if constexpr (Law::extended) {
    const std::vector<PairExtras<Real>> extras = make_pair_extras<Real>(setup.scene);
    exec_.upload(extras_, std::span<const PairExtras<Real>>(extras));
  }
  control.used = static_cast<std::uint32_t>(setup.spheres.size() - setup.spheres.waiting);
  exec_.upload(now_.control, std::span<const Control>(&control, 1));
  make_slots(setup.slots > 0 ? static_cast<std::uint32_t>(setup.slots) : room_for(control.used));
  upload_spheres(setup.spheres);
  books_.resize(book_count);
  // More room is made when it is needed.
  const auto contacts = static_cast<std::size_t>(setup.contacts * n_);
  const auto pairs = static_cast<std::size_t>((once ? 0.5 : 1.0) * setup.neighbours * n_);
  grow_pairs(pairs);
  grow_springs(pairs + springs_behind_lists<Real>(contacts, n_));
  grow_walls(static_cast<std::size_t>(setup.walls * n_) + 64);
  grow_near(static_cast<std::size_t>(setup.walls * n_) + 64);
  grow_turns(contacts);
  make_room_for(setup.steps);
  wall_tangents_.resize(slots_);
  if (has_bodies()) {
    tangent_runs_.resize(std::size_t{tangent_runs} * slots_);
    tangent_sums_.resize(slots_);
  }
  refresh_view();
  account();
  exec_.download(books_, std::span<std::int64_t>(book_sums_));
  now_.books = books();
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::upload_surface(const Surface& surface) {
  exec_.upload(facets_, std::span<const Facet>(surface.facets));
  exec_.upload(patches_, std::span<const Patch>(surface.patches));
  exec_.upload(facet_grids_, std::span<const FacetGrid>(surface.grids));
  exec_.upload(facet_cell_start_, std::span<const std::uint32_t>(surface.cell_start));
  exec_.upload(facet_cell_entry_, std::span<const std::uint32_t>(surface.cell_facet));
}

// No sphere goes in one step so far that its centre is no longer counted. Steps of stiff spheres are far too
// short for that.
template <class Exec, class Law, class Real>
double EngineOf<Exec, Law, Real>::speed_limit(double dt) const {
  return std::min(largest_speed, 0.5 * view_.parameters.centres.range() / dt);
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::limit_speed(double dt) {
  const auto limit = static_cast<float>(speed_limit(dt));
  if (limit == view_.parameters.speed_limit) return;
  view_.parameters.speed_limit = limit;
  exec_.forget_captured();
}

template <class Exec, class Law, class Real>
const WindowOutcome& EngineOf<Exec, Law, Real>::advance(const WindowPlan& plan) {
  if (load_.size() < std::size_t{plan.steps} * (slots_ + 1) * 6) {
    make_room_for(plan.steps);
    refresh_view();
  }
  if (load_fixed_.size() < load_.size()) load_fixed_.resize(load_.size());
  limit_speed(plan.dt);
  leave_empty_slots();
  Control& c = outcome_.control;
  c = now_.host_control;
  c.error = c.step_error[0] = c.step_error[1] = c.progress[0].failed = 0;  // whatever a restart file says
  c.culprit = ~0u;
  c.progress[0].step = 0;
  c.steps = plan.steps;
  c.dt = plan.dt;
  c.body_speed = plan.body_speed;
  c.progress[0].wall_travel += plan.wall_jump;
  c.max_overlap_ratio = c.progress[0].top_speed2 = 0;
  if (plan.domain_shift != c.domain_shift) move_domain(plan.domain_shift, c);
  if (c.progress[0].wall_travel > c.skin) c.progress[0].rebuild_due = 1;
  exec_.upload(now_.control, std::span<const Control>(&c, 1));
  exec_.upload(paths_, plan.paths);
  exec_.zero(load_, std::size_t{plan.steps} * (slots_ + 1) * 6);
  exec_.for_each(plan.steps * slots_, FillPoses{paths_.data(), pose_.data(), slots_, plan.steps});

  // Tangents that were asked for after the last window will be after this one: a device is then waited for
  // once.
  std::vector<BodyPose> last_poses;
  if (std::exchange(tangents_asked_, false))
    for (const PreparedPath& path : plan.paths) last_poses.push_back(pose_on_path(path, 1));
  tangent_poses_.clear();
  for (;;) {
    exec_.run_window(
        view_, now_.control, [this] { rebuild(); },
        [this] { exec_.step(n_, MicroStep<Law, Real>{view_}, slots_ + 1); });
    account();
    if (!last_poses.empty()) find_tangents(last_poses);
    exec_.download(now_.control, std::span<Control>(&c, 1), books_, std::span<std::int64_t>(book_sums_),
                   load_,
                   std::span<std::int64_t>(load_fixed_.data(), std::size_t{plan.steps} * (slots_ + 1) * 6),
                   tangent_sums_, std::span<WallTangent>(wall_tangents_.data(), last_poses.size()));
    if (c.error == 0) break;
    if (c.error == region_overflow) {
      exec_.enlarge_regions();
      c.error = 0;
      exec_.upload(now_.control, std::span<const Control>(&c, 1));
      continue;
    }
    if (c.error != list_overflow) fail(c);
    enlarge_lists(c);
    c.error = 0;
    exec_.upload(now_.control, std::span<const Control>(&c, 1));
  }
  tangent_poses_ = std::move(last_poses);
  outcome_.max_overlap_ratio = static_cast<double>(c.max_overlap_ratio);
  outcome_.skin = c.skin + view_.parameters.unit.exact_metres(view_.parameters.range);
  outcome_.max_speed = std::sqrt(static_cast<double>(c.progress[0].top_speed2));
  c.max_overlap_ratio = std::max(c.max_overlap_ratio, now_.host_control.max_overlap_ratio);
  now_.host_control = c;
  outcome_.begin = now_.books;
  now_.books = outcome_.end = books();
  collect(plan);
  return outcome_;
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::rebuild() {
  exec_.for_each(1, ChooseSkin<Real>{view_});
  if constexpr (Law::extended)
    if (view_.parameters.periods.any()) exec_.for_each(n_, WrapCentres<Real>{view_});
  // Nothing is counted before spheres are sorted: the counts' memory serves the sort.
  static_assert(sizeof(ListCounts) >= 2 * sizeof(std::uint32_t));
  auto* const keys = reinterpret_cast<std::uint32_t*>(count_.data());
  exec_.sort_into_cells(n_, cells(), FindCell<Real>{view_}, keys, keys + n_, cell_start_, source_);
  exec_.for_each(n_, MoveSphere<Real, Law>{view_});
  if (view_.levels > 1)
    exec_.sort_into_cells(n_, coarse_cells(), FindCoarseCell<Real>{view_}, keys, keys + n_, coarse_start_,
                          coarse_slot_);
  exec_.at_once([this] { exec_.for_each(n_, CountWalls<Real, Law>{view_}); },
                [this] {
                  with_levels([&]<Levels levels> {
                    exec_.for_each_shared(n_, CountPairs<Real, Law, once, levels>{view_});
                  });
                });
  exec_.exclusive_sum(count_, n_ + 1);
  if constexpr (Law::tangential) exec_.for_each(n_, Carry<Real>{view_});
  exec_.at_once(
      [this] { exec_.for_each(n_ + 1, FillWalls<Real, Law, once>{view_}); },
      [this] {
        with_levels([&]<Levels levels> { exec_.fill_lists(n_, FillPairs<Real, Law, once, levels>{view_}); });
      });
  if constexpr (once)
    with_levels([&]<Levels levels> { exec_.for_each(n_, FillMirrors<Real, Law, levels>{view_}); });
  exec_.for_each(1, FinishRebuild<Real>{view_});
  exec_.at_once(
      [this] {
        if constexpr (has_remainder<Real> || !Law::tangential) {
          exec_.for_each(n_, SetAside<Real, Law>{view_});
          exec_.for_each(n_, TakeUp<Real, Law>{view_});
        }
      },
      [this] { exec_.take_up_lists(view_); });
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::account() {
  exec_.zero(books_, book_count);
  exec_.template account<book_count>(n_, Account<Real, Law::tangential>{view_, quanta_});
}

template <class Exec, class Law, class Real>
Vec3d EngineOf<Exec, Law, Real>::momentum_in(const std::int64_t* sum) const {
  Vec3d momentum;
  for (int a = 0; a < 3; ++a)
    momentum[a] = with_rest(sum[momentum_x + a], sum[momentum_x_rest + a], quanta_.momentum);
  return momentum;
}

template <class Exec, class Law, class Real>
Books EngineOf<Exec, Law, Real>::books() const {
  const auto& sum = book_sums_;
  Books b;
  b.momentum = momentum_in(sum.data());
  b.mass = from_fixed(sum[total_mass], quanta_.mass);
  b.kinetic_energy = with_rest(sum[kinetic_energy], sum[kinetic_energy_rest], quanta_.energy);
  b.contacts = static_cast<std::uint64_t>(sum[contact_entries]) / (once ? 1 : 2);
  return b;
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::collect(const WindowPlan& plan) {
  const std::size_t rows = slots_ + 1;
  outcome_.load.resize(std::size_t{plan.steps} * slots_);
  const Quantum f = view_.parameters.force, t = view_.parameters.torque;
  std::int64_t lost[4]{};
  for (std::uint32_t s = 0; s < plan.steps; ++s) {
    const std::int64_t* row = load_fixed_.data() + s * rows * 6;
    for (std::uint32_t b = 0; b < slots_; ++b, row += 6)
      outcome_.load[std::size_t{s} * slots_ + b] = {
          {from_fixed(row[0], f), from_fixed(row[1], f), from_fixed(row[2], f)},
          {from_fixed(row[3], t), from_fixed(row[4], t), from_fixed(row[5], t)}};
    for (int a = 0; a < 4; ++a) lost[a] += row[a];
  }
  outcome_.lost_momentum =
      Vec3d{from_fixed(lost[0], f), from_fixed(lost[1], f), from_fixed(lost[2], f)} + passed_momentum_;
  passed_momentum_ = {};
  const double mass_steps = outcome_.end.mass * plan.steps + from_fixed(lost[3], t);
  outcome_.gravity_impulse = (plan.dt * mass_steps) * view_.parameters.gravity;
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::save() {
  copy(exec_, now_, saved_);
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::restore() {
  copy(exec_, saved_, now_);
  rolled_back_ = true;
  take_up_state();
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::write(const ArraySink& sink) {
  write_state(exec_, now_, sink);
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::read(const ArraySource& source) {
  const std::size_t all = radius_.size();
  const SkinRange skins = now_.host_control.skins;
  read_state(exec_, now_, source, kind_.empty() ? all : 0, all);
  check_state(skins);
  take_up_state();
}

// What goes with the state follows its sizes.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::take_up_state() {
  tangent_poses_.clear();
  make_slots(now_.host_control.slots);
  grow_near(0);
  refresh_view();
}

}  // namespace tandem::dem

#include "dem_server/step/engine_check.hpp"
#include "dem_server/step/engine_memory.hpp"
#include "dem_server/step/engine_spheres.hpp"
#include "dem_server/step/engine_tangents.hpp"
