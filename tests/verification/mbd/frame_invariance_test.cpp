// A machine moves the same wherever it stands, however its data are rounded and in whatever order they are
// written. TANDEM_SOAK=1 tries more frames, of a random seed that is printed; TANDEM_SEED=N repeats one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numbers>

#include "common/error.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/constrained_machines.hpp"
#include "tests/verification/mbd/recorded_run.hpp"

namespace tandem::mbd {
namespace {

constexpr int windows = 8;
constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double data_tolerance = 1e-4;  // default of mbd.integrator.assembly_tolerance [-]
constexpr double same = 1e-6;            // deviation of two runs of one machine [-]

bool soak() {
  return std::getenv("TANDEM_SOAK") != nullptr;
}

std::uint64_t seed() {
  static const std::uint64_t value = [] {
    std::uint64_t n = 20240607;
    if (const char* given = std::getenv("TANDEM_SEED"))
      n = std::strtoull(given, nullptr, 10);
    else if (soak())
      n = std::random_device{}();
    if (soak()) std::printf("TANDEM_SEED=%llu\n", static_cast<unsigned long long>(n));
    return n;
  }();
  return value;
}

int frames_per_machine() {
  return soak() ? 600 : 60;
}

const std::vector<ConstrainedMachine>& all_machines() {
  static const std::vector<ConstrainedMachine> list = [] {
    std::vector<ConstrainedMachine> machines = constrained_machines();
    for (ConstrainedMachine& machine : shipped_machines()) machines.push_back(std::move(machine));
    return machines;
  }();
  return list;
}

const ConstrainedMachine& machine_named(const std::string& name) {
  return *std::find_if(all_machines().begin(), all_machines().end(),
                       [&](const ConstrainedMachine& m) { return m.name == name; });
}

// What two runs of one machine may differ by.
double tolerance(const scene::Scene& scene) {
  const auto& controlled = scene.mbd->integrator.error_tolerance;
  return controlled ? std::max(same, 10 * *controlled) : same;
}

// The first run of a machine, and how long others can be compared with it.
struct Reference {
  RecordedRun run;
  std::size_t frames = 0;
  double end = 0, growth = 0;  // by which a small change has grown until then [-]
};

// A change of 1e-12 stays below a tenth of `same`.
Reference reference(const ConstrainedMachine& machine) {
  Reference r{record(machine.scene, machine.end, windows), 0, 0, 0};
  std::mt19937_64 random(1);
  const double share = 1e-8;
  const RecordedRun changed = record(heavier(machine.scene, share, random), machine.end, windows);
  for (std::size_t n = 1; n <= r.run.frames.size(); ++n) {
    Indices indices;
    for (std::size_t i = 0; i < machine.scene.mbd->bodies.size(); ++i) indices.body.push_back(i);
    for (std::size_t i = 0; i < machine.scene.mbd->joints.size(); ++i) indices.joint.push_back(i);
    const double growth =
        deviation(machine.scene, r.run, changed, test::RigidMotion(Quat{}), indices, n).most() / share;
    if (1e-12 * growth > .1 * same) break;
    r.frames = n;
    r.growth = growth;
    r.end = machine.end * static_cast<double>(n - 1) / windows;
  }
  return r;
}

// What happened in many runs that should all have come out the same.
class Tally {
 public:
  Tally(std::string kind, std::string machine) : kind_(std::move(kind)), machine_(std::move(machine)) {}

  // The reason why a run is not right; empty: it is.
  void add(const Deviation& d, const std::string& reason) {
    ++tried_;
    if (!(d.most() <= worst_)) worst_ = d.most();
    if (!(d.on_ground <= ground_)) ground_ = d.on_ground;
    if (!(d.reaction <= reaction_)) reaction_ = d.reaction;
    if (!reason.empty()) fail(reason);
  }
  void add_error(const std::string& what) {
    ++tried_;
    fail(what);
  }
  bool ok() const { return reasons_.empty() && tried_ > 0; }
  void print(double end, double limit) const {
    std::printf("| %-9s | %-28s | %4d | %7.3g | %8.1e | %8.1e | %8.1e | %8.1e | %4d |", kind_.c_str(),
                machine_.c_str(), tried_, end, limit, worst_, ground_, reaction_, failed_);
    for (const auto& [reason, count] : reasons_) std::printf(" %d x %s;", count, reason.c_str());
    std::printf("\n");
    std::fflush(stdout);
  }
  static void print_head() {
    std::printf("| %-9s | %-28s | %4s | %7s | %8s | %8s | %8s | %8s | %4s | reasons\n", "test", "machine",
                "runs", "end [s]", "limit", "motion", "ground", "joints", "fail");
  }
  std::string text() const {
    std::string all;
    for (const auto& [reason, count] : reasons_) all += std::to_string(count) + " x " + reason + "; ";
    return all;
  }

 private:
  // Reasons of one kind begin alike.
  void fail(const std::string& reason) {
    ++failed_;
    const auto first_words = [](const std::string& s) { return s.substr(0, 24); };
    for (auto& [known, count] : reasons_)
      if (first_words(known) == first_words(reason)) {
        ++count;
        return;
      }
    reasons_.emplace_back(reason.substr(0, 220), 1);
  }

  std::string kind_, machine_;
  int tried_ = 0, failed_ = 0;
  double worst_ = 0, ground_ = 0, reaction_ = 0;
  std::vector<std::pair<std::string, int>> reasons_;
};

// `run` is compared with the reference.
void judge(Tally& tally, const ConstrainedMachine& machine, const Reference& first, double limit,
           double reaction_limit, const test::RigidMotion& motion, const std::string& where,
           const std::function<RecordedRun()>& run, const Indices* indices = nullptr) {
  try {
    const RecordedRun seen = run();
    Indices same_order;
    for (std::size_t i = 0; i < machine.scene.mbd->bodies.size(); ++i) same_order.body.push_back(i);
    for (std::size_t i = 0; i < machine.scene.mbd->joints.size(); ++i) same_order.joint.push_back(i);
    const Deviation d =
        deviation(machine.scene, first.run, seen, motion, indices ? *indices : same_order, first.frames);
    std::string reason;
    char text[200];
    if (seen.degrees_of_freedom != first.run.degrees_of_freedom || seen.redundant != first.run.redundant) {
      std::snprintf(text, sizeof text,
                    "%d freedoms and %zu redundant equations for %d and %zu: ", seen.degrees_of_freedom,
                    seen.redundant, first.run.degrees_of_freedom, first.run.redundant);
      reason = text;
    }
    if (!(d.most() <= limit)) {
      std::snprintf(text, sizeof text, "deviates by %.1e in poses, %.1e in velocities, %.1e in energy ",
                    d.pose, d.velocity, d.energy);
      reason += text;
    } else if (!(d.on_ground <= reaction_limit)) {
      std::snprintf(text, sizeof text, "the force on the ground deviates by %.1e ", d.on_ground);
      reason += text;
    } else if (!(d.reaction <= reaction_limit)) {
      std::snprintf(text, sizeof text, "the force of a joint deviates by %.1e ", d.reaction);
      reason += text;
    }
    if (!reason.empty()) reason += where;
    tally.add(d, reason);
  } catch (const std::exception& error) {
    tally.add_error(error.what() + (" " + where));
  }
}

// Frame i of a machine: a third of them with a joint at the origin, a third with one on an axis.
struct Frame {
  test::RigidMotion motion{Quat{}};
  std::string text;
};

Frame frame(const ConstrainedMachine& machine, int i, std::mt19937_64& random) {
  const scene::Mbd& mbd = *machine.scene.mbd;
  const double size = size_of(machine.scene);
  const auto pick = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const auto unit = [](std::size_t axis, double value) {
    Vec3d v;
    v[static_cast<int>(axis)] = value;
    return v;
  };
  std::uniform_real_distribution<double> share(-1, 1);
  std::string text = "in frame " + std::to_string(i) + " (";

  const std::string joint_name = mbd.joints.empty() ? "" : mbd.joints[pick(mbd.joints.size())].name;
  Vec3d from = mbd.bodies[pick(mbd.bodies.size())].pose.p_WB, to;
  for (const scene::Joint& joint : mbd.joints)
    if (joint.name == joint_name) from = joint.position;
  switch (i % 3) {
    case 0:
      text += joint_name + " at the origin";
      break;
    case 1:
      to = unit(pick(3), 2 * size * share(random));
      text += joint_name + " on an axis";
      break;
    default: {
      const double away[] = {0, 1, 1e3};
      const double distance = away[(i / 3) % 3];
      to = distance > 0 ? distance * test::random_rotation(random).rotate({1, 0, 0})
                        : size * Vec3d{share(random), share(random), share(random)};
      text += std::to_string(static_cast<int>(distance)) + " m away";
    }
  }
  switch ((i / 3) % 4) {
    case 0:
    case 1:
      return {test::RigidMotion(test::random_rotation(random), from, to), text + ", any orientation)"};
    case 2:
      return {test::RigidMotion(exp(unit(pick(3), 3 * share(random))), from, to), text + ", about an axis)"};
    default: {
      Quat q = exp(unit(pick(3), std::numbers::pi / 2 * static_cast<double>(pick(4))));
      q = q * exp(unit(pick(3), std::numbers::pi / 2 * static_cast<double>(pick(4))));
      return {test::RigidMotion::quarter_turns(q, from, to), text + ", quarter turns)"};
    }
  }
}

class Machine : public testing::TestWithParam<std::string> {
 protected:
  Machine() : machine_(machine_named(GetParam())), random_(seed()) {}
  static void SetUpTestSuite() { Tally::print_head(); }

  const ConstrainedMachine& machine_;
  std::mt19937_64 random_;
};

// By how much small changes of the geometry grow in the machine without redundant equations [-].
double sensitivity(const ConstrainedMachine& machine, std::size_t frames) {
  constexpr double amount = 1e-7;
  const scene::Scene& scene = machine.determinate ? *machine.determinate : machine.scene;
  const double size = size_of(machine.scene);
  const RecordedRun exact = record(scene, machine.end, windows);
  std::mt19937_64 random(2);
  double largest = 0;
  for (int i = 0; i < 10; ++i) {
    Indices indices;
    for (std::size_t k = 0; k < scene.mbd->bodies.size(); ++k) indices.body.push_back(k);
    for (std::size_t k = 0; k < scene.mbd->joints.size(); ++k) indices.joint.push_back(k);
    const RecordedRun changed = record(test::perturbed(scene, amount, size, random), machine.end, windows);
    largest = std::max(largest,
                       deviation(scene, exact, changed, test::RigidMotion(Quat{}), indices, frames).most());
  }
  return largest / amount;
}

class FrameInvariance : public Machine {};

TEST_P(FrameInvariance, OfTheMotion) {
  const Reference first = reference(machine_);
  ASSERT_GT(first.frames, 1u) << "a small change has grown by " << first.growth;
  const bool known = machine_.determinate || first.run.redundant == 0;
  ConstrainedMachine shorter = machine_;
  if (shorter.rounded_end > 0) shorter.end = shorter.rounded_end;
  const double factor = known ? sensitivity(shorter, first.frames) : 0;
  Tally tally("frame", machine_.name);
  double largest_limit = 0;
  for (int i = 0; i < frames_per_machine(); ++i) {
    const Frame f = frame(machine_, i, random_);
    // Far from the origin the data themselves have lost digits.
    const double digit = std::numeric_limits<double>::epsilon() * norm(f.motion.to) / size_of(machine_.scene);
    const double limit = tolerance(machine_.scene) + digit * factor;
    largest_limit = std::max(largest_limit, limit);
    judge(tally, machine_, first, limit, 10 * limit, f.motion, f.text,
          [&] { return record(moved(machine_.scene, f.motion), machine_.end, windows); });
  }
  tally.print(first.end, largest_limit);
  EXPECT_TRUE(tally.ok()) << tally.text();
}

// A watch, a crane, and a machine in mm and t.
TEST_P(FrameInvariance, OfTheUnits) {
  const Reference first = reference(machine_);
  const double limit = tolerance(machine_.scene);
  Tally tally("units", machine_.name);
  const std::pair<double, double> units[] = {{1e-3, 1e-9}, {1e2, 1e6}, {1e3, 1e-3}, {1, 1e6}};
  int i = 0;
  for (const auto& [length, mass] : units)
    for (int repeat = 0; repeat < (soak() ? 30 : 3); ++repeat, ++i) {
      const Frame f = frame(machine_, i % 3 + 9 * (i / 3), random_);  // never far away
      char text[100];
      std::snprintf(text, sizeof text, "in units of 1/%g m and 1/%g kg ", length, mass);
      judge(tally, machine_, first, limit, 10 * limit, f.motion, text + f.text, [&] {
        const scene::Scene there = test::in_units(moved(machine_.scene, f.motion), length, mass);
        return in_units_of(machine_.scene, record(there, machine_.end, windows), length, mass);
      });
    }
  tally.print(first.end, limit);
  EXPECT_TRUE(tally.ok()) << tally.text();
}

// Different orders cut different joints, and truncation errors differ: by no more than twenty times the
// change that half the step makes.
TEST_P(FrameInvariance, OfTheOrderInTheFile) {
  const Reference first = reference(machine_);
  scene::Scene finer = machine_.scene;
  if (finer.mbd->integrator.step) *finer.mbd->integrator.step /= 2;
  if (finer.mbd->integrator.error_tolerance) *finer.mbd->integrator.error_tolerance /= 8;
  const RecordedRun fine = record(finer, machine_.end, windows);
  const Deviation truncation = deviation(machine_.scene, first.run, fine);
  const double limit = tolerance(machine_.scene) + 20 * truncation.most();
  Tally tally("order", machine_.name);
  for (int i = 0; i < (soak() ? 60 : 6); ++i) {
    const test::Reordered other = test::reordered(machine_.scene, random_);
    const Indices indices{other.body, other.joint};
    // Which joints carry what is determined where no equation is redundant.
    const double reaction_limit = first.run.redundant > 0 ? no_limit : 10 * limit + 10 * truncation.reaction;
    judge(
        tally, machine_, first, limit, reaction_limit, test::RigidMotion(Quat{}),
        "in order " + std::to_string(i), [&] { return record(other.scene, machine_.end, windows); },
        &indices);
  }
  tally.print(first.end, limit);
  EXPECT_TRUE(tally.ok()) << tally.text();
}

class Rounding : public Machine {};

TEST_P(Rounding, OfTheDataMovesTheMachineNoMoreThanItsSensitivitySays) {
  ConstrainedMachine machine = machine_;
  if (machine.rounded_end > 0) machine.end = machine.rounded_end;
  const Reference first = reference(machine);
  // Where no machine without redundant equations is known it has at least to move.
  const bool known = machine.determinate || first.run.redundant == 0;
  const double factor = known ? sensitivity(machine, first.frames) : 100, size = size_of(machine.scene);
  for (const int digits : {9, 7, 6}) {
    Tally tally("digits " + std::to_string(digits), machine.name);
    double largest_limit = 0;
    for (int i = 0; i < (soak() ? 60 : 10); ++i) {
      Frame f = frame(machine, i, random_);
      // The data are to be decimals of the machine, not of its distance.
      if (i % 3 == 2) f.motion.to = size * normalized(Vec3d{1, 2, -1.5});
      const scene::Scene there = moved(machine.scene, f.motion);
      const double limit = same + 10 * test::last_place(there, digits, size) * factor;
      largest_limit = std::max(largest_limit, limit);
      judge(tally, machine, first, limit, no_limit, f.motion, f.text, [&] {
        try {
          return record(test::rounded(there, digits), machine.end, windows);
        } catch (const Error& error) {
          // Decimals of a large machine that are none of its smallest loop contradict each other there.
          const bool coarse =
              test::last_place(there, digits, size) > .1 * data_tolerance * machine.smallest_loop;
          if (error.code() != ErrorCode::scene || !coarse) throw;
          return first.run;
        }
      });
    }
    tally.print(first.end, largest_limit);
    EXPECT_TRUE(tally.ok()) << digits << " digits: " << tally.text();
  }
}

// From round-off to a drawing that is wrong: a machine moves as its sensitivity says or is refused, and up to
// 1e-6 it is not refused.
TEST_P(Rounding, OfAnySizeNeverLocksTheMachine) {
  ConstrainedMachine machine = machine_;
  if (machine.rounded_end > 0) machine.end = machine.rounded_end;
  const Reference first = reference(machine);
  if (first.run.redundant == 0 || !machine.determinate) GTEST_SKIP() << "no redundant equations";
  const double factor = sensitivity(machine, first.frames), size = size_of(machine.scene);
  Tally tally("misfit", machine.name);
  int refused = 0;
  for (double amount = 1e-10; amount < .2; amount *= std::sqrt(10))
    for (int i = 0; i < (soak() ? 20 : 2); ++i) {
      const scene::Scene there = test::perturbed(machine.scene, amount, size, random_);
      char text[60];
      std::snprintf(text, sizeof text, "with data changed by %.0e", amount);
      const double linear = 20 * amount * factor, limit = linear < 1 ? 3 * same + linear : no_limit;
      judge(tally, machine, first, limit, no_limit, test::RigidMotion(Quat{}), text, [&] {
        try {
          const RecordedRun run = record(there, machine.end, windows);
          // Beyond the tolerance of the data a machine may be a frame, which its run is marked as
          // (mbd_locked); hinges of a long loop that are no longer parallel make another machine.
          const bool locked =
              run.degrees_of_freedom == 0 && first.run.degrees_of_freedom > 0 && amount > .9 * data_tolerance;
          const bool another = run.degrees_of_freedom < first.run.degrees_of_freedom && amount > 5e-3;
          if (!locked && !another) return run;
          ++refused;
          return first.run;
        } catch (const Error& error) {
          // Beyond the tolerance a loop may come apart in the course of the motion.
          const bool may_fail = error.code() == ErrorCode::numerics && amount > .9 * data_tolerance;
          const bool may_be_refused =
              error.code() == ErrorCode::scene && amount > 1.1e-6 * machine.smallest_loop;
          if (!may_fail && !may_be_refused) throw;
          ++refused;
          return first.run;
        }
      });
    }
  tally.print(first.end, refused);
  EXPECT_TRUE(tally.ok()) << tally.text();
}

class Redundancy : public Machine {};

// Degrees of freedom and redundant equations are those of the theory, and without the redundant ones the
// machine moves the same.
TEST_P(Redundancy, ChangesNothing) {
  const RecordedRun run = record(machine_.scene, machine_.end, windows);
  if (machine_.degrees_of_freedom >= 0) {
    EXPECT_EQ(run.degrees_of_freedom, machine_.degrees_of_freedom);
    EXPECT_EQ(run.redundant, static_cast<std::size_t>(machine_.redundant));
  }
  EXPECT_GT(run.energy_scale, 0);
  if (!machine_.determinate) return;
  const RecordedRun other = record(*machine_.determinate, machine_.end, windows);
  EXPECT_EQ(other.redundant, 0u);
  EXPECT_EQ(other.degrees_of_freedom, run.degrees_of_freedom);
  scene::Scene finer = machine_.scene;
  if (finer.mbd->integrator.step) *finer.mbd->integrator.step /= 2;
  if (finer.mbd->integrator.error_tolerance) *finer.mbd->integrator.error_tolerance /= 8;
  const double truncation = deviation(machine_.scene, run, record(finer, machine_.end, windows)).most();
  // Bodies only: joints are others.
  scene::Scene bodies = machine_.scene;
  bodies.mbd->joints.clear();
  RecordedRun a = run, b = other;
  for (RecordedRun* r : {&a, &b})
    for (auto& frame : r->frames) frame.joints.clear();
  const Deviation d = deviation(bodies, a, b);
  const double limit = tolerance(machine_.scene) + 10 * truncation;
  std::printf("| %-9s | %-28s | %4d | %7.3g | %8.1e | %8.1e |\n", "twin", machine_.name.c_str(), 1,
              machine_.end, limit, d.most());
  EXPECT_LE(d.most(), limit);
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const ConstrainedMachine& machine : all_machines()) list.push_back(machine.name);
  return list;
}
const auto name_of = [](const testing::TestParamInfo<std::string>& info) { return info.param; };

INSTANTIATE_TEST_SUITE_P(Of, FrameInvariance, testing::ValuesIn(names()), name_of);
INSTANTIATE_TEST_SUITE_P(Of, Rounding, testing::ValuesIn(names()), name_of);
INSTANTIATE_TEST_SUITE_P(Of, Redundancy, testing::ValuesIn(names()), name_of);

}  // namespace
}  // namespace tandem::mbd
