// The engine in one precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "particles/base/thread_pool.hpp"
#include "particles/grid/cell_grid.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/neighbour_list.hpp"
#include "sph_server/step/advance.hpp"
#include "sph_server/step/sum_rates.hpp"

namespace tandem::sph {

inline constexpr double list_skin = 0.3;  // [spacings]

// Sums of one thread, one per body.
struct BodySums {
  std::vector<BodySum> of;
  void add(std::uint32_t body, Vec3d acceleration, Vec3d torque, const Quanta& q) {
    of[body].add(acceleration, torque, q);
  }
};

template <class Real, bool shifting>
class LiquidEngineOf final : public LiquidEngine {
 public:
  using LiquidEngine::set_state;
  using LiquidEngine::step;

  explicit LiquidEngineOf(const LiquidSetup& setup)
      : setup_(setup),
        reach_(setup.liquid.support() + list_skin * setup.liquid.spacing),
        pool_(setup.threads),
        walls_(setup.walls, reach_, setup.slip),
        unit_(particles::LengthUnit<Real>::for_lengths(4 * setup.liquid.support())) {
    expect_liquid(setup.liquid);
    round_periods();
    double farthest = 0;
    for (int a = 0; a < 3; ++a)
      farthest = std::max({farthest, std::fabs(setup.domain.min[a]), std::fabs(setup.domain.max[a])});
    centres_ = particles::CentreUnit<Real>::for_range(unit_, farthest, 4);
    rates_.properties = setup.liquid;
    rates_.pairs.unit = unit_;
    rates_.pairs.pair = PairConstants<Real>::of(setup.liquid);
    rates_.walls.centres = centres_;
    rates_.walls.wall = WallConstants::of(setup.liquid);
    rates_.walls.repulsion = WallRepulsion::of(setup.liquid);
    rates_.walls.kernel = WallKernel::of(setup.liquid.support(), setup.liquid.spacing);
    rates_.walls.mass = setup.liquid.mass();
    rates_.walls.spacing = setup.liquid.spacing;
    rates_.walls.walls = walls_.view();
    advance_.centres = centres_;
    advance_.periods = setup_.periods;
    advance_.properties = setup.liquid;
  }

  void set_state(const LiquidState& state, const std::vector<particles::BodyPose>& poses) override {
    set_poses(poses);
    const std::size_t n = state.size();
    if ((n == 0 && setup_.capacity == 0) || n >= Neighbour::most)
      throw Error(ErrorCode::scene, "a liquid of " + std::to_string(n) + " particles", "particles",
                  "give from 1 to " + std::to_string(Neighbour::most - 1));
    allocate(n);
    for (std::uint32_t i = 0; i < n; ++i) place(i, state, i);
    set_quanta(std::max(n, setup_.capacity));
    built_at_.clear();
    rebuild();
    // The tension that particles bear follows from what fills their kernels.
    sum_rates();
    for (std::uint32_t i = 0; i < n; ++i) advance_.update_state(i);
    sum_rates();
    begin_steps();
    work_ = {};
  }
  void exchange(std::span<const std::uint32_t> leaving, const LiquidState& arriving,
                const std::vector<particles::BodyPose>& poses) override;

  LiquidState state() const override {
    LiquidState s;
    for (std::uint32_t i = 0; i < position_.size(); ++i) {
      s.position.push_back(centre(i));
      s.velocity.push_back(particles::velocity_of(velocity_[i], fine_[i]));
      s.compression.push_back(compression_[i]);
      s.pressure.push_back(static_cast<double>(state_[i].pressure));
      s.slope.push_back(slope_[i].template as<double>());
    }
    return s;
  }

  void step(double dt, const std::vector<particles::BodyPose>& poses) override {
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
    std::vector<double> farthest2(pool_.size(), 0.0);
    for_each([&](unsigned thread, std::uint32_t i) {
      advance_(i);
      const Vec3d moved = setup_.periods.shortest(centre(i) - built_at_[i]);
      // A position that is not a number is rebuilt, and refused there.
      const double far2 = norm2(moved);
      farthest2[thread] = far2 <= farthest2[thread] ? farthest2[thread] : far2;
    });
    double far2 = 0;
    for (const double one : farthest2) far2 = one <= far2 ? far2 : one;
    const double skin = list_skin * setup_.liquid.spacing;
    if (!(2 * std::sqrt(far2) + walls_.moved_from(built_poses_) < skin)) rebuild();
    sum_rates();
  }

  const std::vector<particles::BodyPose>& poses() const override { return walls_.poses(); }

  void pack(double pressure, double dt, double damping, int steps) override {
    advance_.packing_pressure = pressure;
    advance_.damping = damping;
    rates_.properties.gravity = {};
    rates_.walls.continued = false;
    for (std::uint32_t i = 0; i < position_.size(); ++i) advance_.update_state(i);
    sum_rates();
    acceleration_[1] = acceleration_[0];
    for (int k = 0; k < steps; ++k) step(dt, poses());
    rates_.properties.gravity = setup_.liquid.gravity;
    rates_.walls.continued = true;
    advance_.packing_pressure = 0;
    advance_.damping = 1;
  }

  std::vector<Wrench> loads() const override {
    std::vector<Wrench> loads;
    for (const BodySum& s : body_sums_) loads.push_back(wrench_of(s));
    return loads;
  }
  const std::vector<Wrench>& step_loads() const override { return step_loads_; }

  Vec3d momentum() const override {
    Vec3d sum;
    for (std::size_t i = 0; i < velocity_.size(); ++i) sum += particles::velocity_of(velocity_[i], fine_[i]);
    return setup_.liquid.mass() * sum;
  }

  double volume() const override {
    double sum = 0;
    for (const double e : compression_) sum += 1 / (1 + e);
    return setup_.liquid.mass() / setup_.liquid.density * sum;
  }

  EnergyBalance energies() const override {
    EnergyBalance e;
    const Liquid& l = setup_.liquid;
    for (std::uint32_t i = 0; i < position_.size(); ++i) {
      e.kinetic += 0.5 * l.mass() * norm2(particles::velocity_of(velocity_[i], fine_[i]));
      e.compression += l.mass() * l.sound_speed * l.sound_speed * tait_energy(compression_[i]);
    }
    const auto of = [this](Power p) { return work_.of[static_cast<int>(p)]; };
    e.gravity = of(Power::gravity);
    e.viscosity = of(Power::viscosity);
    e.bulk_viscosity = of(Power::bulk_viscosity);
    e.diffusion = of(Power::diffusion);
    e.cavitation = of(Power::cavitation);
    e.ghost = of(Power::ghost);
    e.repulsion = of(Power::repulsion);
    e.walls = of(Power::walls);
    e.edges = of(Power::edges);
    return e;
  }

  StepFigures figures() const override { return figures_; }

  void save() override;
  void restore() override;
  void write(const Sink& sink) const override;
  void read(const Source& source, std::size_t particles) override;

 private:
  // All that a step reads and that follows from nothing else, besides the lists.
  template <class Engine, class Visit>
  static void each_array(Engine& e, Visit visit) {
    visit("position", e.position_);
    visit("velocity", e.velocity_);
    visit("fine", e.fine_);
    visit("pressure_volume", e.state_);
    visit("slope", e.slope_);
    visit("filled", e.filled_);
    if constexpr (shifting) visit("shift", e.shift_);
    visit("compression", e.compression_);
    visit("acceleration", e.acceleration_[0]);
    visit("previous_acceleration", e.acceleration_[1]);
    visit("rate", e.rate_[0]);
    visit("previous_rate", e.rate_[1]);
    visit("body_sums", e.body_sums_);
    visit("previous_body_sums", e.previous_body_sums_);
    visit("step_loads", e.step_loads_);
    visit("poses", e.poses_);
    visit("built_at", e.built_at_);
    visit("built_poses", e.built_poses_);
    visit("power", e.power_);
    visit("previous_power", e.previous_power_);
    visit("work", e.work_.of);
    visit("last_dt", e.last_dt_);
    visit("figures", e.figures_);
  }

  // Arrays with an entry per particle.
  template <class Visit>
  void each_particle_array(Visit visit) {
    visit(position_);
    visit(velocity_);
    visit(fine_);
    visit(state_);
    visit(slope_);
    visit(filled_);
    if constexpr (shifting) visit(shift_);
    visit(compression_);
    for (int side = 0; side < 2; ++side) {
      visit(acceleration_[side]);
      visit(rate_[side]);
    }
  }

  template <class Each>
  void for_each(Each each) {
    const std::size_t n = position_.size();
    pool_.run([&](unsigned thread) {
      const std::size_t begin = n * thread / pool_.size(), end = n * (thread + 1) / pool_.size();
      for (std::size_t i = begin; i < end; ++i) each(thread, static_cast<std::uint32_t>(i));
    });
  }

  void place_walls(const std::vector<particles::BodyPose>& poses) {
    for (std::uint32_t body = 0; body < walls_.bodies(); ++body) walls_.set_pose(body, poses[body]);
  }
  void set_poses(const std::vector<particles::BodyPose>& poses) {
    poses_ = poses;
    place_walls(poses);
  }

  // The bytes of an array, or of a single value.
  template <class Array>
  static auto bytes_of(Array& array) {
    if constexpr (requires { std::span(array); })
      return as_bytes_of(std::span(array));
    else
      return as_bytes_of(std::span(&array, 1));
  }
  template <class T, std::size_t extent>
  static auto as_bytes_of(std::span<T, extent> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(values);
  }
  template <class Array>
  static void assign(const std::vector<std::byte>& bytes, Array& array) {
    const std::span<const std::byte> to = bytes_of(array);
    if (!bytes.empty()) std::memcpy(const_cast<std::byte*>(to.data()), bytes.data(), bytes.size());
  }

  Wrench wrench_of(const BodySum& s) const {
    Wrench w;
    for (int a = 0; a < 3; ++a) {
      w.force[a] = setup_.liquid.mass() * particles::from_fixed(s.acceleration[a], quanta_.acceleration);
      w.torque[a] = particles::from_fixed(s.torque[a], quanta_.torque);
    }
    return w;
  }

  void use_list() {
    liquid_.start = list_.start.data();
    liquid_.neighbour = list_.neighbour.data();
    give_arrays();
  }

  Vec3d centre(std::uint32_t i) const { return centres_.metres(centres_.joined(position_[i], fine_[i])); }

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
        rates_.pairs.period[a] =
            static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(quanta)));
      } else {
        rates_.pairs.period[a] = length;
      }
      setup_.domain.max[a] = setup_.domain.min[a] + length;
    }
  }

  void allocate(std::size_t n) {
    each_particle_array([n](auto& array) { array.assign(n, {}); });
    use_arrays();
  }

  void use_arrays() {
    liquid_.count = static_cast<std::uint32_t>(position_.size());
    liquid_.position = position_.data();
    liquid_.velocity = velocity_.data();
    liquid_.fine = fine_.data();
    liquid_.state = state_.data();
    liquid_.compression = compression_.data();
    liquid_.slope = slope_.data();
    liquid_.filled = filled_.data();
    if constexpr (shifting) liquid_.shift = shift_.data();
    for (int side = 0; side < 2; ++side) {
      liquid_.acceleration[side] = acceleration_[side].data();
      liquid_.rate[side] = rate_[side].data();
    }
    give_arrays();
  }

  // Initialises particle i as particle k of `from`, with the gradient of a liquid at rest.
  void place(std::uint32_t i, const LiquidState& from, std::size_t k) {
    particles::FinePart<Real> fine{};
    position_[i].radius = 0;
    centres_.split(centres_.wrapped(centres_.of(from.position[k]), setup_.periods), position_[i], fine);
    particles::set_velocity(from.velocity[k], velocity_[i], fine);
    fine_[i] = fine;
    compression_[i] = from.compression[k];
    slope_[i] = (setup_.liquid.density * setup_.liquid.gravity).template as<Real>();
    filled_[i] = 1;
    advance_.update_state(i);
  }

  // The next step has no step before it.
  void begin_steps() {
    acceleration_[1] = acceleration_[0];
    rate_[1] = rate_[0];
    previous_body_sums_ = body_sums_;
    step_loads_ = loads();
    std::copy(std::begin(power_), std::end(power_), std::begin(previous_power_));
    last_dt_ = 0;
  }

  void give_arrays() { rates_.pairs.liquid = rates_.walls.liquid = advance_.liquid = liquid_; }

  // Sums reach their range only in a liquid that has long burst.
  void set_quanta(std::size_t n) {
    const Liquid& l = setup_.liquid;
    const double c = l.sound_speed, many = static_cast<double>(n);
    const double acceleration = 1e4 * c * c / l.spacing + 1e3 * many * norm(l.gravity);
    quanta_.acceleration = particles::Quantum::for_range(acceleration);
    quanta_.rate = particles::Quantum::for_range(1e4 * c / l.spacing);
    quanta_.power = particles::Quantum::for_range(many * l.mass() * acceleration * c);
    const Vec3d size = setup_.domain.max - setup_.domain.min;
    quanta_.torque = particles::Quantum::for_range(l.mass() * acceleration * norm(size));
    rates_.pairs.quanta = rates_.walls.quanta = quanta_;
  }

  void rebuild() {
    std::vector<Vec3d> x(position_.size());
    for (std::uint32_t i = 0; i < x.size(); ++i) {
      x[i] = centre(i);
      for (int a = 0; a < 3; ++a)
        if (!(x[i][a] >= setup_.domain.min[a] && x[i][a] <= setup_.domain.max[a]))
          throw Error(
              ErrorCode::numerics,
              "particle " + std::to_string(i) + " is at " + scene::rounded(x[i]) + " m, outside the domain",
              "liquid", "enlarge the domain, or take a smaller step");
      if (!built_at_.empty() && built_at_.size() == x.size()) {
        const Vec3d now = built_at_[i] + setup_.periods.shortest(x[i] - built_at_[i]);
        figures_.passed_walls += walls_.passed(built_poses_, built_at_[i], now) ? 1 : 0;
      }
    }
    if (grid_.total == 0)
      grid_ =
          particles::make_cell_grid(setup_.domain, setup_.periods, reach_, particles::most_cells(x.size()));
    build_list(grid_, setup_.periods, x, reach_, walls_, pool_, list_);
    use_list();
    built_at_ = std::move(x);
    built_poses_ = walls_.poses();
    ++figures_.rebuilds;
  }

  void sum_rates() {
    std::vector<Tally> tallies(pool_.size());
    std::vector<BodySums> bodies(pool_.size(), BodySums{std::vector<BodySum>(walls_.bodies())});
    for_each([&](unsigned thread, std::uint32_t i) { rates_(i, tallies[thread], bodies[thread]); });
    Tally sum;
    body_sums_.assign(walls_.bodies(), {});
    for (unsigned t = 0; t < pool_.size(); ++t) {
      sum.add(tallies[t]);
      for (std::uint32_t b = 0; b < walls_.bodies(); ++b) body_sums_[b].add(bodies[t].of[b]);
    }
    if (sum.crowded_by_facets > 0)
      throw Error(ErrorCode::scene,
                  "more than " + std::to_string(NearWalls::most) + " facets within " +
                      scene::rounded(setup_.liquid.support()) +
                      " m of a particle, or facets that hide each other in very many parts",
                  "walls", "give a mesh with larger triangles, or a smaller spacing of the liquid");
    for (int p = 0; p < powers; ++p) power_[p] = particles::from_fixed(sum.power[p], quanta_.power);
    figures_.largest_speed = std::sqrt(sum.largest_speed2);
    figures_.largest_acceleration = std::sqrt(sum.largest_acceleration2);
    figures_.largest_compression = sum.largest_compression;
    for (int a = 0; a < 3; ++a)
      figures_.pair_impulse_rate[a] =
          setup_.liquid.mass() * particles::from_fixed(sum.momentum_rate[a], quanta_.acceleration);
  }

  struct Work {
    double of[powers]{};  // [J]
  };

  LiquidSetup setup_;
  double reach_ = 0;  // support and skin [m]
  particles::ThreadPool pool_;
  Walls walls_;
  particles::LengthUnit<Real> unit_;
  particles::CentreUnit<Real> centres_;
  particles::CellGrid grid_;
  NeighbourList list_;
  std::vector<Vec3d> built_at_;                   // positions when the list was built [m]
  std::vector<particles::BodyPose> built_poses_;  // and poses
  std::vector<particles::PositionRadius<Real>> position_;
  std::vector<particles::VelocityKind<Real>> velocity_;
  std::vector<particles::FinePart<Real>> fine_;
  std::vector<ParticleState<Real>> state_;
  std::vector<Vec3<Real>> slope_, shift_;
  std::vector<float> filled_;
  std::vector<double> compression_;
  std::vector<Vec3d> acceleration_[2];
  std::vector<double> rate_[2];
  std::vector<BodySum> body_sums_, previous_body_sums_;
  std::vector<Wrench> step_loads_;
  std::vector<particles::BodyPose> poses_;
  std::vector<std::vector<std::byte>> saved_;  // in the order of each_array
  NeighbourList saved_list_;
  LiquidArrays<Real> liquid_;
  SumRates<Real, shifting> rates_;
  Quanta quanta_;
  Advance<Real> advance_;
  double power_[powers]{}, previous_power_[powers]{};  // [W]
  Work work_;
  double last_dt_ = 0;  // [s]
  StepFigures figures_;
};

}  // namespace tandem::sph
