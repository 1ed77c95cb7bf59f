// The engine on one back end (backend/cpu/exec_cpu.hpp, backend/cuda/exec_cuda.cuh) in one precision.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/fault.hpp"
#include "particles/grid/cell_grid.hpp"
#include "sph_server/engine/device_walls.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/engine/liquid_memory.hpp"
#include "sph_server/engine/sensed.hpp"
#include "sph_server/engine/totals.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/beside_walls.hpp"
#include "sph_server/step/edge_sums.hpp"
#include "sph_server/step/see_facets.hpp"
#include "sph_server/step/sum_rates.hpp"

namespace tandem::sph {

template <class Exec, class Real, bool shifting>
class LiquidEngineOf final : public LiquidEngine {
 public:
  using LiquidEngine::set_state;
  using LiquidEngine::step;

  explicit LiquidEngineOf(const LiquidSetup& setup)
      : setup_(setup),
        skins_(SkinRule::of(setup.liquid, shortest_of(setup.periods))),
        reach_((setup.liquid.support() + 2 * skins_.widest) * Reaches::rounding),
        exec_(setup.threads),
        walls_(setup.walls, reach_, setup.slip),
        device_walls_(exec_, walls_),
        unit_(particles::LengthUnit<Real>::for_lengths(4 * setup.liquid.support())) {
    expect_liquid(setup.liquid);
    round_periods();
    double farthest = 0;
    for (int a = 0; a < 3; ++a)
      farthest = std::max({farthest, std::fabs(setup.domain.min[a]), std::fabs(setup.domain.max[a])});
    centres_ = particles::CentreUnit<Real>::for_range(unit_, farthest, setup.follows ? 10 : 4);
    pairs_.apart.unit = unit_;
    pairs_.pair = PairConstants<Real>::of(setup.liquid);
    mark_.support = setup.liquid.support();
    const WallKernel kernel = WallKernel::of(setup.liquid.support(), setup.liquid.spacing);
    hiders_.kernel = see_whole_.kernel = see_partial_.kernel = wall_sums_.kernel = edges_.kernel = kernel;
    rates_.properties = setup.liquid;
    rates_.spare = 1e-3 * setup.liquid.spacing;
    rates_.inverse_sound2 = 1 / (setup.liquid.sound_speed * setup.liquid.sound_speed);
    rates_.peak = wall_sums_.peak = Kernel<double>::of_support(setup.liquid.support()).peak;
    wall_sums_.wall = WallConstants::of(setup.liquid);
    wall_sums_.repulsion = WallRepulsion::of(setup.liquid);
    wall_sums_.mass = setup.liquid.mass();
    edges_.wall = wall_sums_.wall;
    edges_.mass = setup.liquid.mass();
    edges_.spacing = setup.liquid.spacing;
    advance_.periods = rates_.periods = setup_.periods;
    advance_.properties = setup.liquid;
    viewpoints_.centres = wall_sums_.centres = edges_.centres = rates_.centres = advance_.centres = centres_;
  }

  void set_state(const LiquidState& state, const std::vector<particles::BodyPose>& poses) override {
    set_poses(poses);
    const std::size_t n = state.size();
    if ((n == 0 && setup_.capacity == 0) || n >= Neighbour::most)
      throw Error(ErrorCode::scene, "a liquid of " + std::to_string(n) + " particles", "particles",
                  "give from 1 to " + std::to_string(Neighbour::most - 1));
    Host host;
    each(host, [n](auto& array) { array.resize(n); });
    for (std::uint32_t i = 0; i < n; ++i) place(host, i, state, i);
    upload(host);
    set_quanta(std::max(n, setup_.capacity));
    built_ = false;
    figures_.rebuilds = figures_.passed_walls = 0;
    keeps_all_ = true;
    rebuild();
    keeps_all_ = false;
    // The tension that particles bear follows from what fills their kernels.
    sum_rates();
    exec_.for_each(count(), UpdateState<Real>{advance_, 0});
    const auto begin = std::chrono::steady_clock::now();
    sum_rates();
    start_cost_ = {beside_walls_,
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
    begin_steps();
    work_ = {};
  }
  void exchange(std::span<const std::uint32_t> leaving, const LiquidState& arriving,
                const std::vector<particles::BodyPose>& poses) override;
  std::vector<TakenParticle> take_out(const std::vector<particles::OutletRegion>& regions) override;

  LiquidState state() const override {
    const Host host = download();
    LiquidState s;
    s.position.resize(count_);
    s.velocity.resize(count_);
    s.compression.resize(count_);
    s.pressure.resize(count_);
    s.slope.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const particles::FinePart<Real> fine = fine_of(host, i);
      const std::uint32_t k = host.number[i];
      s.position[k] = centres_.metres(centres_.joined(host.position[i], fine));
      s.velocity[k] = particles::velocity_of(host.velocity[i], fine);
      s.compression[k] = host.compression[i];
      s.pressure[k] = static_cast<double>(host.state[i].pressure);
      s.slope[k] = host.slope[i].template as<double>();
    }
    return s;
  }

  void step(double dt, const std::vector<particles::BodyPose>& poses, double next) override {
    expect_stable(dt);
    advance_.dt = dt;
    advance_.weight = extrapolation_weight(dt, last_dt_);
    for (int p = 0; p < powers; ++p)
      work_.of[p] += dt * ((1 + advance_.weight) * power_[p] - advance_.weight * previous_power_[p]);
    std::copy(std::begin(power_), std::end(power_), std::begin(previous_power_));
    for (std::size_t b = 0; b < step_loads_.size(); ++b) {
      const Wrench now = wrench_of(body_sums_[b]), before = wrench_of(previous_body_sums_[b]);
      step_loads_[b] = {(1 + advance_.weight) * now.force - advance_.weight * before.force,
                        (1 + advance_.weight) * now.torque - advance_.weight * before.torque};
    }
    previous_body_sums_ = body_sums_;
    last_dt_ = dt;
    set_poses(poses);
    lost_ = {};
    const bool seen = seen_ahead_;
    const double ahead = seen ? 0 : 0.5 * next;
    move(ahead);
    // With new lists the middle of this step is where it was half a step ago: results do not depend on lists.
    sum_rates(seen && !seen_ahead_ ? -0.5 * dt : ahead);
    if (!lost_.index.empty()) forget_step_before();
  }
  LostParticles take_lost() override { return std::exchange(lost_, {}); }

  const std::vector<particles::BodyPose>& poses() const override { return walls_.poses(); }

  void pack(const Packing& how, const std::function<void(int)>& after_step) override {
    const Liquid& l = setup_.liquid;
    advance_.packing_pressure = how.pressure * l.density * l.sound_speed * l.sound_speed;
    advance_.damping = how.damping;
    rates_.properties.gravity = {};
    wall_sums_.continued = false;
    keeps_all_ = true;
    exec_.for_each(count(), UpdateState<Real>{advance_, 0});
    sum_rates();
    exec_.copy(memory_.acceleration[0], memory_.acceleration[1]);
    // Shorter steps than those of a flow: from corners less is squeezed out.
    constexpr double share = 5.0 / 6;
    for (int k = 0; k < how.steps; ++k) {
      const double fastest = std::max(l.sound_speed, figures_.largest_speed);
      step(share * step_limits(l, fastest, figures_.largest_acceleration).smallest, poses(), 0);
      after_step(k);
    }
    rates_.properties.gravity = l.gravity;
    wall_sums_.continued = true;
    keeps_all_ = false;
    advance_.packing_pressure = 0;
    advance_.damping = 1;
  }

  std::vector<Wrench> loads() const override {
    std::vector<Wrench> loads;
    for (const BodySum& s : body_sums_) loads.push_back(wrench_of(s));
    return loads;
  }
  const std::vector<Wrench>& step_loads() const override { return step_loads_; }

  // See engine/measured.hpp.
  LiquidTotals totals() const override;
  particles::RegionSums sums_in(const particles::MeasuredRegion& region) const override;
  LiquidState near_line(Vec3d from, Vec3d along, double radius) const override;
  EnergyBalance energies() const override;

  StepFigures figures() const override { return figures_; }
  StartCost start_cost() const override { return start_cost_; }

  void save() override;
  void restore() override;
  void write(const Sink& sink) const override;
  void read(const Source& source, std::size_t particles) override;

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  // Particles are put in the order of cells with each so many-th list: until then a particle moves a few
  // spacings at most.
  static constexpr std::uint64_t lists_in_order = 16;
  using Memory = LiquidMemory<Exec::template Buffer, Real, shifting>;
  using Host = HostLiquid<Real, shifting>;

  // What a step reads and that follows from nothing else, besides arrays of particles and the lists.
  template <class Engine, class Visit>
  static void each_value(Engine& e, Visit visit) {
    visit("body_sums", e.body_sums_);
    visit("previous_body_sums", e.previous_body_sums_);
    visit("step_loads", e.step_loads_);
    visit("poses", e.poses_);
    visit("built_poses", e.built_poses_);
    visit("power", e.power_);
    visit("previous_power", e.previous_power_);
    visit("work", e.work_.of);
    visit("last_dt", e.last_dt_);
    visit("figures", e.figures_);
    visit("holds_for", e.holds_for_);
    visit("drift", e.drift_);
    visit("frame", e.frame_);
    visit("skin_of_walls", e.skin_of_walls_);
  }
  template <class Visit>
  static void each(Host& host, Visit visit) {
    Host::each([&](const char*, auto& array) { visit(array); }, host);
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(count_); }

  // Moves all particles, and builds the lists anew where they may have become wrong.
  // ahead: how much longer they have to hold for what particles will see of facets [s].
  void move(double ahead) {
    const bool hold = lists_hold(ahead);
    exec_.for_each(count(), advance_);
    if (!hold) rebuild();
  }
  // During the step to come. The last sums know the ways of particles but for what a vessel does that is not
  // in its velocity, and for the damping in a vessel that moves.
  bool lists_hold(double ahead) {
    const Vec3d before = std::exchange(drift_, drift_since(built_poses_));
    const double unknown = norm(advance_.dt * frame_ - (drift_ - before)) +
                           0.5 * advance_.dt * (1 - advance_.damping) * norm(frame_);
    const double far = ahead > 0 ? ahead * walls_.largest_speed(frame_velocity()) : 0;
    return advance_.dt + ahead <= holds_for_ && unknown <= rates_.spare &&
           walls_.moved_from(displaced(built_poses_, drift_)) + far <= static_cast<double>(skin_of_walls_);
  }

  static particles::FinePart<Real> fine_of([[maybe_unused]] const Host& host,
                                           [[maybe_unused]] std::size_t i) {
    if constexpr (particles::has_fine_part<Real>)
      return host.fine[i];
    else
      return {};
  }

  // Takes the particles of `host`.
  void upload(const Host& host) {
    allocate(host.position.size());
    Memory::each(
        [this](const char*, auto& to, const auto& from) {
          if (!from.empty()) exec_.upload(to, std::span(from));
        },
        memory_, host);
  }
  Host download() const {
    Host host;
    const std::size_t n = count_;
    Memory::each(
        [&](const char*, const auto& from, auto& to) {
          to.resize(n);
          if (n > 0) exec_.download(from, std::span(to));
        },
        memory_, host);
    return host;
  }
  // Without content. Where particles come in there is room for some more of them.
  void allocate(std::size_t n) {
    count_ = n;
    constexpr std::size_t few = 1024;
    const std::size_t room = std::max(n, std::min(setup_.capacity, std::max(n + n / 4, few)));
    Memory::each([&](const char*, auto& array) { exec_.grow(array, room); }, memory_);
    exec_.grow(sums_, room);
    exec_.grow(built_at_, room);
    exec_.grow(skin_, room);
    exec_.grow(located_, room);
    use_arrays();
  }

  void place_walls(const std::vector<particles::BodyPose>& poses) {
    for (std::uint32_t body = 0; body < walls_.bodies(); ++body) walls_.set_pose(body, poses[body]);
    device_walls_.place(exec_, poses);
  }
  void set_poses(const std::vector<particles::BodyPose>& poses) {
    poses_ = poses;
    place_walls(poses);
  }

  // Velocity of the vessel [m/s].
  Vec3d frame_velocity() const {
    return setup_.vessel ? setup_.vessel->velocity(walls_.poses()[setup_.vessel->wall]) : Vec3d{};
  }
  Vec3d domain_shift() const {
    return setup_.follows ? walls_.poses()[*setup_.follows].p - setup_.follows_from : Vec3d{};
  }
  scene::Box domain_now() const {
    const Vec3d shift = domain_shift();
    const scene::Box now{setup_.domain.min + shift, setup_.domain.max + shift};
    if (setup_.follows)
      for (int a = 0; a < 3; ++a)
        for (const double end : {now.min[a], now.max[a]})
          if (!(std::fabs(end) <= centres_.range()))
            throw Error(ErrorCode::numerics,
                        "the domain has followed its body to " + scene::rounded(end) +
                            " m, and mixed precision counts to " + scene::rounded(centres_.range()) + " m",
                        "sph.domain.follows", "use \"precision\": \"double\"");
    return now;
  }
  // How far the vessel has moved since it had these poses [m]: lists stay valid while nothing moves relative
  // to it.
  Vec3d drift_since(const std::vector<particles::BodyPose>& poses_then) const {
    if (!setup_.vessel) return {};
    const Vessel& vessel = *setup_.vessel;
    return vessel.position(walls_.poses()[vessel.wall]) - vessel.position(poses_then[vessel.wall]);
  }
  static double shortest_of(const particles::Periods& periods) {
    double shortest = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a)
      if (periods.length[a] > 0) shortest = std::min(shortest, periods.length[a]);
    return shortest;
  }
  static std::vector<particles::BodyPose> moved_on(std::vector<particles::BodyPose> poses, double time) {
    for (particles::BodyPose& pose : poses) {
      pose.p += time * pose.v;
      pose.R = product(exp(time * pose.w).matrix(), pose.R);
    }
    return poses;
  }
  static std::vector<particles::BodyPose> displaced(std::vector<particles::BodyPose> poses, Vec3d by) {
    for (particles::BodyPose& pose : poses) pose.p += by;
    return poses;
  }

  Wrench wrench_of(const BodySum& s) const {
    Wrench w;
    for (int a = 0; a < 3; ++a) {
      w.force[a] = setup_.liquid.mass() * particles::from_fixed(s.acceleration[a], quanta_.acceleration);
      w.torque[a] = particles::from_fixed(s.torque[a], quanta_.torque);
    }
    return w;
  }

  void expect_stable(double dt) const {
    const StepLimits limits =
        step_limits(setup_.liquid, figures_.largest_speed, figures_.largest_acceleration);
    if (dt > 0 && dt <= limits.smallest * (1 + 1e-9)) return;
    throw Error(ErrorCode::numerics,
                "a step of " + scene::rounded(dt) + " s, where sound and speed allow " +
                    scene::rounded(limits.sound) + " s, viscosity " + scene::rounded(limits.viscous) +
                    " s and acceleration " + scene::rounded(limits.force) + " s",
                "liquid", "take a step of at most the smallest of them");
  }

  // Periods are whole quanta, so that images are exact.
  void round_periods() {
    for (int a = 0; a < 3; ++a) {
      double& length = setup_.periods.length[a];
      if (!(length > 0)) continue;
      if constexpr (std::is_same_v<Real, float>) {
        const double quanta = std::nearbyint(length * unit_.inverse);
        length = quanta * static_cast<double>(unit_.size);
        pairs_.apart.period[a] =
            static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(quanta)));
      } else {
        pairs_.apart.period[a] = length;
      }
      setup_.domain.max[a] = setup_.domain.min[a] + length;
    }
  }

  // Initialises particle i as particle k of `from`, with the gradient of a liquid at rest. Its other values
  // are zero.
  void place(Host& host, std::uint32_t i, const LiquidState& from, std::size_t k) {
    particles::FinePart<Real> fine{};
    host.number[i] = i;
    centres_.split(centres_.wrapped(centres_.of(from.position[k]), setup_.periods), host.position[i], fine);
    particles::set_velocity(from.velocity[k], host.velocity[i], fine);
    if constexpr (particles::has_fine_part<Real>) host.fine[i] = fine;
    host.compression[i] = from.compression[k];
    host.slope[i] = (setup_.liquid.density * setup_.liquid.gravity).template as<Real>();
    host.filled[i] = 1;
    Advance<Real> advance = advance_;
    advance.liquid = host.view(host.position.size());
    advance.update_state(i);
  }

  // The next step has no step before it.
  void begin_steps() {
    forget_step_before();
    step_loads_ = loads();
  }
  void forget_step_before() {
    exec_.copy(memory_.acceleration[0], memory_.acceleration[1]);
    exec_.copy(memory_.rate[0], memory_.rate[1]);
    use_arrays();
    previous_body_sums_ = body_sums_;
    std::copy(std::begin(power_), std::end(power_), std::begin(previous_power_));
    last_dt_ = 0;
  }

  // Gives the functors the arrays where they are now.
  void use_arrays() {
    liquid_ = memory_.view(count_);
    liquid_.neighbours = neighbours_.view();
    arrays_ = {facets_.view(),         particle_.data(),   walls_.any_closed() ? side_.data() : nullptr,
               place_of_facet_.data(), near_count_.data(), near_.data(),
               hiders_of_.data(),      sight_.data(),      seen_.data(),
               viewpoint_.data(),      by_pressure_.data()};
    pairs_.liquid = viewpoints_.liquid = rates_.liquid = wall_sums_.liquid = edges_.liquid = advance_.liquid =
        liquid_;
    viewpoints_.arrays = mark_.arrays = number_.arrays = place_.arrays = hiders_.arrays = see_whole_.arrays =
        see_partial_.arrays = wall_sums_.arrays = edges_.arrays = arrays_;
    mark_.walls = place_.walls = device_walls_.view_ahead();
    wall_sums_.walls = edges_.walls = device_walls_.view();
    viewpoints_.beside_wall = number_.beside_wall = wall_sums_.beside_wall = beside_wall_.data();
    pairs_.result = sums_.data();
    rates_.pairs = wall_sums_.pairs = sums_.data();
    rates_.walls = wall_sums_.result = of_walls_.data();
    rates_.before = wall_sums_.before = before_.data();
    edges_.entries = between_.data();
  }

  // Sums reach their range only in a liquid that has long burst.
  void set_quanta(std::size_t n) {
    const Liquid& l = setup_.liquid;
    const double c = l.sound_speed, many = static_cast<double>(n);
    const double acceleration = 1e4 * c * c / l.spacing + 1e3 * many * norm(l.gravity);
    quanta_.acceleration = particles::Quantum::for_range(acceleration);
    quanta_.rate = particles::Quantum::for_range(1e4 * c / l.spacing);
    quanta_.power = particles::Quantum::for_range(l.mass() * (acceleration + many * c * c / l.spacing) * c);
    const Vec3d size = setup_.domain.max - setup_.domain.min;
    // Beyond these squares the run ends at once.
    quanta_.square = particles::Quantum::for_range(1e4 * many);
    quanta_.torque = particles::Quantum::for_range(l.mass() * acceleration * norm(size));
    // Of two particles. A liquid at twice its density, where the run ends, has 3 and 1.
    const double fastest = c / l.spacing,
                 viscous = l.viscosity / (l.density * l.spacing * l.spacing) + l.artificial * fastest;
    pairs_.of_acceleration =
        particles::AddendScale<Real>::of(quanta_.acceleration, 64 * (fastest + viscous) * c);
    pairs_.of_rate = particles::AddendScale<Real>::of(quanta_.rate, 64 * fastest);
    rates_.quanta = wall_sums_.quanta = edges_.quanta = quanta_;
  }

  // See engine/lists.hpp.
  Strays locate_particles();
  void rebuild();
  void sort_into_cells(const Buffer<Vec3d>& positions);
  void choose_skins();
  LargestNear largest_in_cells(const Buffer<float>& value);
  void build_lists();
  template <class Mark>
  std::uint32_t list_marked(std::uint32_t n, Mark mark, Buffer<std::uint32_t>& before,
                            Buffer<std::uint32_t>& list);
  void list_beside_walls();
  // See engine/lost.hpp.
  template <class Stays>
  std::uint32_t mark_staying(Stays stays);
  std::vector<TakenParticle> take_unmarked(std::uint32_t particles);
  void take_out_lost();
  // See engine/cell_order.hpp.
  void take(const Buffer<std::uint32_t>& source, std::size_t n);
  void put_in_order_of_cells();
  // Builds the lists of built_at_ and built_poses_.
  void use_saved_lists();

  void refuse_outside(std::uint32_t number) const {
    const Host host = download();
    const auto i = static_cast<std::size_t>(std::ranges::find(host.number, number) - host.number.begin());
    const Vec3d x = centres_.metres(centres_.joined(host.position[i], fine_of(host, i)));
    throw Error(
        ErrorCode::numerics,
        "particle " + std::to_string(number) + " is at " + scene::rounded(x) + " m, outside the domain",
        "liquid", "enlarge the domain, or take a smaller step");
  }

  // Names the first particle that sees a facet through so many others that some parts are missing.
  [[noreturn]] void refuse_crowded() const {
    const Host host = download();
    const double R = setup_.liquid.support();
    std::string where = "a particle";
    NearWalls near;
    for (std::uint32_t i = 0; i < count(); ++i) {
      const Vec3d x = centres_.metres(centres_.joined(host.position[i], fine_of(host, i)));
      walls_.find_seen(x, R, near);
      bool complete = true;
      for (int k = 0; k < near.count && complete; ++k)
        seen_integrals(x, near, k, wall_sums_.kernel, complete);
      if (complete) continue;
      where = "the particle at " + scene::rounded(x) + " m";
      break;
    }
    throw Error(ErrorCode::scene,
                "the triangles within " + scene::rounded(R) + " m of " + where +
                    " hide each other in very many parts",
                "walls", "remove triangles there that are much smaller than the spacing of the liquid");
  }

  // From where particles will be after the time `ahead`, and as bodies will be then [s].
  void see_facets(double ahead) {
    device_walls_.place_ahead(exec_, ahead != 0 ? moved_on(poses_, ahead) : poses_);
    mark_.walls = place_.walls = device_walls_.view_ahead();
    viewpoints_.ahead = ahead;
    exec_.for_each(beside_walls_, viewpoints_);
    exec_.for_each(facets_.total, mark_);
    exec_.for_each(beside_walls_, number_);
    exec_.for_each(facets_.total, place_);
    exec_.zero(sight_, facets_.total);
    exec_.for_each_where(facets_.total, IsNear{arrays_}, hiders_);
    exec_.for_each_of_two(facets_.total, HasSight{sight_.data(), Sight::partial}, see_partial_,
                          HasSight{sight_.data(), Sight::whole}, see_whole_);
  }

  // ahead: half of the next step, for which what particles see of facets has to serve as well, less than 0
  // half of this one; 0: for this step alone [s].
  void sum_rates(double ahead = 0) {
    const auto sum_pairs = [this] { exec_.sum_over_lanes(count(), pairs_); };
    if (seen_ahead_)
      sum_pairs();
    else
      exec_.side_by_side([this, ahead] { see_facets(ahead); }, sum_pairs);
    seen_ahead_ = !seen_ahead_ && ahead > 0;
    frame_ = rates_.frame = frame_velocity();
    rates_.drift = drift_;
    rates_.built_at = built_at_.data();
    rates_.skin = skin_.data();
    body_sums_.resize(walls_.bodies());
    const bool many_facets = facets_.total > 4 * beside_walls_;
    const Tally sum =
        exec_.template reduce<Tally>(body_sums_, SumOver{beside_walls_, wall_sums_, many_facets},
                                     SumOver{count(), rates_}, SumOver{between_bodies_, edges_});
    if (sum.burst != 0)
      throw Error(ErrorCode::numerics,
                  "the liquid flies apart: forces between two particles are beyond any that a liquid of this "
                  "speed of sound has",
                  "liquid", "give a larger sound_speed, or a smaller spacing of the liquid");
    if (sum.crowded_by_facets > 0) refuse_crowded();
    for (int p = 0; p < powers; ++p) power_[p] = particles::from_fixed(sum.power[p], quanta_.power);
    holds_for_ = sum.holds_for;
    figures_.largest_speed = std::sqrt(sum.largest_speed2);
    figures_.largest_acceleration = std::sqrt(sum.largest_acceleration2);
    figures_.largest_compression = sum.largest_compression;
    const auto share = [this](std::uint32_t n) {
      return count_ > 0 ? static_cast<double>(n) / static_cast<double>(count_) : 0;
    };
    const auto mean = [this](std::int64_t squares, std::uint32_t n) {
      return n > 0 ? std::sqrt(particles::from_fixed(squares, quanta_.square) / n) : 0;
    };
    figures_.fast_share = share(sum.fast);
    figures_.fast_mach = mean(sum.fast_mach2, sum.fast);
    figures_.dense_share = share(sum.dense);
    figures_.dense_compression = mean(sum.dense_compression2, sum.dense);
    for (int a = 0; a < 3; ++a)
      figures_.pair_impulse_rate[a] =
          setup_.liquid.mass() * particles::from_fixed(sum.momentum_rate[a], quanta_.acceleration);
  }

  struct Work {
    double of[powers]{};  // [J]
  };

  LiquidSetup setup_;
  SkinRule skins_;
  double reach_ = 0;  // support and two of the widest skins [m]
  mutable Exec exec_;
  Walls walls_;
  DeviceWalls<Exec> device_walls_;
  particles::LengthUnit<Real> unit_;
  particles::CentreUnit<Real> centres_;

  std::size_t count_ = 0;  // particles
  Memory memory_;
  Buffer<PairSums<Real, shifting>> sums_;
  // Lists, and what they were built from.
  particles::CellGrid grid_;
  std::int32_t cells_of_reach_ = 1;
  Vec3d grid_origin_;  // where the domain is at the start [m]
  Buffer<std::uint32_t> key_, scratch_, cell_start_, in_cell_;
  Buffer<Position<Real>> position_in_cell_;
  Buffer<Vec3d> built_at_, located_;  // positions when the lists were built, and for the next lists [m]
  std::vector<particles::BodyPose> built_poses_;
  Buffer<particles::BodyPose> built_pose_;
  bool built_ = false;    // lists are those of built_at_
  Vec3d drift_;           // of the vessel since then, at the last sums [m]
  Vec3d frame_;           // velocity of the vessel at the last sums [m/s]
  double holds_for_ = 0;  // particles stay within their skins for this time from the last sums on [s]
  Buffer<float> skin_, near_skin_, largest_;  // see Reaches, and LargestInCell
  float skin_of_walls_ = 0;                   // [m]
  bool keeps_all_ = false;                    // a particle outside the domain is an error
  LostParticles lost_;
  Buffer<particles::OutletRegion> outlets_;                 // see take_out()
  Buffer<std::uint32_t> before_;                            // how many beside walls precede each particle
  Buffer<std::uint32_t> stay_before_, stay_before_number_;  // see PartLost
  Buffer<std::uint32_t> beside_wall_in_order_, class_, beside_wall_;  // see FacetClasses
  Buffer<std::uint32_t> between_before_, between_;                    // see MarkBetweenBodies
  std::uint32_t between_bodies_ = 0;                                  // entries of between_
  Buffer<WallSums> of_walls_;
  std::uint32_t beside_walls_ = 0;
  List<Exec, Neighbour> neighbours_;
  List<Exec, std::uint32_t> facets_;
  Buffer<std::uint32_t> particle_, near_count_, place_of_facet_;
  Buffer<float> distance_, clearance_;  // see MeasureFacets and FindClearance
  Buffer<NearFacet> near_;
  Buffer<Hiders> hiders_of_;
  Buffer<std::int8_t> side_;
  Buffer<Sight> sight_;
  Buffer<SeenFacet> seen_;
  Buffer<Vec3d> viewpoint_, by_pressure_;
  bool seen_ahead_ = false;  // what particles see of facets serves for the next sums as well
  mutable Buffer<std::uint32_t> near_before_;  // see near_line()
  mutable Buffer<NearParticle> near_line_;

  // The functors of a step.
  LiquidArrays<Real> liquid_;
  WallArrays arrays_;
  SumPairs<Real, shifting> pairs_;
  ChooseViewpoints<Real> viewpoints_;
  MarkFacets mark_;
  NumberFacets number_;
  PlaceFacet place_;
  FindHiders hiders_;
  SeeFacets<Sight::whole> see_whole_;
  SeeFacets<Sight::partial> see_partial_;
  SumWalls<Real, shifting> wall_sums_;
  SumRates<Real, shifting> rates_;
  SumEdges<Real> edges_;
  Advance<Real> advance_;
  Quanta quanta_;

  std::vector<BodySum> body_sums_, previous_body_sums_;
  std::vector<Wrench> step_loads_;
  std::vector<particles::BodyPose> poses_;
  double power_[powers]{}, previous_power_[powers]{};  // [W]
  Work work_;
  double last_dt_ = 0;  // [s]
  StepFigures figures_;
  StartCost start_cost_;

  // See save().
  struct Copy {
    std::vector<std::vector<std::byte>> values;  // in the order of each_value
    std::size_t count = 0;
    Memory memory;
    Buffer<Vec3d> built_at;
    Buffer<float> skin;
  } saved_;
};

}  // namespace tandem::sph
