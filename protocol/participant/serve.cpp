#include "protocol/participant/serve.hpp"

#include <unistd.h>

#include <future>
#include <new>
#include <type_traits>

#include "common/log.hpp"
#include "protocol/checks.hpp"
#include "protocol/link.hpp"
#include "protocol/registration.hpp"

namespace tandem::protocol {
namespace {

std::string host_name() {
  char buffer[256] = {};
  return gethostname(buffer, sizeof buffer - 1) == 0 ? buffer : "unknown";
}

constexpr Role role_of(const MotionSolver&) {
  return Role::mbd;
}
Role role_of(const LoadSolver& solver) {
  return solver.role();
}

template <class AnySolver>
class Server {
 public:
  Server(Channel& channel, AnySolver& solver, const ServeOptions& options)
      : link_(channel, role_of(solver), Sender::participant), solver_(solver), options_(options) {}

  void run(const std::string& program) {
    greet(program);
    while (link_.session().state() != SessionState::ended)
      execute(link_.receive(in_time(), "the next order"));
  }

  // Reports the error to the coordinator, if the session still allows it. Never throws, as nobody could
  // handle it.
  void fail(const Error& error) noexcept {
    try {
      if (link_.session().state() == SessionState::ended) return;
      link_.send(Kind::failure, Failure{error.code(), error.problem(), error.where(), error.hint()},
                 Clock::now() + std::chrono::milliseconds(200));
    } catch (const std::exception&) {
    }
  }

 private:
  Deadline in_time() const { return Clock::now() + options_.patience; }

  void greet(const std::string& program) {
    const Role role = link_.session().role();
    link_.send(Kind::hello, Hello{role, layout_hash, solver_.capabilities(), getpid(), program, host_name()},
               in_time());
    if (link_.receive(in_time(), "welcome") == Kind::refuse) {
      Failure refusal;
      link_.read(refusal);
      throw ProtocolError(Violation::refused, "refused by " + link_.peer() + ": " + refusal.what,
                          refusal.where, refusal.hint);
    }
    link_.read_nothing();
    link_.adopt({link_.header().run_id, link_.header().generation}, link_.header().version);
    log::info("registered with {}", link_.peer());
  }

  // The session's table has accepted this order; its payload and the solver's answer are checked here.
  void execute(Kind order) {
    switch (order) {
      case Kind::configure:
        return configure();
      case Kind::predict:
      case Kind::extrapolate:
      case Kind::advance_mbd:
      case Kind::advance_dem:
        return integrate(order);
      case Kind::linearise:
        return linearise();
      case Kind::control:
        return control();
      case Kind::save:
        link_.read_nothing();
        solver_.save();
        answer(Kind::done);
        return link_.progress().save();
      case Kind::restore:
        return restore();
      case Kind::checkpoint:
      case Kind::resume:
        return meet_file(order);
      case Kind::observe:
        return observe();
      case Kind::snapshot:
        return snapshot();
      default:
        link_.read_nothing();
        answer(Kind::report, solver_.report());
        log::info("finished after {} windows", link_.progress().window());
    }
  }

  // While the solver worked the coordinator may have ended the run: its reason counts, rather than the loss
  // of the connection since.
  template <class... Value>
  void answer(Kind kind, const Value&... value) {
    expect_no_end();
    link_.send(kind, value..., in_time());
  }
  void expect_no_end() {
    if (link_.pending()) link_.receive(in_time(), "the end");  // throws: only a failure is allowed here
  }

  void configure() {
    Configuration configuration;
    link_.read(configuration);
    link_.check([&] { check_values(configuration); });
    const Configured configured = solver_.configure(configuration);
    link_.vouch(Kind::configured, [&] {
      check_values(configured);
      if (link_.session().role() == Role::mbd) bodies_.assign(configured.boundary);
    });
    answer(Kind::configured, configured);
  }

  void integrate(Kind order) requires std::is_same_v<AnySolver, MotionSolver> {
    Window window;
    const bool state_stays = order != Kind::advance_mbd;
    if (state_stays) {
      link_.read(window);
    } else {
      link_.read(loads_);
      window = loads_.window;
    }
    link_.check([&] {
      link_.progress().expect(window);
      if (state_stays) return;
      bodies_.expect_some(loads_.bodies);
      check_values(loads_);
    });
    publish(window);
    const MotionSet& motion = order == Kind::predict       ? solver_.predict(window)
                              : order == Kind::extrapolate ? solver_.extrapolate(window)
                                                           : solver_.advance(loads_);
    link_.vouch(Kind::motion, [&] {
      link_.progress().expect_same(motion.window, window);
      bodies_.expect_all(motion.bodies);
      check_values(motion);
    });
    answer(Kind::motion, motion);
    if (!state_stays) link_.progress().complete(window);
  }

  void integrate(Kind) requires std::is_same_v<AnySolver, LoadSolver> {
    link_.read(motion_);
    link_.check([&] {
      link_.progress().expect(motion_.window);
      check_values(motion_);
      // The first path defines the boundary bodies; they stay the same.
      if (!bodies_.known()) bodies_.assign(motion_.bodies);
      bodies_.expect_all(motion_.bodies);
    });
    publish(motion_.window);
    const LoadSet& loads = solver_.advance(motion_);
    link_.vouch(Kind::load, [&] {
      link_.progress().expect_same(loads.window, motion_.window);
      bodies_.expect_some(loads.bodies);
      check_values(loads);
      check_account(loads);
    });
    answer(Kind::load, loads);
    link_.progress().complete(motion_.window);
  }

  void linearise() {
    link_.read_nothing();
    const TangentSet& tangents = solver_.linearise();
    link_.vouch(Kind::tangents, [&] {
      link_.progress().expect_now(tangents.time);
      if (bodies_.known()) {  // else before the first window
        bodies_.expect_some(tangents.bodies);
        bodies_.expect_some(tangents.responses);
      }
      check_values(tangents);
    });
    answer(Kind::tangents, tangents);
  }

  void control() {
    if constexpr (std::is_same_v<AnySolver, MotionSolver>) {
      link_.read(inputs_);
      link_.check([&] {
        link_.progress().expect_now(inputs_.time);
        check_values(inputs_);
      });
      solver_.control(inputs_);
      answer(Kind::done);
    }
  }

  void restore() {
    link_.read_nothing();
    Progress restored = link_.progress();
    link_.check([&] { restored.restore(); });
    solver_.restore();
    answer(Kind::done);
    link_.progress() = restored;
  }

  void meet_file(Kind order) {
    Checkpoint file;
    link_.read(file);
    Progress progress = link_.progress();
    link_.check([&] {
      check_values(file);
      if (order == Kind::resume)
        progress.resume(file.window, file.time);
      else
        progress.expect_now(file.time);
    });
    const auto solve = [&](const Checkpoint& at) {
      if (order == Kind::resume)
        solver_.resume(at);
      else
        solver_.checkpoint(at);
    };
    if (options_.folders == nullptr) {
      solve(file);
    } else {
      const StatePlace place = order == Kind::resume ? options_.folders->to_read(file.path)
                                                     : options_.folders->to_write(file.path);
      try {
        solve({file.window, file.time, place.path()});
      } catch (const Error& error) {
        throw place.translated(error);
      }
    }
    answer(Kind::done);
    link_.progress() = progress;
  }

  void observe() {
    Nanoseconds now;
    link_.read(now);
    bool kept = false;
    link_.check([&] { kept = link_.progress().use_snapshot(now); });
    if (kept) return send_snapshot();
    const auto& frame = solver_.observe();
    const Kind kind = link_.session().role() == Role::mbd ? Kind::bodies : Kind::particles;
    link_.vouch(kind, [&] {
      link_.progress().expect_now(frame.time);
      check_values(frame);
    });
    answer(kind, frame);
  }

  // The frame of a snapshot is read, checked and encoded while the solver advances.
  void snapshot() {
    Nanoseconds now;
    link_.read(now);
    link_.check([&] { link_.progress().expect_now(now); });
    if constexpr (std::is_base_of_v<LoadSolver, AnySolver>) {
      if (reading_.valid()) reading_.get();
      solver_.snapshot();
      link_.progress().take_snapshot();
      reading_ = std::async(std::launch::async, [this, now] {
        const ParticlesFrame& frame = solver_.read_snapshot();
        if (frame.time != now) throw ProtocolError(Violation::wrong_time, "time is not that of the snapshot");
        check_values(frame);
        encode(snapshot_, frame);
      });
    }
    answer(Kind::done);
  }
  void send_snapshot() {
    link_.vouch(Kind::particles, [&] { reading_.get(); });
    expect_no_end();
    link_.send_encoded(Kind::particles, snapshot_, in_time());
  }

  void publish(const Window& window) {
    if (options_.window) options_.window->store(window.index, std::memory_order_relaxed);
    log::debug("window {} to {} s", window.index, to_seconds(window.end));
  }

  Link link_;
  AnySolver& solver_;
  ServeOptions options_;
  BoundaryBodies bodies_;
  LoadSet loads_;              // ordered
  MotionSet motion_;           // ordered
  ControlSet inputs_;          // ordered
  Bytes snapshot_;             // encoded
  std::future<void> reading_;  // last: its destructor waits for the thread, which uses the members above
};

template <class AnySolver>
int serve_any(Channel& channel, AnySolver& solver, const std::string& program, const ServeOptions& options) {
  Server<AnySolver> server(channel, solver, options);
  const auto leave = [&](const Error& error) {
    server.fail(error);
    log::error("{}", error.what());
    return exit_status(error.code());
  };
  try {
    server.run(program);
    return 0;
  } catch (const Error& e) {
    return leave(e);
  } catch (const std::bad_alloc&) {
    return leave(
        Error(ErrorCode::resource, "out of memory", program, "a smaller scene, or a larger machine"));
  } catch (const std::exception& e) {
    return leave(Error(ErrorCode::internal, e.what(), program));
  }
}

}  // namespace

int serve(Channel& channel, MotionSolver& solver, const std::string& program, const ServeOptions& options) {
  return serve_any(channel, solver, program, options);
}
int serve(Channel& channel, LoadSolver& solver, const std::string& program, const ServeOptions& options) {
  return serve_any(channel, solver, program, options);
}

}  // namespace tandem::protocol
