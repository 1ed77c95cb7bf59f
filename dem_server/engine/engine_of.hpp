// The engine for one back end, law and precision: it owns the memory and runs the functors in this order:
//
//   advance: poses of all micro steps -> { rebuild lists when due; micro step } x steps -> totals
//   rebuild: choose a skin -> wrap spheres that left through periodic faces
//            -> with ranks: exchange spheres -> sort into cells -> move spheres -> sort the spheres of
//            coarser levels -> count -> offsets -> save histories
//            -> fill -> make current -> sort the single-buffered arrays
//
// Exec runs the loops over spheres (backend/concept.hpp). engine/engine_memory.hpp allocates the arrays.
// The other members are in the headers that engine/engine_members.hpp lists, which whoever makes an engine
// includes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "dem_server/backend/concept.hpp"
#include "dem_server/contact/parameters.hpp"
#include "dem_server/engine/account.hpp"
#include "dem_server/engine/check_state.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/engine/engine_memory.hpp"
#include "dem_server/engine/engine_state.hpp"
#include "dem_server/engine/inflow_outflow.hpp"
#include "dem_server/engine/interface_stiffness.hpp"
#include "dem_server/engine/listed_spheres.hpp"
#include "dem_server/engine/measure.hpp"
#include "dem_server/engine/rank_share.hpp"
#include "dem_server/engine/rank_work.hpp"
#include "dem_server/neighbours/build.hpp"
#include "dem_server/neighbours/sort_single_buffered.hpp"
#include "dem_server/step/micro_step.hpp"

namespace tandem::dem {

template <class Exec>
struct HostCopy;  // engine/engine_whole_state.hpp

template <BackEnd Exec, class Law, class Real>
class EngineOf final : public Engine {
 public:
  EngineOf(const EngineSetup& setup, Exec exec);

  const WindowOutcome& advance(const WindowPlan& plan) override;
  void save() override;
  void restore() override;
  void write(const ArraySink& sink) override;
  void read(const ArraySource& source) override;
  const std::vector<WallTangent>& wall_tangents(std::span<const BodyPose> poses) override;
  std::uint64_t remove(const OutletRegion& region) override;
  void insert(std::span<const Arrival> arrivals) override;
  std::vector<std::uint8_t> find_overlapping(std::span<const Ball> balls,
                                             std::span<const BodyPose> poses) override;
  const std::vector<RegionSums>& measure(std::span<const MeasuredRegion> regions) override;
  const std::vector<double>& wall_fields() override;
  std::vector<double> dissipated() override;
  double speed_limit(double dt) const override;
  void download(Spheres& spheres) override;
  void download(SphereFrame& frame) override;
  void snapshot() override;
  void read_snapshot(SphereFrame& frame) override;
  void download(const ContactsRequest& request, ContactsFrame& frame) override;
  std::vector<BodyContact> body_contacts(const ContactsRequest& request,
                                         std::span<const std::uint8_t> wanted) override;
  std::size_t memory_bytes() const override { return memory_.bytes(); }
  std::uint32_t regions() const override { return exec_.regions(); }
  double rank_imbalance() const override { return rank_imbalance_; }

 private:
  using Memory = EngineMemory<Exec, Law, Real>;
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  void upload_spheres(const Spheres& spheres, Range share);
  void limit_speed(double dt);
  void begin_sums(std::uint32_t steps);
  void close_sums(const WindowPlan& plan);
  void make_room_to_come_in(std::uint32_t count);
  void enlarge_spheres(std::uint32_t count);
  std::uint32_t make_room_on_last_rank(std::uint32_t count);
  void shrink_spheres();
  void refresh_view();
  // Most scenes have one level of sizes; their kernels need no code for more.
  template <class Work>
  void with_levels(Work work) {
    view_.grid.levels > 1 ? work.template operator()<Levels::many>()
                          : work.template operator()<Levels::one>();
  }
  void rebuild();
  void list_neighbours();
  WindowProgress present_progress();
  void balance();
  CellShares balanced_shares();
  Destination<Real> destination(unsigned rank) const;
  void redistribute();
  void take_in(const Travelling& all, std::uint32_t from_lower);
  void grow_for(std::size_t pairs, std::size_t walls, std::size_t near);
  void find_own_and_ghosts();
  void leave_out_parked();
  void connect_ghosts();
  void count_all_ranks();
  void number_ghosts();
  void finish_step();
  void combine_window(WindowProgress& window, std::uint64_t lost);
  template <class T>
  std::vector<T> gathered(std::span<const T> own, bool on_all) const;
  template <class T>
  void gather_at_first(std::vector<T>& of_index) const;
  void write_whole(const ArraySink& sink);
  void take_part();
  EngineState<HostCopy<Exec>, Real> copy_on_host();
  void link_to_ghosts(const ContactLists<Real>& lists, std::uint32_t spheres);
  // Of a state in a file.
  std::size_t fewest_indices() const { return kind_.empty() ? radius_.size() : 0; }
  void build_first_lists(double dt);
  template <class Work>
  void with_lists(double dt, Work work);
  void account();
  static double with_rest(std::int64_t whole, std::int64_t rest, Quantum quantum) {
    return from_fixed(whole, quantum) + from_fixed(rest, quantum.of_remainders());
  }
  Vec3d momentum_in(const std::int64_t* sum) const;
  Totals totals() const;
  template <class Gate>
  std::pair<Vec3d, std::uint64_t> pass(std::uint32_t n, const Gate& gate);
  void move_domain(Vec3d shift, WindowProgress& window);
  void collect(const WindowPlan& plan);
  void find_tangents(std::span<const BodyPose> poses);
  void adapt_to_state();
  void fetch_spheres(std::uint32_t side, double back, Spheres& out);
  // Kept from frame to frame: allocating it anew would take as long as all other work of a frame.
  struct Fetched {
    std::vector<PositionRadius<Real>> position;
    std::vector<VelocityKind<Real>> velocity;
    std::vector<Spin<Real>> spin;
    std::vector<FinePart<Real>> fine;
    std::vector<std::uint32_t> id;
    std::vector<std::uint32_t> index;  // of the spheres present, in order of id

    void resize(std::size_t n) {
      position.resize(n), velocity.resize(n), spin.resize(n), fine.resize(n), id.resize(n);
    }
    void take_ids_of_spins() {
      for (std::size_t i = 0; i < id.size(); ++i) id[i] = spin[i].id;
    }
    // `positions`: those that say who is there; `ids`: number of all.
    void sort_present(const std::vector<PositionRadius<Real>>& positions, std::size_t ids);
  };
  void fetch_arrays(std::uint32_t side, std::uint32_t spin_side);
  void fill_frame(const Fetched& from, const Parameters<Real>& parameters, SphereFrame& frame) const;
  [[noreturn]] void fail(const WindowProgress& window);

  Exec exec_;
  Ranks* ranks_;  // null: this process has all spheres
  RankShare share_, saved_share_;
  CellShares cell_shares_;               // of the present lists
  double largest_radius_ = 0;            // with ranks [m]
  std::vector<std::int64_t> shared_by_;  // Ranks::weights() at that time
  double rank_imbalance_ = 1;
  typename Exec::template RankExchange<Real, Law::tangential> rank_exchange_;
  scene::Box domain_;  // where it is at the start of the run
  View<Real> view_;
  Memory memory_;
  TotalsQuanta quanta_;
  std::array<std::int64_t, total_count> total_sums_{};
  std::vector<std::int64_t> load_fixed_;  // of the last window, as memory_.window.load
  std::vector<std::int64_t> belt_pull_;   // likewise
  std::vector<double> radius_;            // by id [m]
  std::vector<std::uint8_t> kind_;        // by id; empty where no spheres wait
  Vec3d passed_momentum_;                 // of spheres that went out minus in, since the last window [kg m/s]
  WindowOutcome outcome_;
  std::vector<double> wall_fields_;

  struct {
    std::vector<WallTangent> of_body;
    std::vector<BodyPose> poses;  // poses that of_body belongs to; empty where of_body is out of date
    bool requested = false;       // advance() computes the tangents of the next window
    bool rolled_back = false;     // since the last request
  } tangents_;
  Fetched fetched_;
  struct {
    Fetched fetched;
    Parameters<Real> parameters;  // the domain may have moved on since
    SphereFrame gathered;         // with ranks, instead of the above
  } snapshot_;
  struct {
    Buffer<std::int64_t> totals;  // (regions x region_total_count)
    std::vector<std::int64_t> fixed;
    std::vector<RegionSums> sums;
  } measured_;
  // For frames with the contacts of bodies.
  struct {
    Buffer<BodyPose> pose;
    Buffer<std::uint8_t> wanted;
    Buffer<std::uint32_t> start;
    Buffer<BodyContact> found;
  } body_contacts_;
  // For spheres that come in.
  struct {
    Buffer<NewSphere> spheres;
    Buffer<Ball> balls;
    Buffer<std::uint8_t> taken;
    Buffer<BodyPose> body_pose;
  } inflow_;
};

// The spheres of this rank before the first lists are built.
inline Range share_at_start(const EngineSetup& setup) {
  const auto present = static_cast<std::uint32_t>(setup.spheres.size() - setup.spheres.waiting);
  return setup.ranks == nullptr ? Range{0, present}
                                : equal_share(present, setup.ranks->rank(), setup.ranks->size());
}

// With room for the spheres of this rank only.
inline EngineSetup setup_of_rank(EngineSetup setup) {
  const Range share = share_at_start(setup);
  if (setup.ranks != nullptr) setup.indices = std::max(1u, share.end - share.begin);
  return setup;
}

template <class Real>
View<Real> first_view(const EngineSetup& setup) {
  View<Real> view;
  view.parameters = make_parameters<Real>(setup.scene, setup.spheres, setup.skins.largest);
  view.follows = setup.scene.dem->follows.has_value();
  return view;
}

template <BackEnd Exec, class Law, class Real>
EngineOf<Exec, Law, Real>::EngineOf(const EngineSetup& setup, Exec exec)
    : exec_(std::move(exec)),
      ranks_(setup.ranks),
      rank_exchange_(setup.ranks),
      domain_(setup.scene.dem->domain),
      view_(first_view<Real>(setup)),
      memory_(exec_, setup_of_rank(setup), view_.parameters),
      radius_(setup.spheres.radius) {
  WindowProgress& window = memory_.now.host_window;
  window.skins = setup.skins;
  // The largest skin includes the range of adhesion; only the remainder is for travel.
  window.skins.largest -= view_.parameters.unit.exact_metres(view_.parameters.range);
  window.skins.smallest = std::min(window.skins.smallest, window.skins.largest);
  // The skin of the first list depends on this speed.
  for (const Vec3d& v : setup.spheres.velocity)
    window.progress[0].max_speed2 = std::max(window.progress[0].max_speed2, static_cast<float>(norm2(v)));
  window.used = static_cast<std::uint32_t>(setup.spheres.size() - setup.spheres.waiting);
  exec_.upload(memory_.now.window, std::span<const WindowProgress>(&window, 1));
  const Range share = share_at_start(setup);
  if (ranks_ != nullptr) {
    exec_.let_host_rebuild();
    share_.owned = {0, share.end - share.begin};
    share_.all = window.used;
    share_.first_ordinal = share.begin;
    exec_.grow(memory_.ranks.ordinal, memory_.n);
    exec_.for_each(memory_.n, CountUp{memory_.ranks.ordinal.data(), share.begin});
    largest_radius_ = *std::ranges::max_element(radius_);
  }
  upload_spheres(setup.spheres, share);
  tangents_.of_body.resize(memory_.bodies);
  for (auto* since_start : {&memory_.now.wall_sums, &memory_.now.dissipated})
    if (since_start->size() > 0) exec_.zero(*since_start, since_start->size());
  refresh_view();
  account();
  exec_.download(memory_.window.totals, std::span<std::int64_t>(total_sums_));
  if (ranks_ != nullptr) ranks_->sum(total_sums_);
  memory_.now.totals = totals();
}

// In one step no sphere may move so far that its centre leaves the range of the coordinates. Only steps much
// longer than those of stiff spheres allow that.
template <BackEnd Exec, class Law, class Real>
double EngineOf<Exec, Law, Real>::speed_limit(double dt) const {
  return std::min(largest_speed, 0.5 * view_.parameters.centres.range() / dt);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::limit_speed(double dt) {
  const auto limit = static_cast<float>(speed_limit(dt));
  if (limit == view_.parameters.speed_limit) return;
  view_.parameters.speed_limit = limit;
  exec_.forget_captured();
}

template <BackEnd Exec, class Law, class Real>
const WindowOutcome& EngineOf<Exec, Law, Real>::advance(const WindowPlan& plan) {
  if (memory_.window.grow(plan.steps, memory_.bodies, memory_.belts)) refresh_view();
  if (load_fixed_.size() < memory_.window.load.size()) load_fixed_.resize(memory_.window.load.size());
  limit_speed(plan.dt);
  begin_sums(plan.steps);
  shrink_spheres();
  WindowProgress& c = outcome_.window;
  c = memory_.now.host_window;
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
  const std::uint64_t lost_before = c.lost;
  exec_.upload(memory_.now.window, std::span<const WindowProgress>(&c, 1));
  exec_.upload(memory_.window.paths, plan.paths);
  if (memory_.belts) {
    const std::size_t count = std::size_t{plan.steps} * memory_.bodies;
    exec_.upload(memory_.window.belt_velocity, plan.belt_velocity.first(count));
    exec_.zero(memory_.window.belt_pull, count);
  }
  exec_.zero(memory_.window.load, std::size_t{plan.steps} * (memory_.bodies + 1) * 6);
  exec_.for_each(
      plan.steps * memory_.bodies,
      FillPoses{memory_.window.paths.data(), memory_.window.pose.data(), memory_.bodies, plan.steps});

  // Tangents that were requested after the last window will be requested after this one. They are computed
  // here, so that a device is waited for only once.
  std::vector<BodyPose> last_poses;
  if (std::exchange(tangents_.requested, false))
    for (std::size_t b = 0; b < plan.paths.size(); ++b) {
      last_poses.push_back(pose_on_path(plan.paths[b], 1));
      if (memory_.belts)
        add_belt(last_poses.back(), plan.belt_velocity[std::size_t{plan.steps} * memory_.bodies + b]);
    }
  tangents_.poses.clear();
  for (;;) {
    exec_.run_window(
        view_, memory_.now.window, [this] { rebuild(); },
        [this] {
          exec_.step(memory_.n, MicroStep<Law, Real>{view_}, memory_.bodies + 1);
          finish_step();
        });
    if (last_poses.empty())
      account();
    else
      exec_.at_once([this] { account(); }, [&] { find_tangents(last_poses); });
    exec_.download(
        memory_.now.window, std::span<WindowProgress>(&c, 1), memory_.window.totals,
        std::span<std::int64_t>(total_sums_), memory_.window.load,
        std::span<std::int64_t>(load_fixed_.data(), std::size_t{plan.steps} * (memory_.bodies + 1) * 6),
        memory_.tangents.sum, std::span<WallTangent>(tangents_.of_body.data(), last_poses.size()));
    if (c.error == 0) break;
    if (c.error == region_overflow) {
      exec_.enlarge_regions();
      c.error = 0;
      exec_.upload(memory_.now.window, std::span<const WindowProgress>(&c, 1));
      continue;
    }
    if (c.error != list_overflow) fail(c);
    memory_.enlarge_lists(exec_, c);
    refresh_view();
    c.error = 0;
    exec_.upload(memory_.now.window, std::span<const WindowProgress>(&c, 1));
  }
  if (memory_.belts) {
    belt_pull_.resize(std::size_t{plan.steps} * memory_.bodies);
    exec_.download(memory_.window.belt_pull, std::span<std::int64_t>(belt_pull_));
  }
  if (ranks_ != nullptr) {
    combine_window(c, lost_before);
    ranks_->sum(belt_pull_);
  }
  close_sums(plan);
  tangents_.poses = std::move(last_poses);
  outcome_.max_overlap_ratio = static_cast<double>(c.max_overlap_ratio);
  outcome_.skin = c.skin + view_.parameters.unit.exact_metres(view_.parameters.range);
  outcome_.max_speed = std::sqrt(static_cast<double>(c.progress[0].top_speed2));
  c.max_overlap_ratio = std::max(c.max_overlap_ratio, memory_.now.host_window.max_overlap_ratio);
  memory_.now.host_window = c;
  outcome_.begin = memory_.now.totals;
  memory_.now.totals = outcome_.end = totals();
  collect(plan);
  return outcome_;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::rebuild() {
  exec_.for_each(1, ChooseSkin<Real>{view_});
  if constexpr (Law::extended)
    if (view_.parameters.periods.any()) exec_.for_each(memory_.n, WrapCentres<Real>{view_});
  if (ranks_ == nullptr) return list_neighbours();
  redistribute();
  // Lists that do not fit are enlarged here, because the other ranks do not wait for it.
  for (;;) {
    list_neighbours();
    const WindowProgress window = present_progress();
    if ((window.error & list_overflow) == 0) {
      share_.ends = {window.listed, static_cast<std::uint32_t>(window.wall_entries), window.near};
      break;
    }
    memory_.enlarge_lists(exec_, window);
    refresh_view();
    exec_.for_each(1, ForgetOverflow<Real>{view_});
  }
  leave_out_parked();
  connect_ghosts();
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::list_neighbours() {
  // The sort uses the memory of the counts, which are computed after it.
  static_assert(sizeof(ListCounts) >= 2 * sizeof(std::uint32_t));
  auto* const keys = reinterpret_cast<std::uint32_t*>(memory_.rebuild.count.data());
  exec_.sort_into_cells(memory_.n, memory_.cells(), FindCell<Real>{view_}, keys, keys + memory_.n,
                        memory_.rebuild.cell_start, memory_.rebuild.source, memory_.rebuild.order);
  if (ranks_ != nullptr) find_own_and_ghosts();
  exec_.for_each(memory_.n, MoveSphere<Real, Law>{view_});
  if (view_.grid.levels > 1)
    exec_.sort_into_cells(memory_.n, memory_.coarse_cells(), FindCoarseCell<Real>{view_}, keys,
                          keys + memory_.n, memory_.rebuild.coarse_start, memory_.rebuild.coarse_index);
  exec_.at_once([this] { exec_.for_each(memory_.n, CountWalls<Real, Law>{view_}); },
                [this] {
                  with_levels([&]<Levels levels> {
                    exec_.for_each_shared(memory_.n, CountPairs<Real, Law, Exec::pairs_once, levels>{view_});
                  });
                });
  exec_.exclusive_sum(memory_.rebuild.count, memory_.n + 1);
  if constexpr (Law::tangential) exec_.for_each(memory_.n, Carry<Real>{view_});
  exec_.at_once([this] { exec_.for_each(memory_.n + 1, FillWalls<Real, Law, Exec::pairs_once>{view_}); },
                [this] {
                  with_levels([&]<Levels levels> {
                    exec_.fill_lists(memory_.n, FillPairs<Real, Law, Exec::pairs_once, levels>{view_});
                  });
                });
  if constexpr (Exec::pairs_once)
    with_levels([&]<Levels levels> { exec_.for_each(memory_.n, FillMirrors<Real, Law, levels>{view_}); });
  exec_.for_each(1, FinishRebuild<Real>{view_});
  exec_.at_once(
      [this] {
        if constexpr (has_fine_part<Real> || !Law::tangential) {
          exec_.for_each(memory_.n, SaveSingleBuffered<Real, Law>{view_});
          exec_.for_each(memory_.n, ReorderSingleBuffered<Real, Law>{view_});
        }
      },
      [this] { exec_.prepare_lists(view_); });
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::account() {
  exec_.zero(memory_.window.totals, total_count);
  exec_.template account<total_count>(memory_.n, Account<Real, Law::tangential>{view_, quanta_});
}

template <BackEnd Exec, class Law, class Real>
Vec3d EngineOf<Exec, Law, Real>::momentum_in(const std::int64_t* sum) const {
  Vec3d momentum;
  for (int a = 0; a < 3; ++a)
    momentum[a] = with_rest(sum[momentum_x + a], sum[momentum_x_rest + a], quanta_.momentum);
  return momentum;
}

template <BackEnd Exec, class Law, class Real>
Totals EngineOf<Exec, Law, Real>::totals() const {
  const auto& sum = total_sums_;
  Totals b;
  b.momentum = momentum_in(sum.data());
  b.mass = from_fixed(sum[total_mass], quanta_.mass);
  b.kinetic_energy = with_rest(sum[kinetic_energy], sum[kinetic_energy_rest], quanta_.energy);
  b.contacts = static_cast<std::uint64_t>(sum[contact_entries]) / (Exec::pairs_once ? 1 : 2);
  return b;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::collect(const WindowPlan& plan) {
  const std::size_t rows = memory_.bodies + 1;
  outcome_.load.resize(std::size_t{plan.steps} * memory_.bodies);
  const Quantum f = view_.parameters.force, t = view_.parameters.torque;
  std::int64_t lost[4]{};
  for (std::uint32_t s = 0; s < plan.steps; ++s) {
    const std::int64_t* row = load_fixed_.data() + s * rows * 6;
    for (std::uint32_t b = 0; b < memory_.bodies; ++b, row += 6)
      outcome_.load[std::size_t{s} * memory_.bodies + b] = {
          {from_fixed(row[0], f), from_fixed(row[1], f), from_fixed(row[2], f)},
          {from_fixed(row[3], t), from_fixed(row[4], t), from_fixed(row[5], t)}};
    for (int a = 0; a < 4; ++a) lost[a] += row[a];
  }
  outcome_.belt_pull.clear();
  for (const std::int64_t pull : belt_pull_) outcome_.belt_pull.push_back(from_fixed(pull, f));
  outcome_.lost_momentum =
      Vec3d{from_fixed(lost[0], f), from_fixed(lost[1], f), from_fixed(lost[2], f)} + passed_momentum_;
  passed_momentum_ = {};
  const double mass_steps = outcome_.end.mass * plan.steps + from_fixed(lost[3], t);
  outcome_.gravity_impulse = (plan.dt * mass_steps) * view_.parameters.gravity;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::refresh_view() {
  memory_.show(view_);
  if (ranks_ != nullptr) view_.spheres.owned = share_.owned;
  exec_.forget_captured();
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::save() {
  copy(exec_, memory_.now, memory_.saved);
  if (ranks_ == nullptr) return;
  saved_share_ = share_;
  exec_.copy(memory_.ranks.ordinal, memory_.ranks.saved[0]);
  exec_.copy(memory_.ranks.send, memory_.ranks.saved[1]);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::restore() {
  copy(exec_, memory_.saved, memory_.now);
  tangents_.rolled_back = true;
  if (ranks_ != nullptr) {
    share_ = saved_share_;
    exec_.copy(memory_.ranks.saved[0], memory_.ranks.ordinal);
    exec_.copy(memory_.ranks.saved[1], memory_.ranks.send);
    rank_exchange_.connect(exec_, share_.links, memory_.ranks.send);
  }
  adapt_to_state();
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::write(const ArraySink& sink) {
  if (ranks_ != nullptr) return write_whole(sink);
  write_state(exec_, memory_.now, sink);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::read(const ArraySource& source) {
  const std::size_t all = radius_.size();
  const SkinRange skins = memory_.now.host_window.skins;
  read_state(exec_, memory_.now, source, fewest_indices(), all);
  StateCheck<Exec, Law, Real>{exec_, memory_, view_.parameters, domain_, view_.follows, radius_, skins}();
  if (ranks_ != nullptr) take_part();
  adapt_to_state();
}

// Adapts everything that depends on the sizes of a state that has been restored or read.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::adapt_to_state() {
  tangents_.poses.clear();
  memory_.resize_spheres(exec_, memory_.now.host_window.indices);
  memory_.grow_near(exec_, 0);
  refresh_view();
}

}  // namespace tandem::dem
