// Restart files of the multibody solver, the particle solver and the coordinator. Some inputs are damaged
// files, which the digest must detect; others are files with a valid digest, written from damaged arrays. A
// solver that accepts a file must then advance by one window.
#include <algorithm>
#include <cstring>

#include "common/scene/parse.hpp"
#include "common/state_file.hpp"
#include "coordinator/window/checkpoint.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "tests/fuzz/arrays.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/shipped.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace restart_part {

namespace fs = std::filesystem;

// An input is one byte for the program and the form, followed by the file or its arrays.
constexpr unsigned of_mbd = 0, of_dem = 1, of_run = 2, of_arrays = 3, forms = 6;

// A state file with these arrays, which include its kind and version.
void write(const fs::path& file, const std::vector<Array>& arrays) {
  std::string kind;
  std::uint64_t version = 0;
  for (const Array& array : arrays) {
    if (array.name == "kind") kind = text_of(array.values);
    if (array.name == "version" && array.values.size() == sizeof version)
      std::memcpy(&version, array.values.data(), sizeof version);
  }
  StateWriter writer(file, kind, version);
  for (const auto& [name, number, values] : arrays) {
    if (name == "kind" || name == "version") continue;
    const auto as = [&]<class T>(T first) {
      std::vector<T> copy(values.size() / sizeof first);
      const auto whole = std::span(values).first(copy.size() * sizeof first);
      std::ranges::copy(whole, std::as_writable_bytes(std::span(copy)).begin());
      writer.write(name, std::span<const T>(copy));
    };
    if (number == Number::float64)
      as(double{});
    else if (number == Number::uint64)
      as(std::uint64_t{});
    else
      writer.write(name, std::span<const std::byte>(values));
  }
  writer.commit();
}

constexpr const char* balls = R"({
  "tandem": "1.0", "name": "balls", "end_time": 0.05, "coupling": {"window": 1e-3},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
    "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.3}],
    "particles": [{"name": "balls", "material": "glass", "radius": 0.02,
                   "fill": {"type": "lattice", "min": [-0.06, -0.06, 0.018], "max": [0.06, 0.06, 0.2], "spacing": 0.0401,
                            "count": 12}}],
    "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

// A solver at the end of its first window.
template <class Solver, class Input>
class Part {
 public:
  Part(std::unique_ptr<Solver> solver, std::string_view scene, Nanoseconds window)
      : solver_(std::move(solver)) {
    protocol::Configuration configuration;
    configuration.scene_text = scene;
    configuration.origin = "scene.json";
    configuration.backend = "cpu";
    configuration.threads = 1;
    solver_->configure(configuration);
    first_.window = {0, {0}, window};
    second_.window = {1, window, window + window};
  }
  void save(const fs::path& file) {
    solver_->advance(first_);
    solver_->checkpoint(order(file));
  }
  void go_on(const fs::path& file) {
    solver_->resume(order(file));
    solver_->advance(second_);
    solver_->observe();
    solver_->report();
  }

 private:
  protocol::Checkpoint order(const fs::path& file) const { return {1, first_.window.end, file.string()}; }
  std::unique_ptr<Solver> solver_;
  Input first_, second_;
};

auto multibody_part() {
  return Part<protocol::MotionSolver, protocol::LoadSet>(mbd::make_solver(), shipped_scene("dead_point"),
                                                         {10'000'000});
}
auto particle_part() {
  return Part<protocol::LoadSolver, protocol::MotionSet>(dem::make_solver(), balls, {1'000'000});
}

// The coordinator's own state of a run, without solvers.
class RunPart {
 public:
  explicit RunPart(const fs::path& folder) : old_(folder / "old"), new_(folder / "new") {
    fs::create_directories(old_);
    fs::create_directories(new_);
    scene_.text = shipped_scene("bouncing");
    scene_.scene = scene::parse(scene_.text, "scene.json");
    launch::Coupler coupler(scene_.scene, {});
    launch::Results results(old_, scene_.scene, {});
    launch::Checkpoints(scene_, old_, {1'000'000}, {0}).write({}, coupler, results);
    file_ = launch::find_checkpoint(old_) / "run.h5";
  }
  const fs::path& file() const { return file_; }
  void go_on() {
    launch::Coupler coupler(scene_.scene, {});
    launch::Results results(new_, scene_.scene, {});
    launch::resume(file_.parent_path(), scene_, {}, coupler, results);
    coupler.next({std::numeric_limits<std::int64_t>::max()});
  }

 private:
  launch::SceneFile scene_;
  fs::path old_, new_, file_;
};

class RestartTarget : public Target {
 public:
  explicit RestartTarget(const fs::path& folder) : file_(folder / "state.h5"), run_(folder) {}

  void run(std::span<const std::byte> input) override {
    const unsigned form = chosen(input, forms), kind = form % of_arrays;
    const fs::path& file = kind == of_run ? run_.file() : file_;
    if (form < of_arrays)
      put(file, input);
    else
      write(file, unpacked(input));
    if (kind == of_run)
      run_.go_on();
    else if (kind == of_mbd)
      multibody_part().go_on(file_);
    else
      particle_part().go_on(file_);
  }

 private:
  fs::path file_;
  RunPart run_;
};

void add(std::vector<Bytes>& corpus, unsigned kind, const fs::path& file) {
  corpus.push_back(choice(kind, get(file)));
  corpus.push_back(choice(kind + of_arrays, packed(arrays_of(file))));
}

std::vector<Bytes> states(const fs::path& folder) {
  std::vector<Bytes> corpus;
  multibody_part().save(folder / "mbd.h5");
  add(corpus, of_mbd, folder / "mbd.h5");
  add(corpus, of_run, RunPart(folder).file());
  return corpus;
}

std::vector<Bytes> particle_states(const fs::path& folder) {
  std::vector<Bytes> corpus;
  particle_part().save(folder / "dem.h5");
  add(corpus, of_dem, folder / "dem.h5");
  return corpus;
}

std::unique_ptr<Target> make_restart(const fs::path& folder) {
  return std::make_unique<RestartTarget>(folder);
}

// Damaged files must be refused.
Fate finish_state(Random&, Bytes& input) {
  std::span<const std::byte> rest = input;
  return chosen(rest, forms) < of_arrays ? Fate::refused : Fate::open;
}

}  // namespace restart_part

TargetKind restart_target() {
  using namespace restart_part;
  return {.name = "restart", .corpus = states, .make = make_restart, .finish = finish_state};
}

TargetKind particle_restart_target() {
  using namespace restart_part;
  return {
      .name = "particle_restart", .corpus = particle_states, .make = make_restart, .finish = finish_state};
}

}  // namespace tandem::fuzz
