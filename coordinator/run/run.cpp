#include "coordinator/run/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <memory>
#include <new>
#include <optional>
#include <system_error>

#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/sensor_columns.hpp"
#include "common/stream_signals.hpp"
#include "common/utf8.hpp"
#include "coordinator/report/report.hpp"
#include "coordinator/results/results.hpp"
#include "coordinator/run/grain_watches.hpp"
#include "coordinator/run/half_steps.hpp"
#include "coordinator/run/kept_frames.hpp"
#include "coordinator/run/progress.hpp"
#include "coordinator/run/run_frames.hpp"
#include "coordinator/run/stopwatch.hpp"
#include "coordinator/run/summary.hpp"
#include "coordinator/run_folder/inputs.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/run_folder/registry.hpp"
#include "coordinator/run_folder/run_folder.hpp"
#include "coordinator/scene/kept_scene.hpp"
#include "coordinator/scene/show.hpp"
#include "coordinator/start/rank_command.hpp"
#include "coordinator/start/start.hpp"
#include "coordinator/start/start_state.hpp"
#include "coordinator/window/checkpoint.hpp"
#include "coordinator/window/control.hpp"
#include "coordinator/window/coupler.hpp"
#include "coordinator/window/window_log.hpp"
#include "mbd_server/coupling/error_estimate.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;
using protocol::Role;

// Disk space for the last summary [bytes]. One with 100 loaded boundary bodies has 100 kB, each column of
// elements.csv 150 bytes.
std::int64_t last_words(const scene::Scene& scene) {
  const std::size_t bodies = scene.mbd ? scene.mbd->bodies.size() : 0;
  return static_cast<std::int64_t>(((64 + 2 * bodies) << 10) + 256 * (scene::element_columns(scene).size() +
                                                                      scene::sensor_columns(scene).size()));
}

// Decides when the summary is written during the run: once a second, and on a slow disk less often, so that
// writing takes at most a hundredth of the time.
class InterimPace {
 public:
  bool due() const { return Clock::now() >= next_; }
  template <class Write>
  void run(Write write) {
    const auto begin = Clock::now();
    write();
    const auto end = Clock::now();
    next_ = end + std::max<Clock::duration>(1s, 100 * (end - begin));
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point next_ = Clock::now() + 1s;
};

// One run, from the start of its servers to the verdict. The summary contains all its figures, whatever the
// ending.
class Run {
 public:
  // `options.folder` is that of `folder`.
  // `sink` takes all frames between the programs; may be null.
  Run(const SceneFile& file, const RunOptions& options, const ForeignServers& foreign, Controller* controller,
      RunFolder& folder, Summary& summary, protocol::FrameSink* sink)
      : file_(file),
        scene_(file.scene),
        options_(options),
        foreign_(foreign),
        folder_(folder),
        summary_(summary),
        sink_(sink),
        end_(to_nanoseconds(file.scene.end_time)),
        frames_(file.scene, solvers_, watches_, folder, results_, stopwatch_),
        results_(options.folder, file.scene, file.meshes, file.drawn),
        walls_(file.scene, file.meshes),
        window_log_(options.folder, file.scene) {
    control_ = make_control(file.scene, options, controller);
    folder.watch_files();
  }

  void execute() {
    try {
      start();
      advance();
      finish();
      conclude();
    } catch (const Error& error) {
      const Error explained = explain(error);
      try {
        frames_.fetch();
      } catch (const Error&) {  // of the solver that failed
      }
      if (participants_) participants_->fail(explained);
      try {
        if (folder_.is_in_place()) results_.finish();
      } catch (const Error& of_frame) {
        summary_.add_warning(of_frame.what());
      }
      fill(summary_);  // with what the last frame shows
      throw explained;
    }
  }

  // End state of the bodies; valid after execute().
  mbd::RunEnd multibody_end() const;

 private:
  void start();
  void advance();
  void finish();
  void conclude();
  mbd::ErrorEstimate measure_error() const;

  void observe();
  BetweenWindows between_windows();
  const Exchange& of_grains();
  void write_checkpoint();
  void write_interim_summary();
  std::uint64_t spheres_there() const;
  void fill(Summary& summary) const;
  Error explain(const Error& error);

  const SceneFile& file_;
  const scene::Scene& scene_;
  const RunOptions& options_;
  const ForeignServers& foreign_;
  RunFolder& folder_;
  Summary& summary_;
  protocol::FrameSink* const sink_;
  const Nanoseconds end_;

  Solvers solvers_;
  Stopwatch stopwatch_;
  // Before the results, whose thread decodes and checks the frames.
  std::optional<GrainWatches> watches_;
  RunFrames frames_;
  Results results_;
  WallWatch walls_;
  WindowLog window_log_;
  std::unique_ptr<Participants> participants_;
  std::optional<Coupler> coupler_;
  Exchange grains_;  // of the last window, where a liquid is there as well
  std::unique_ptr<Control> control_;
  const protocol::BodiesFrame* bodies_ = nullptr;  // last observation
  protocol::BodiesFrame last_bodies_;              // at the end

  std::string phase_ = at_start;
  Nanoseconds now_;
  Nanoseconds begin_;  // 0, or the time from which a run continues
  std::optional<Checkpoints> checkpoints_;
  InterimPace interim_;
};

void Run::start() {
  participants_ =
      std::make_unique<Participants>(options_, scene_, foreign_, options_.folder / "run.log", sink_);
  solvers_ = participants_->solvers();

  std::vector<Need> besides;
  if (options_.checkpoint_every > 0)
    besides.push_back({protocol::can_checkpoint, "--checkpoint-every", "leave out --checkpoint-every"});
  if (!options_.restart.empty())
    besides.push_back({protocol::can_checkpoint, "--restart", "start from the begin, without --restart"});
  // Finds the spheres of the scene while the solver does the same.
  std::future<std::unique_ptr<ParticleWatch>> watch;
  if (solvers_.of(Role::dem))
    watch = std::async(std::launch::async | std::launch::deferred,
                       [this] { return std::make_unique<ParticleWatch>(file_); });
  const StartOfSolvers at_start = configure(
      solvers_, file_, options_, besides,
      [&](Role role, const protocol::Hello& hello) { summary_.set_server(role, hello, foreign_.of(role)); },
      [&](Role role, const std::string& facts) { summary_.add_facts(role, facts); });
  if (solvers_.mbd && solvers_.mbd->can(protocol::can_observe_elements)) results_.add_elements();
  coupler_.emplace(scene_, solvers_);
  coupler_->begin_with(at_start);
  if (scene_.dem) {
    watches_.emplace(scene_, watch.get(), foreign_.of(Role::dem) || options_.attach);
    if (scene_.output.has(scene::SphereField::group) || scene_.output.has(scene::SphereField::material))
      results_.set_groups(watches_->spheres().group_by_id());
  }
  if (!options_.restart.empty()) {
    phase_ = "while the state was read";
    resume(options_.restart, file_, solvers_, *coupler_, results_);
    now_ = begin_ = coupler_->now();
    if (watches_) watches_->continue_after(coupler_->accounts().particles().account().lost_particles);
    if (now_ >= end_)
      throw Error(
          ErrorCode::usage,
          fmt::format("the run is over: its state is that at {:.6g} s, and the scene ends at {:.6g} s",
                      to_seconds(now_), to_seconds(end_)),
          "--restart", "give a later --end-time");
    summary_.set_restart(options_.restart, *coupler_);
  }
  if (options_.checkpoint_every > 0)
    checkpoints_.emplace(file_, options_.folder, checkpoint_interval(options_.checkpoint_every), begin_);
}

void Run::advance() {
  Progress progress(begin_, coupler_->accounts().micro_steps(), end_, options_.quiet);
  log::info("windows of {:.6g} s, scheme {}", scene_.coupling.window, name(scene_.coupling.scheme));

  phase_ = "before the first window";
  participants_->begin();
  stopwatch_.start(solvers_);
  observe();
  frames_.write(between_windows());
  while (now_ < end_ && !interrupted()) {
    // Windows end at the frames. Windows of equal length divide the frame interval anyway.
    const Nanoseconds limit = frames_.next() > now_ ? std::min(frames_.next(), end_) : end_;
    phase_ = fmt::format("in window {} (t = {:.6g} s)", coupler_->accounts().windows(), to_seconds(now_));
    if (control_)
      solvers_.mbd->control(
          control_->request(now_, *bodies_, scene_.has_particles() ? &coupler_->exchange().load : nullptr));
    coupler_->advance(limit);
    now_ = coupler_->now();
    frames_.after_window(now_);
    if (watches_) watches_->record(of_grains());
    window_log_.write(*coupler_);
    observe();
    if (now_ >= frames_.next())
      now_ < end_ ? frames_.begin(between_windows()) : frames_.write(between_windows());
    if (checkpoints_ && checkpoints_->due(now_)) write_checkpoint();
    if (interim_.due()) write_interim_summary();
    progress.update(now_, coupler_->accounts().windows(), coupler_->accounts().micro_steps(),
                    spheres_there());
  }
  // After the loop, because an interrupt may end the loop at any time.
  frames_.fetch();
  if (frames_.last() < now_) frames_.write(between_windows());
  if (checkpoints_) write_checkpoint();
  if (bodies_) last_bodies_ = *bodies_;
  stopwatch_.begin_output(solvers_);
  folder_.expect_there();
  results_.finish();
  stopwatch_.end_output(solvers_);
}

void Run::finish() {
  phase_ = fmt::format("after the last window (t = {:.6g} s)", to_seconds(now_));
  participants_->expect_leaving();
  if (solvers_.mbd) summary_.add_facts(Role::mbd, solvers_.mbd->finish().facts);
  for (protocol::Remote* solver : solvers_.loads) summary_.add_facts(solver->role(), solver->finish().facts);
  summary_.set_leaving(participants_->leave());
  solvers_ = {};
  participants_.reset();
  fill(summary_);
  if (results_.elements()) summary_.set_columns("elements", *results_.elements());
  if (results_.sensors()) summary_.set_columns("sensors", *results_.sensors());
}

// The scene's own checks, which need a complete run, and the verdict.
void Run::conclude() {
  if (now_ < end_) {
    summary_.interrupt();
    return;
  }
  bool estimate_missing = false;
  if (options_.estimate == Estimate::richardson) {
    protocol::MbdFacts facts = summary_.facts().mbd;
    nlohmann::ordered_json others;
    mbd::add_error_facts(measure_error(), facts, others);
    summary_.add_facts(Role::mbd, protocol::encode_facts(facts, others));
    estimate_missing = interrupted();
  }
  const auto checks = evaluate(scene_.checks, results_.signals(), nlohmann::json(summary_.json()));
  const bool passed =
      std::all_of(checks.begin(), checks.end(), [](const CheckResult& c) { return c.passed; });
  summary_.set_checks(checks);
  summary_.complete(passed, options_.strict);
  if (estimate_missing) summary_.interrupt_estimate();
}

// Steps of the multibody solver, 0 where it has not reported them.
double steps_of(const Summary& summary) {
  return static_cast<double>(summary.facts().mbd.steps.value_or(0));
}

mbd::RunEnd Run::multibody_end() const {
  mbd::RunEnd end{.bodies = {}, .energy = last_bodies_.energy, .steps = steps_of(summary_)};
  for (const protocol::BodyState& body : last_bodies_.bodies) end.bodies.push_back(body.pose);
  return end;
}

// Measures the error by a second run, whose results are in a folder inside this run's. This run is complete,
// whatever happens to the second.
mbd::ErrorEstimate Run::measure_error() const {
  log::info("once more, with steps of the multibody part half as long");
  const SceneFile file = with_half_steps(file_);
  const RunOptions options = for_half_steps(options_);
  Summary summary(file, options);
  mbd::ErrorEstimate estimate;
  RunFolder folder(options.folder, file.scene.name, last_words(file.scene));
  try {
    Run half(file, options, foreign_, nullptr, folder, summary, nullptr);
    half.execute();
    if (!summary_.facts().mbd.steps || !summary.facts().mbd.steps ||
        summary_.facts().mbd.size.value_or(0) <= 0)
      estimate.reason = "mbd_steps and mbd_size_m are " + summary_.not_reported(Role::mbd);
    else
      // Adaptive windows may be shorter than two steps, and a foreign solver may take steps of its own.
      estimate =
          mbd::estimate_error(multibody_end(), half.multibody_end(),
                              !scene_.coupling.adaptive && steps_of(summary) >= 1.5 * steps_of(summary_));
  } catch (const Error& error) {
    log::warn("the run with half the steps: {}", error.what());
    summary.fail(error);
    estimate.reason = fmt::format("the run with half the steps failed: {}", error.what());
  }
  if (interrupted()) {
    estimate = {};
    estimate.reason = "the run with half the steps was interrupted";
    log::warn("{}: this run is complete, but for the estimate of its error", estimate.reason);
  }
  estimate.steps = steps_of(summary);
  estimate.cpu_seconds = summary.facts().mbd.solver_cpu_seconds.value_or(0);
  summary.write(options.folder / summary_name);
  return estimate;
}

// Adds the bodies to the results, after every window.
void Run::observe() {
  stopwatch_.begin_output(solvers_);
  if (solvers_.mbd) {
    bodies_ = &solvers_.mbd->observe_bodies(now_);
    coupler_->observe(*bodies_);
    if (now_ == Nanoseconds{}) StartOfBodies(scene_).expect(bodies_->bodies);
    walls_.observe(to_seconds(now_), bodies_->bodies, now_ >= end_);
  }
  if (now_ > begin_)
    results_.record(now_, bodies_, scene_.has_particles() ? &coupler_->exchange().load : nullptr);
  stopwatch_.end_output(solvers_);
}

BetweenWindows Run::between_windows() {
  return {now_, bodies_, scene_.dem && now_ > begin_ ? &of_grains() : nullptr};
}

// The exchange of the last window with the loads of the grains alone.
const Exchange& Run::of_grains() {
  const Exchange& all = coupler_->exchange();
  if (all.parts.empty()) return all;
  grains_ = all;
  grains_.load = std::move(grains_.parts.front());
  grains_.parts.clear();
  return grains_;
}

void Run::write_checkpoint() {
  frames_.fetch();
  stopwatch_.begin_output(solvers_);
  folder_.expect_there();
  checkpoints_->write(solvers_, *coupler_, results_);
  stopwatch_.end_output(solvers_);
}

// Number of particles in the domain. With inlets or outlets their solver reports it at the end only: 0 until
// then, and where it does not report it at all.
std::uint64_t Run::spheres_there() const {
  if (scene_.sph && !(scene_.sph->inlets.empty() && scene_.sph->outlets.empty())) return 0;
  const auto left = [&](std::uint64_t all) {
    const std::uint64_t lost = coupler_->accounts().particles().account().lost_particles;
    return all > lost ? all - lost : 0;
  };
  if (scene_.sph) return scene_.dem ? 0 : left(summary_.facts().sph.particles.value_or(0));
  if (!scene_.dem || !scene_.dem->outlets.empty()) return 0;
  for (const scene::ParticleGroup& group : scene_.dem->particles)
    if (std::holds_alternative<scene::InletFill>(group.fill)) return 0;
  return left(summary_.facts().dem.spheres.value_or(0));
}

// Writes the course of the run so far into the summary.
void Run::fill(Summary& summary) const {
  summary.set_walls(walls_);
  if (watches_) watches_->add_to(summary);
  if (!stopwatch_.started()) return;
  const protocol::SolverFacts& facts = summary.facts();
  summary.set_course(
      *coupler_, now_, stopwatch_.wall(),
      stopwatch_.split(facts.mbd.solver_seconds.value_or(0), facts.dem.solver_seconds.value_or(0),
                       facts.sph.solver_seconds.value_or(0)));
}

// For readers of a run that is in progress or has died. Uses a copy, because warnings with figures are those
// of the end.
void Run::write_interim_summary() {
  stopwatch_.begin_output(solvers_);
  interim_.run([this] {
    folder_.expect_there();
    Summary so_far = summary_;
    fill(so_far);
    so_far.write(folder_.path() / summary_name);
  });
  stopwatch_.end_output(solvers_);
}

Error Run::explain(const Error& error) {
  if (error.where().starts_with("controller")) return error;  // its sentence contains the time
  // A file that cannot be written is then a consequence.
  if (error.code() == ErrorCode::resource) try {
      folder_.expect_there();
    } catch (const Error& reason) {
      return reason;
    }
  return explained(error, phase_, participants_.get());
}

// All that a run reads: it must not be among the files of an earlier run that this one removes.
std::vector<std::filesystem::path> inputs_of(const SceneFile& file, const RunOptions& options,
                                             const ForeignServers& foreign) {
  std::vector<std::filesystem::path> inputs = file.inputs;
  const auto add = [&inputs](const std::filesystem::path& path) {
    std::error_code unknown;
    if (!path.empty() && std::filesystem::exists(path, unknown)) inputs.push_back(path);
  };
  add(options.restart);
  // The rows before the checkpoint are in the folder of its run.
  if (!options.restart.empty())
    for (const char* rows : {"bodies.csv", "joints.csv", "elements.csv"})
      add(std::filesystem::absolute(options.restart).parent_path().parent_path() / rows);
  add(options.secret_file);
  add(options.certificates);
  for (const protocol::Role role : protocol::all_roles) {
    const auto& command = foreign.of(role);
    if (!command) continue;
    add(command->program);
    for (const std::string& argument : command->arguments) add(argument);
  }
  return inputs;
}

// A closed terminal is not an error of the run: its results are in the folder.
void print_end(const Summary& summary, const std::filesystem::path& folder) {
  try {
    fmt::print("{}  {:<22}{}\n", summary.table(), "results", folder.string());
    if (std::fflush(stdout) == 0) return;
  } catch (const std::system_error&) {
  }
  log::warn("the console takes no more text; the results are in {}", folder.string());
}

}  // namespace

int run(const RunOptions& given, Controller* controller) {
  RunOptions options = given;
  expect_ranks(options);
  if (options.quiet) log::quiet();  // while spheres settle
  const SceneFile file =
      read_scene(options.scene, options.overrides,
                 SettleOn{options.backend, options.threads, true, !options.sph_server.has_value(),
                          unsettled_picture(options.scene)});
  if (options.estimate == Estimate::richardson) expect_repeatable(options, file.scene, controller != nullptr);
  const ForeignServers foreign = foreign_servers(file, options);
  expect_ranks(options, file.scene, foreign);
  if (options.checkpoint_every != 0) checkpoint_interval(options.checkpoint_every);
  if (!options.record.empty()) {
    protocol::Recorder::expect_replaceable(options.record);
    expect_free_name(options.record, options.folder, "--record");
  }
  if (!options.restart.empty()) options.restart = find_checkpoint(options.restart);
  const InterruptGuard guard;
  take_stream_signals_as_errors();
  RunFolder folder(options.folder, file.scene.name, last_words(file.scene),
                   inputs_of(file, options, foreign));
  const RegistryEntry entry(folder.path());
  log::setup("tandem", "info", (options.folder / "run.log").string());
  if (options.quiet) log::quiet();
  if (folder.earlier_died())
    log::info("the earlier run in {} died; its files are gone now", options.folder.string());
  if (!folder.others().empty())
    log::info("left alone in {}, as not of a run: {}", options.folder.string(),
              fmt::join(folder.others(), ", "));
  if (!folder.locked())
    log::warn("the file system of {} has no locks: see yourself that no other run uses it",
              options.folder.string());

  Summary summary(file, options);
  for (const std::string& line : file.log) log::info("{}", line);
  for (const std::string& warning : file.warnings) {
    log::warn("{}", warning);
    summary.add_warning(warning);
  }
  if (options.transport == Transport::dds && options.insecure) {
    const std::string warning =
        "--insecure: whoever reaches interface " + shortened(options.dds_interface) +
        " could read and change this run; its results are as trustworthy as that network";
    log::warn("{}", warning);
    summary.add_warning(warning);
  }
  const std::filesystem::path summary_file = options.folder / summary_name;
  bool complete = true;
  std::optional<KeptFrames> frames;
  // Lives until the error is said: its servers take their time to leave.
  std::optional<Run> running;
  const auto fail = [&](const Error& error) {
    const Error kept = frames && folder.is_in_place() ? frames->keep(error) : error;
    log::error("{}", printable(kept.what()));
    summary.fail(kept);
    complete = false;
  };
  try {
    summary.write(summary_file);
    keep_scene(file, options.folder);
    frames.emplace(options.record, options.folder);
    running.emplace(file, options, foreign, controller, folder, summary, frames->sink());
    running->execute();
    folder.expect_there();
  } catch (const Error& error) {
    fail(error);
  } catch (const std::bad_alloc&) {
    fail(Error(ErrorCode::resource, "there is not enough memory", {},
               "use a smaller scene, or a larger machine"));
  } catch (const std::exception& error) {
    fail(Error(ErrorCode::internal, error.what(), {}, "a bug of tandem: please report it"));
  }
  running.reset();
  for (const VerdictLine& line : summary.verdict().lines) log::warn("suspect: {}", line.sentence);
  folder.release_reserve();
  if (!folder.is_in_place()) {
    // By its name this would be written to a folder that is not of this run. Where the own one was moved to,
    // it has its ending; where it was deleted, there is no place for it.
    try {
      summary.write(folder.held() / summary_name);
    } catch (const Error&) {
    }
    return summary.exit_status();
  }
  summary.write(summary_file);
  forget_interrupt();  // picture and report of an interrupted run are made; another signal ends them
  if (options.picture && complete) render_picture(options.folder, file.scene);
  if (options.report) write_report(options.folder);
  if (!options.quiet) print_end(summary, options.folder);
  return summary.exit_status();
}

}  // namespace tandem::launch
