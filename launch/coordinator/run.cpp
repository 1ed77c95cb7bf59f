#include "launch/coordinator/run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "common/log.hpp"
#include "launch/coordinator/accounts.hpp"
#include "launch/coordinator/interrupt.hpp"
#include "launch/coordinator/participants.hpp"
#include "launch/coordinator/progress.hpp"
#include "launch/coordinator/run_folder.hpp"
#include "launch/coordinator/scene_file.hpp"
#include "launch/coordinator/summary.hpp"
#include "launch/coordinator/window_log.hpp"
#include "launch/report/report.hpp"
#include "launch/results/results.hpp"
#include "protocol/recorder.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// One run from the start of its servers to their reports; what it knows of itself stays readable however it
// ends.
class Run {
 public:
  Run(const SceneFile& file, const RunOptions& options, Summary& summary)
      : file_(file),
        scene_(file.scene),
        options_(options),
        summary_(summary),
        end_(to_nanoseconds(file.scene.end_time)),
        results_(options.folder, file.scene, file.meshes),
        window_log_(options.folder / "windows.csv") {
    if (!options.record.empty()) recorder_ = std::make_unique<protocol::Recorder>(options.record);
  }

  void execute() {
    try {
      start();
      advance();
      finish();
    } catch (const Error& error) {
      const Error explained = explain(error);
      if (participants_) participants_->fail(explained);
      throw explained;
    }
  }

  void conclude();

  // Books the course of the run so far.
  void book() {
    const bool windows_began = wall_begin_ != std::chrono::steady_clock::time_point{};
    if (windows_began) summary_.set_course(accounts_, now_, seconds_since(wall_begin_), time_split());
  }

 private:
  void start();
  void advance();
  void finish();

  void observe(bool frame);
  TimeSplit time_split() const;
  Error explain(const Error& error);

  // Waiting for one solver, split by what it was waited for [s].
  struct Waiting {
    double before_windows = 0, observing = 0;
  };

  const SceneFile& file_;
  const scene::Scene& scene_;
  const RunOptions& options_;
  Summary& summary_;
  const Nanoseconds end_;

  Results results_;
  WindowLog window_log_;
  std::unique_ptr<protocol::Recorder> recorder_;
  std::unique_ptr<Participants> participants_;
  Solvers solvers_;
  Exchange exchange_;
  Accounts accounts_;

  std::string phase_ = "while the servers started";
  Nanoseconds now_;
  Nanoseconds next_frame_;
  std::chrono::steady_clock::time_point wall_begin_;
  Waiting mbd_waiting_, dem_waiting_;
  double output_ = 0;  // [s]
};

void Run::start() {
  participants_ =
      std::make_unique<Participants>(options_, scene_, options_.folder / "run.log", recorder_.get());
  solvers_ = participants_->solvers();

  const protocol::Configuration configuration{file_.text,  file_.origin,     file_.meshes,
                                              file_.files, options_.backend, options_.threads};
  const auto register_and_configure = [&](protocol::Remote* solver, protocol::Role role,
                                          std::uint64_t needed) {
    if (!solver) return;
    const protocol::Hello hello = solver->register_peer(needed, options_.patience);
    log::info("{} registered: {} on {}", solver->peer(), hello.program, hello.host);
    summary_.add_facts(role, solver->configure(configuration).facts);
  };
  std::uint64_t of_mbd = 0, of_dem = protocol::can_window_mean;
  if (solvers_.mbd && solvers_.dem) {
    of_mbd |= protocol::can_predict;
    of_dem |= protocol::can_interpolate;
  }
  register_and_configure(solvers_.mbd, protocol::Role::mbd, of_mbd);
  register_and_configure(solvers_.dem, protocol::Role::dem, of_dem);
  observe(true);
}

void Run::advance() {
  const Step step = choose_step(scene_.coupling.scheme, solvers_);
  const Nanoseconds H = to_nanoseconds(scene_.coupling.window);
  Progress progress(end_, static_cast<std::uint64_t>(summary_.number("spheres")), options_.quiet);
  log::info("scheme {}, window {:.6g} s", name(scene_.coupling.scheme), scene_.coupling.window);

  wall_begin_ = std::chrono::steady_clock::now();
  if (solvers_.mbd) mbd_waiting_.before_windows = solvers_.mbd->wait_seconds() - mbd_waiting_.observing;
  if (solvers_.dem) dem_waiting_.before_windows = solvers_.dem->wait_seconds() - dem_waiting_.observing;

  for (Window window{0, {0}, std::min(H, end_)}; window.begin < end_ && !interrupted();
       window = {window.index + 1, window.end, std::min(window.end + H, end_)}) {
    phase_ = fmt::format("in window {} (t = {:.6g} s)", window.index, to_seconds(window.begin));
    step(solvers_, window, exchange_);
    now_ = window.end;
    accounts_.book(exchange_);
    window_log_.write(window, accounts_);
    observe(now_ >= next_frame_ || now_ == end_ || interrupted());
    progress.update(now_, accounts_.windows(), accounts_.micro_steps());
  }
}

void Run::finish() {
  phase_ = fmt::format("after the last window (t = {:.6g} s)", to_seconds(now_));
  book();  // before the servers are let go: their farewell is no part of the run
  if (solvers_.mbd) summary_.add_facts(protocol::Role::mbd, solvers_.mbd->finish().facts);
  if (solvers_.dem) summary_.add_facts(protocol::Role::dem, solvers_.dem->finish().facts);
  if (const auto complaint = participants_->leave()) summary_.add_warning(*complaint);
  participants_.reset();
}

// Brings the state of the solvers into the results: the bodies after every window, the particles for frames.
void Run::observe(bool frame) {
  const auto begin = std::chrono::steady_clock::now();
  const auto waited = [](protocol::Remote* solver) { return solver ? solver->wait_seconds() : 0; };
  const double mbd_before = waited(solvers_.mbd), dem_before = waited(solvers_.dem);

  const protocol::BodiesFrame* bodies = solvers_.mbd ? &solvers_.mbd->observe_bodies(now_) : nullptr;
  if (now_.count > 0) results_.record(now_, bodies, solvers_.dem ? &exchange_.load : nullptr);
  if (frame) {
    results_.write_frame(now_, bodies, solvers_.dem ? &solvers_.dem->observe_particles(now_) : nullptr);
    const Nanoseconds interval = to_nanoseconds(scene_.output.frame_interval);
    while (next_frame_ <= now_)
      next_frame_ = interval.count > 0 ? next_frame_ + interval : end_ + Nanoseconds{1};
  }

  mbd_waiting_.observing += waited(solvers_.mbd) - mbd_before;
  dem_waiting_.observing += waited(solvers_.dem) - dem_before;
  output_ += seconds_since(begin);
}

TimeSplit Run::time_split() const {
  TimeSplit split;
  split.output = output_;
  const auto account = [&](const protocol::Remote* solver, const Waiting& waiting, const char* own_seconds) {
    if (!solver) return 0.0;
    const double wait = solver->wait_seconds() - waiting.before_windows - waiting.observing;
    const double own = summary_.number(own_seconds);
    split.exchange += solver->exchange_seconds();
    if (own <= 0 || own >= wait) return wait;  // not told, or worked on while the other was waited for
    split.exchange += wait - own;              // on the way, or waking up
    return own;
  };
  split.mbd = account(solvers_.mbd, mbd_waiting_, "mbd_solver_seconds");
  split.dem = account(solvers_.dem, dem_waiting_, "dem_solver_seconds");
  return split;
}

// Says how a server of ours died, where one did, and when it happened.
Error Run::explain(const Error& error) {
  const bool of_the_peer = error.code() == ErrorCode::peer_lost || error.code() == ErrorCode::timeout;
  if (!of_the_peer) return Error(error.code(), error.problem() + " " + phase_, error.where(), error.hint());
  // The channel may notice before the kernel tells.
  const auto death = participants_ ? participants_->death(300ms) : std::nullopt;
  if (!death) return error;  // the protocol has named peer, window and what was waited for
  return Error(ErrorCode::peer_lost, fmt::format("{} {}", *death, phase_), {},
               "first seen: " + error.problem());
}

// The verdict: the scene's own checks, which only a whole run can pass or fail.
void Run::conclude() {
  if (now_ < end_) {
    summary_.set_end(Status::interrupted);
    return;
  }
  const auto checks =
      evaluate(scene_.checks, results_.bodies(), results_.joints(), nlohmann::json(summary_.json()));
  const bool passed =
      std::all_of(checks.begin(), checks.end(), [](const CheckResult& c) { return c.passed; });
  summary_.set_checks(checks);
  summary_.set_end(passed ? Status::ok : Status::checks_failed);
}

}  // namespace

int run(const RunOptions& options) {
  const SceneFile file = read_scene(options.scene, options.overrides);
  prepare_run_folder(options.folder);
  log::setup("tandem", options.quiet ? "warn" : "info", (options.folder / "run.log").string());

  Summary summary(file, options);
  const InterruptGuard guard;
  try {
    Run run(file, options, summary);
    try {
      run.execute();
    } catch (...) {
      run.book();
      throw;
    }
    run.conclude();
    if (options.picture) render_picture(options.folder, file.scene);
  } catch (const Error& error) {
    log::error("{}", error.what());
    summary.set_end(Status::failed, &error);
  }

  summary.write(options.folder / "summary.json");
  if (options.report && summary.status() != Status::failed) write_report(options.folder);
  if (!options.quiet) fmt::print("{}  {:<22}{}\n", summary.table(), "results", options.folder.string());
  return summary.exit_status();
}

}  // namespace tandem::launch
