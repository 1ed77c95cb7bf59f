#include "coordinator/scene/liquid_fill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <span>
#include <thread>
#include <variant>

#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/scene/particle_file.hpp"
#include "coordinator/scene/start_cache.hpp"
#include "particles/base/memory.hpp"
#include "sph_server/coupling/liquid_start.hpp"

namespace tandem::launch {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto between_lines = 5s;
constexpr std::size_t many = 20'000;  // particles
// How long a step may go on after an interrupt before it is left alone.
constexpr auto grace = 500ms;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// What a filling needs, owned by its thread as well: a step cannot be ended from outside.
struct Job {
  sph::FilledInside inside;
  sph::LiquidSetup setup;
  std::vector<particles::BodyPose> poses;
  std::atomic<bool> stop = false;
  std::atomic<int> done = 0, all = 0;
};

sph::FilledPlaces places(const std::shared_ptr<Job>& job) {
  return sph::places_of(job->inside, job->setup, job->poses, [job](int done, int all) {
    job->all = all;
    job->done = done;
    if (job->stop) throw Error(ErrorCode::interrupted, "the filling was ended");
  });
}

// Says how far the filling is, and how long it still takes.
class Progress {
 public:
  explicit Progress(const Job& job) : job_(job) {}
  void report() {
    const int done = job_.done, all = job_.all;
    if (done == 0 || done == reported_) return;
    if (reported_ == 0) {
      // The first step has taken other things as well.
      first_ = done;
      reported_ = done;
      begin_ = last_ = Clock::now();
      return;
    }
    if (said_ && Clock::now() - last_ < between_lines) return;
    const double left = seconds_since(begin_) / (done - first_) * (all - done);
    reported_ = done;
    if (!said_ && left < 2) return;
    log::info("the liquid is filled in: step {} of {}, about {:.{}f} s are left", done, all, left,
              left < 10 ? 1 : 0);
    said_ = true;
    last_ = Clock::now();
  }

 private:
  const Job& job_;
  Clock::time_point begin_, last_;
  int first_ = 0, reported_ = 0;
  bool said_ = false;
};

sph::FilledPlaces wait_for(const std::shared_ptr<Job>& job) {
  const InterruptGuard guard;
  std::packaged_task<sph::FilledPlaces()> task([job] { return places(job); });
  std::future<sph::FilledPlaces> result = task.get_future();
  std::thread worker(std::move(task));
  Progress progress(*job);
  while (result.wait_for(50ms) != std::future_status::ready && !interrupted()) progress.report();
  if (interrupted()) {
    job->stop = true;
    if (result.wait_for(grace) == std::future_status::ready)
      worker.join();
    else
      worker.detach();
    throw Error(ErrorCode::interrupted, "the run was interrupted while its liquid was filled in");
  }
  worker.join();
  return result.get();
}

template <class T>
std::string digest(const std::vector<T>& values) {
  return digest_text(std::as_bytes(std::span(values)));
}

StartCache::Entry entry_of(const Job& job) {
  StartCache::Entry entry{"filled liquid", "filled_", {}};
  std::string& key = entry.key;
  key = fmt::format("program {:016x}\n", file_digest("/proc/self/exe"));
  const sph::Liquid& l = job.setup.liquid;
  key +=
      fmt::format("liquid {} {} {} {} {} {} {} {} {} {}\n", l.density, l.sound_speed, l.spacing, l.smoothing,
                  l.diffusion, l.bulk_viscosity, l.shifting, l.gravity.x, l.gravity.y, l.gravity.z);
  const scene::Box& domain = job.setup.domain;
  std::vector<Vec3d> vectors{domain.min, domain.max, job.setup.periods.min, job.setup.periods.length};
  for (const Vec3d& row : job.inside.axes.row) vectors.push_back(row);
  for (const particles::BodyPose& pose : job.poses) {
    vectors.push_back(pose.p);
    for (const Vec3d& row : pose.R.row) vectors.push_back(row);
  }
  key += fmt::format("height {} volume {} common {} at {}\n", job.inside.amount.height.value_or(-1),
                     job.inside.amount.volume.value_or(-1), job.inside.amount.common, digest(vectors));
  const auto mesh = [&](const char* name, const TriangleMesh& of) {
    key += fmt::format("{} {} {}\n", name, digest(of.vertices), digest(of.triangles));
  };
  mesh("region", job.inside.region);
  for (const TriangleMesh& wall : job.setup.walls) mesh("wall", wall);
  return entry;
}

void expect_memory(const Job& job) {
  const std::size_t bytes = sph::predicted_bytes(job.inside.particles, job.setup, true, false),
                    available = particles::available_memory(job.setup.backend);
  if (bytes > available)
    throw Error(
        ErrorCode::resource,
        fmt::format("the {} particles of the liquid need {:.4g} GB; {:.4g} GB are free", job.inside.particles,
                    static_cast<double>(bytes) / 1e9, static_cast<double>(available) / 1e9),
        job.setup.backend == particles::Backend::cuda ? "device memory" : "host memory",
        "give a larger sph.spacing");
}

void take(const std::shared_ptr<Job>& job, const std::string& wall, SceneFile& file) {
  const StartCache cache;
  const StartCache::Entry entry = entry_of(*job);
  scene::ParticleFile particles;
  const auto begin = Clock::now();
  if (cache.find(
          entry, [&](const StateReader& kept) { particles.positions = rows_in(kept, "position"); },
          file.log)) {
    file.log.push_back(fmt::format("{} particles of the liquid inside '{}' are taken from the cache",
                                   particles.positions.size(), wall));
  } else {
    expect_memory(*job);
    // The lattice and the lists before the first step take a while as well.
    if (job->inside.particles >= many)
      log::info("about {} particles of the liquid are placed inside '{}'", job->inside.particles, wall);
    sph::FilledPlaces filled = wait_for(job);
    if (!filled.relaxed) return;
    particles.positions = std::move(filled.position);
    file.log.push_back(fmt::format("{} particles of the liquid inside '{}' were filled in within {:.2g} s",
                                   particles.positions.size(), wall, seconds_since(begin)));
    cache.keep(
        entry, 65536 + entry.key.size() + 24 * particles.positions.size(),
        [&](StateWriter& kept) { kept.write("position", numbers(particles.positions)); }, file.log);
  }
  file.files.push_back({sph::place_of_fill(job->inside.fill), scene::particle_file_text(particles)});
}

}  // namespace

void fill_liquids(SceneFile& file, const SettleOn& on) {
  if (!file.scene.sph || !on.settles || !on.fills) return;
  if (const std::string& server = file.scene.sph->server; !server.empty() && server != "sph_server") return;
  const auto& fills = file.scene.sph->liquids.front().fill;
  if (std::ranges::none_of(
          fills, [](const auto& fill) { return std::holds_alternative<scene::LiquidInside>(fill); }))
    return;
  try {
    sph::LiquidStart start = sph::prepare_start(file.scene, file.meshes);
    start.setup.backend = particles::choose_backend(on.backend);
    start.setup.threads = on.threads;
    for (const sph::FilledInside& inside : start.insides) {
      const auto job = std::make_shared<Job>();
      job->inside = inside;
      job->setup = start.setup;
      job->poses = start.poses;
      take(job, std::get<scene::LiquidInside>(fills[inside.fill]).wall, file);
    }
  } catch (const Error& error) {
    if (!error.where().starts_with("sph.")) throw;
    throw Error(error.code(), error.problem(), file.origin + ": " + error.where(), error.hint());
  }
}

}  // namespace tandem::launch
